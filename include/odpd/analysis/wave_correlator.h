#pragma once
// Time correlation of the currents of waves in a run, with no trajectory: of each wave number, from all its modes together,
//
//   c(t) = scale <J(0) J(t)>
//
// at lags up to one of its own, as long waves decay slowly and short ones fast. Every sample is an origin. Transverse modes and
// longitudinal ones are kept apart.
#include <cstdint>
#include <span>
#include <vector>

#include "odpd/analysis/block_average.h"
#include "odpd/core/archive.h"

namespace odpd {

class WaveCorrelator {
 public:
  WaveCorrelator() = default;
  /// lags: the largest of each wave number; longitudinal: of each mode of a wave number whether it is.
  WaveCorrelator(std::vector<std::int64_t> lags, std::vector<bool> longitudinal, double scale);

  std::size_t waves() const { return lags_.size(); }
  /// The largest lag.
  std::size_t lags(std::size_t wave) const { return static_cast<std::size_t>(lags_[wave]); }
  /// J of every mode, by wave number.
  void add(std::span<const double> current);
  /// Of samples that have all their lags behind them.
  const BlockAverage& average() const { return average_; }
  /// Where in the average c of a wave number begins: lags + 1 columns.
  std::size_t first_column(std::size_t wave, bool longitudinal) const;

  void save(StateWriter& out) const;
  /// Takes the lags of the state. Throws IoError for one of other waves.
  void load(const StateReader& in, std::size_t waves);

 private:
  void make_room();

  std::vector<std::int64_t> lags_;
  std::vector<bool> longitudinal_;
  double scale_ = 1.0;
  std::int64_t samples_ = 0;
  // Of each wave number the last lags + 1 currents, those of sample n at place n modulo their number.
  std::vector<std::vector<double>> history_;
  BlockAverage average_;
};

}  // namespace odpd
