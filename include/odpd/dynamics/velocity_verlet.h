#pragma once
// Groot and Warren's modified velocity-Verlet for m > 0 (Groot & Warren 1997, eq. 23), f all forces over m, the random
// one included:
//
//   v_k = v_{k-1} + dt/2 (f_{k-1} + f_k),   f_k = f(r_k, w_k)          one evaluation per step
//   r_{k+1} = r_k + dt v_k + dt^2/2 f_k,    w_{k+1} = v_k + lambda dt f_k
//
// Carried from step to step: the predicted velocity w and the half-way velocity v_k + dt/2 f_k.
// Drift: with mass the equations have none to miss. Order without noise: 1, and 2 for lambda = 1. The kinetic
// temperature is off by -(lambda - 1/2) x, x = dt/m times the mean friction of a particle: lambda = 1/2 is the better
// choice, 0.65 is Groot and Warren's and what Nguyen 2021, Table 3.1, shows. Blows up where x exceeds about 2.
#include "odpd/dynamics/integrator.h"

namespace odpd {

template <int D>
class VelocityVerlet : public Integrator<D> {
 public:
  /// lambda in [0, 1].
  explicit VelocityVerlet(double lambda) : lambda_(lambda) {}
  std::string name() const override { return "velocity-verlet"; }
  int solves() const override { return 0; }
  const StepRecord<D>& step(Dynamics<D>& dynamics, const Clock& clock) override;
  void prepare(Dynamics<D>& dynamics) override { half_way_.prepare(dynamics); }
  void save(StateWriter& out) const override { half_way_.save(out); }
  void load(const StateReader& in) override { half_way_.load(in); }

 private:
  double lambda_;
  CarriedUnknowns<D> half_way_{"half_way"};  // v_k + dt/2 f_k; empty before the first step
};

}  // namespace odpd
