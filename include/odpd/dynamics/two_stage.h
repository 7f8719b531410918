#pragma once
// The step that the schemes with two solves share, with M = 2 m/dt and xi = P(r)^T F_B(r) drawn once per step:
//
//   (M + R(r )) q1 = M q + F(r , t       ) + xi,    r* = r + c dt P q1
//   (M + R(r*)) q2 = M q + F(r*, t + c dt) + xi,    q_mid = b q1 + (1 - b) q2,   r' = r + dt P q_mid
//
// c = 1, b = 1/2: the stochastic trapezoidal rule. c = 1/2, b = 0: Fixman's midpoint rule. Both get the drift from the
// same stored vector xi in both stages.
//
// With mass, momenta go on as q' = 2 q_p - q (bodies in 3D: as P^T P q, as moments of inertia turn with the body),
//
//   q_p = (1 - e) q1 + e q2 + (1 - b - e) g/A,    e = (1 - b)/(1 + (zeta/20 M)^2),    g = F_U(r*) - F_U(r),
//
// A = g (M + R) g/g g, zeta the mean diagonal of R (with zeta_0 and the terms of bonds below), F_U the forces of potentials
// with the terms of bonds below.
// * M >> R: q_p = q_mid up to O(dt^4), of second order.
// * M << R: one R acts on q and its noise, so that q' keeps the variance kT/m: with A_k = (M + R_k)^-1 it is off by the factor
//   1 + e <A_2/A_1 - 1> (M + R_1)/R_1 without forces. F_U at r alone would heat by K dt/2R, with K the Laplacian of U per
//   component, as r' has moved by F_U(r*) too: g/A, for (M + R)^-1 g, is what that takes.
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
  std::vector<double> potential_change(Dynamics<D>& dynamics) const;
  void add_bond_terms(Dynamics<D>& dynamics, double dt, const std::vector<double>& q,
                      std::vector<double>& load) const;

  double reach_, start_weight_;
  bool implicit_bonds_;
};

}  // namespace odpd
