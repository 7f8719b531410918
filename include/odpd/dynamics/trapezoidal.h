#pragma once
// Stochastic trapezoidal rule for every mass m >= 0, with M = 2 m/dt and xi = P(r)^T F_B(r) drawn once per step:
//
//   (M + R(r )) q1 = M q + F(r , t   ) + xi,    r* = r + dt P q1
//   (M + R(r*)) q2 = M q + F(r*, t+dt) + xi,    q_mid = (q1 + q2)/2,   r' = r + dt P q_mid
//
// Drift: right (kT div R^-1, Ito) without computing it, because both stages use the same stored vector xi. Order without
// noise: 2. Energy at the standard 2D state within 0.1 % at dt = 0.02. q' (two_stage.h) has variance kT/m within 1 % at any
// mass there. Breaks at dt of about gamma/a for strong repulsion, and is 1 % off from 0.4 gamma/a. As m -> 0, q' alternates
// in sign from step to step: read flow from q_mid.
#include "odpd/dynamics/two_stage.h"

namespace odpd {

template <int D>
class Trapezoidal : public TwoStage<D> {
 public:
  explicit Trapezoidal(bool implicit_bonds = true) : TwoStage<D>(1.0, 0.5, implicit_bonds) {}
  std::string name() const override { return "trapezoidal"; }
};

}  // namespace odpd
