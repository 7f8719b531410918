#pragma once
// Waves without divergence in a periodic box, of forces that drive a flow or of the flow itself, with k_c = 2 pi number/L_c:
//
//   sine           F = A sin(k_a r_a)                    a: the direction `along`, which A has no component of; k^2 = k_a^2
//   taylor-green   F_c = A_c sin(k_c r_c) cos(k_a r_a)   c: that of A;                              k^2 = k_c^2 + k_a^2
//                  F_a = -(k_c/k_a) A_c cos(k_c r_c) sin(k_a r_a)
//
// Both are eigenfunctions of the Laplacian: under forces F on each particle Stokes flow is n F/(eta k^2), and with mass a flow of this
// shape decays as exp(-eta k^2 t/(n m)), the second at any Reynolds number (Taylor & Green 1937).
#include <cstdint>

#include "odpd/geometry/box.h"

namespace odpd {

struct FlowWave {
  enum class Shape { sine, taylor_green };

  int along = 0;
  std::int64_t number = 0;  ///< of waves in each edge; 0: no wave
  Shape shape = Shape::sine;

  /// k_c (1/length).
  template <int D>
  double wave_number(const Box<D>& box, int direction) const;
  /// k^2 of the wave of this amplitude.
  template <int D>
  double wave_number_squared(const Box<D>& box, const Vec<D>& amplitude) const;
  /// Largest |F_c| of any component (of the amplitude's unit).
  template <int D>
  double largest(const Box<D>& box, const Vec<D>& amplitude) const;
  /// The wave of this amplitude at r.
  template <int D>
  Vec<D> at(const Vec<D>& r, const Box<D>& box, const Vec<D>& amplitude) const;
};

/// Of the first component that is not 0.
template <int D>
int direction_of(const Vec<D>& v);

}  // namespace odpd
