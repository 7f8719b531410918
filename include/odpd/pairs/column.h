#pragma once
// A column of numbers, one per edge, that takes no room where all of them are the same.
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace odpd {

/// Either one number for all edges or one for each; read alike.
class Column {
 public:
  double operator[](std::size_t k) const { return values_[k & mask_]; }
  std::size_t size() const { return size_; }
  bool varies() const { return mask_ != 0; }

  /// One number for all edges, those to come too.
  void fill(double value);
  /// From now on a number for each edge, at first that of all. Safe on several threads where it varies already.
  std::span<double> each();
  /// One edge's number; the others keep theirs.
  void set(std::size_t k, double value) {
    if ((*this)[k] != value) each()[k] = value;
  }
  /// With some room more where it varies: the number of edges changes by little from one configuration to the next.
  void resize(std::size_t size);

  /// The same bits on any number of threads.
  double sum() const;
  std::int64_t bytes() const { return static_cast<std::int64_t>(values_.size() * sizeof(double)); }
  bool operator==(const Column&) const = default;

 private:
  std::vector<double> values_ = {0.0};
  std::size_t size_ = 0;
  std::size_t mask_ = 0;  // of indices: none of their bits, or all
};

}  // namespace odpd
