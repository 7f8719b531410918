#pragma once
#include <cmath>
#include <tuple>

namespace odpd {

/// Inverse of a symmetric block; its first entry NaN when it is not positive definite to rounding.
template <class Block>
Block inverse_of(const Block& m) {
  constexpr double singular = 1e-13;
  Block out;
  if constexpr (std::tuple_size_v<Block> == 4) {
    const double det = m[0] * m[3] - m[1] * m[1];
    const bool good = m[0] > 0.0 && m[3] > 0.0 && det > singular * m[0] * m[3];
    const double scale = good ? 1.0 / det : std::nan("");
    out = {scale * m[3], -scale * m[1], -scale * m[1], scale * m[0]};
  } else {
    const double c00 = m[4] * m[8] - m[5] * m[5], c01 = m[2] * m[5] - m[1] * m[8],
                 c02 = m[1] * m[5] - m[2] * m[4], c11 = m[0] * m[8] - m[2] * m[2],
                 c12 = m[1] * m[2] - m[0] * m[5], c22 = m[0] * m[4] - m[1] * m[1];
    const double det = m[0] * c00 + m[1] * c01 + m[2] * c02;
    const bool good = m[0] > 0.0 && c22 > singular * m[0] * m[4] && det > singular * c22 * m[8];
    const double scale = good ? 1.0 / det : std::nan("");
    out = {scale * c00, scale * c01, scale * c02, scale * c01, scale * c11,
           scale * c12, scale * c02, scale * c12, scale * c22};
  }
  return out;
}

}  // namespace odpd
