#pragma once
// Means and standard errors of correlated samples by block averaging (Flyvbjerg & Petersen 1989).
//
// Samples are vectors of fixed width. At most 64 blocks are kept; when they are full, neighbours are merged and blocks
// become twice as long. The standard error is the largest over the block lengths that leave at least 16 blocks, each
// enlarged where neighbouring blocks are still correlated, and NaN with fewer blocks than that. A column with a sample that is
// undefined (NaN) has neither a mean nor an error.
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "odpd/core/archive.h"

namespace odpd {

class BlockAverage {
 public:
  explicit BlockAverage(std::size_t width = 1);

  void add(std::span<const double> sample);
  std::int64_t samples() const { return samples_; }
  std::size_t width() const { return width_; }

  double mean(std::size_t column) const;
  double standard_error(std::size_t column) const;

  /// A quantity sum_k weight_k <numerator_k> / <denominator_k> of column means.
  struct RatioTerm {
    double weight = 1.0;
    std::size_t numerator = 0;
    std::size_t denominator = 0;
  };
  double ratio(std::size_t numerator, std::size_t denominator) const;
  /// Standard error of such a sum, to first order in the fluctuations (delta method).
  double ratio_error(std::span<const RatioTerm> terms) const;

  /// Jackknife error of any function of the vector of column means.
  template <class Function>
  double jackknife_error(const Function& function) const {
    return jackknife_error(left_out(function));
  }
  /// The same in two steps, for functions that share what costs time: values without one block each, then the error of whatever
  /// follows from each of them.
  template <class Function>
  auto left_out(const Function& function) const;
  static double jackknife_error(std::vector<double> left_out);

  void save(StateWriter& out, const std::string& name) const;
  /// Throws IoError for a state of another width.
  void load(const StateReader& in, const std::string& name);

 private:
  // Largest standard error over the block lengths, of the per-block numbers given at the shortest length.
  static double plateau(std::vector<double> blocks);
  std::vector<double> column_means(std::int64_t without_block) const;

  std::size_t width_;
  std::int64_t samples_ = 0;
  std::int64_t block_length_ = 1;
  std::int64_t in_open_block_ = 0;
  std::vector<double> total_;   // sums over all samples
  std::vector<double> open_;    // sums over the open block
  std::vector<double> blocks_;  // sums of complete blocks, one after the other
};

template <class Function>
auto BlockAverage::left_out(const Function& function) const {
  const auto n = static_cast<std::int64_t>(blocks_.size() / width_);
  std::vector<decltype(function(column_means(0)))> values;
  for (std::int64_t k = 0; k < n; ++k) values.push_back(function(column_means(k)));
  return values;
}

}  // namespace odpd
