#pragma once
// D x D blocks, row-major.
#include <array>

#include "odpd/core/index.h"
#include "odpd/core/rotation.h"

namespace odpd {

template <int D>
using SmallBlock = std::array<double, index(D* D)>;

// E with E w = e x w: row-major.
template <int D>
SmallBlock<D> cross_matrix(const Vec<D>& e) {
  SmallBlock<D> m;
  for (std::size_t c = 0; c < D; ++c) {
    Vec<D> unit{};
    unit.x[c] = 1.0;
    const Vec<D> column = -1.0 * swing(unit, e);
    for (std::size_t r = 0; r < D; ++r) m[r * D + c] = column.x[r];
  }
  return m;
}

// a^T b, or a b: row-major.
template <int D>
SmallBlock<D> product_of(const SmallBlock<D>& a, const SmallBlock<D>& b, bool transposed) {
  SmallBlock<D> m{};
  for (std::size_t r = 0; r < D; ++r)
    for (std::size_t c = 0; c < D; ++c)
      for (std::size_t k = 0; k < D; ++k)
        m[r * D + c] += (transposed ? a[k * D + r] : a[r * D + k]) * b[k * D + c];
  return m;
}

template <int D>
SmallBlock<D> identity(double factor) {
  SmallBlock<D> m{};
  for (std::size_t c = 0; c < D; ++c) m[c * D + c] = factor;
  return m;
}

}  // namespace odpd
