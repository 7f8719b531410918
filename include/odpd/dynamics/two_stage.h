#pragma once
// The step that the schemes with two solves share, with M = 2 m/dt and xi = P(r)^T F_B(r) drawn once per step:
//
//   (M + R(r )) q1 = M q + F(r , t       ) + xi,    r* = r + c dt P q1
//   (M + R(r*)) q2 = M q + F(r*, t + c dt) + xi,    q_mid = b q1 + (1 - b) q2,   r' = r + dt P q_mid,   q' = 2 q_mid - q
// (bodies in 3D: the same of the momenta P^T P q, as moments of inertia turn with the body)
//
// c = 1, b = 1/2: the stochastic trapezoidal rule. c = 1/2, b = 0: Fixman's midpoint rule. Both get the drift from the
// same stored vector xi in both stages.
//
// Bonds are taken implicitly (unless told otherwise), with K = sum over bonds of max(k_c, 0) e e^T, at r and K* at r*:
//
//   (M + R + dt/2 K ) q1 = ...,    (M + R* + dt/2 K*) q2 = ... + dt/2 K* q1 + (c - 1/2) dt K q1
//
// which keeps the order with and without noise (the terms of K cancel to O(dt) in both, for any K), and for a linear
// force at constant R is the Crank-Nicolson step, which samples a harmonic bond exactly at any dt.
#include "odpd/dynamics/integrator.h"

namespace odpd {

template <int D>
class TwoStage : public Integrator<D> {
 public:
  int solves() const override { return 2; }
  const StepRecord<D>& step(Dynamics<D>& dynamics, const Clock& clock) override;

 protected:
  /// reach: c; start_weight: b.
  TwoStage(double reach, double start_weight, bool implicit_bonds)
      : reach_(reach), start_weight_(start_weight), implicit_bonds_(implicit_bonds) {}

 private:
  void add_bond_terms(Dynamics<D>& dynamics, double dt, const std::vector<double>& q,
                      std::vector<double>& load) const;

  double reach_, start_weight_;
  bool implicit_bonds_;
};

}  // namespace odpd
