#pragma once
// Linearly implicit conservative force for strong repulsion, one solve per step, every mass m >= 0: the extrapolated
// scheme (extrapolated.h) with the stiffness K of the repulsion along the lines of centres in the matrix, compensated
// by the last velocity so that it does not act as friction,
//
//   (M + R_k + theta dt K_k) v_k = [right side of the extrapolated scheme] + theta dt K_k v_{k-1}
//
// K = sum over edges of max(k_c, 0) e e^T; the first step leaves the lagged terms out, compensation included.
// Drift: as the extrapolated scheme. Order without noise: 2. Does not blow up where explicit schemes do (dt beyond
// gamma/a), but pays in dynamics: at a = 100 and dt = 0.02 = 0.44 gamma/a self-diffusion is 10 % low, at dt = 0.05 a
// third. For statics and relaxation at strong repulsion. The smooth potential of walls stays explicit: with walls keep
// dt below friction/stiffness, some 0.02.
#include "odpd/dynamics/extrapolated.h"

namespace odpd {

template <int D>
class Implicit : public Extrapolated<D> {
 public:
  /// theta in (0, 1]: weight of the end of the step.
  explicit Implicit(double theta) : Extrapolated<D>(theta) {}
  std::string name() const override { return "implicit"; }
};

}  // namespace odpd
