#pragma once
// The resistance operator packed for speed: float, both directions of every edge stored with their rows, rows sorted by
// degree in windows of 256 nodes and cut into slices of sixteen (SELL-16-256; Kreutzer et al. 2014). Symmetric, positive
// semidefinite and momentum-conserving as R is, since both directions hold the same g; it differs from R by rounding of g,
// some 3e-8 of |R v|.
#include <cstdint>
#include <memory>
#include <new>
#include <span>
#include <vector>

#include "odpd/operator/resistance.h"

namespace odpd {

/// Float arrays of kernels: aligned to cache lines, not cleared when they grow.
class FloatArray {
 public:
  float* data() { return data_.get(); }
  const float* data() const { return data_.get(); }
  std::int64_t size() const { return size_; }
  /// Contents are lost, unless the size stays.
  void resize(std::int64_t size);
  void fill(float value);

 private:
  struct Free {
    void operator()(float* p) const { ::operator delete[](p, std::align_val_t{64}); }
  };
  std::unique_ptr<float[], Free> data_;
  std::int64_t size_ = 0, capacity_ = 0;
};

template <int D>
class SlicedRows {
 public:
  /// Floats per place in a node vector; one is unused in 3D.
  static constexpr std::int64_t stride = D == 2 ? 2 : 4;

  /// Packs the operator; its nodes get places 0 .. places() - 1, some of which stay empty.
  void pack(const Resistance<D>& resistance);

  std::int64_t places() const { return static_cast<std::int64_t>(node_of_place_.size()); }
  /// Node at a place, -1 at an empty one; place of a node.
  std::span<const std::int32_t> node_of_place() const { return node_of_place_; }
  std::span<const std::int32_t> place_of_node() const { return place_of_node_; }
  /// Floats of a node vector.
  std::int64_t vector_size() const;

  /// y = A x over the places [first, last), multiples of 16; returns x . y there. Empty places: zero.
  double product(const float* x, float* y, std::int64_t first, std::int64_t last) const;
  std::int64_t bytes() const;

 private:
  void sort_window(const Resistance<D>& resistance, std::int64_t window);
  void fill_slice(const Resistance<D>& resistance, std::int64_t slice);

  bool across_ = false;
  std::vector<std::int64_t> start_;  // first slot of each slice
  std::vector<std::int32_t> node_of_place_, place_of_node_;
  FloatArray links_, anchor_;
};

}  // namespace odpd
