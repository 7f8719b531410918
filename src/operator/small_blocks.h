#pragma once
// D x D blocks, row-major, and entries of vectors of nodes.
#include <array>
#include <span>

#include "odpd/core/index.h"
#include "odpd/core/rotation.h"

namespace odpd {

template <int D>
using SmallBlock = std::array<double, index(D* D)>;

// target += left^T middle right.
template <int D>
void add_triple_product(const double* left, const double* middle, const double* right,
                        double* target) {
  for (std::size_t row = 0; row < D; ++row)
    for (std::size_t k = 0; k < D; ++k)
      for (std::size_t l = 0; l < D; ++l) {
        const double factor = left[k * D + row] * middle[k * D + l];
        for (std::size_t col = 0; col < D; ++col)
          target[row * D + col] += factor * right[l * D + col];
      }
}

template <int D>
Vec<D> vector_at(std::span<const double> x, std::size_t node) {
  Vec<D> v;
  for (std::size_t c = 0; c < D; ++c) v.x[c] = x[node * D + c];
  return v;
}

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
