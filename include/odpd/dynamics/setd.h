#pragma once
// Stochastic exponential time differencing (Phan-Thien et al. 2014; Nguyen 2021, sec. 3.5) for m > 0. The block
// diagonal A of the friction (D x D per particle, drag zeta_0 included) is integrated exactly over the step, everything
// else, N = F - (R + zeta_0 - A) v and the noise xi, is frozen. With x = A dt/m (a matrix), E = exp(-x),
// phi_1 = (1 - E)/x, phi_2 = (1 - phi_1)/x, phi_3 = (1/2 - phi_2)/x:
//
//   v' = E v + dt/m [phi_1 (N + xi) + phi_2 dN],        r' = r + dt phi_1 v + dt^2/m [phi_2 (N + xi) + phi_3 dN]
//
// order 1: dN = 0. order 2: dN = N - N_before, both with the A of this step (Cox & Matthews 2002, eq. 6); its first
// step leaves dN out. Carried for order 2: v and F - (R + zeta_0) v of the step before.
// Drift: with mass the equations have none to miss. Order without noise: as named. The frozen noise makes the kinetic
// temperature (kT)(2/x) tanh(x/2), x = dt/m times the mean diagonal friction: 5 % low at x = 0.8, half at x = 4;
// order 2 does not repair that and blows up first. A_i differs between partners, so pairwise momentum balance is lost:
// in a periodic box the centre of mass wanders. Kept because the sources use it.
#include <array>

#include "odpd/dynamics/integrator.h"

namespace odpd {

template <int D>
class Setd : public Integrator<D> {
 public:
  explicit Setd(int order) : order_(order) {}
  std::string name() const override { return "setd"; }
  int solves() const override { return 0; }
  std::string warning() const override {
    return "integrator 'setd' freezes the noise over the step, so the kinetic temperature falls as "
           "(2/x) tanh(x/2), x = dt/m times the friction of a particle, and momentum is not "
           "conserved pair by pair: use it to reproduce its sources";
  }
  const StepRecord<D>& step(Dynamics<D>& dynamics, const Clock& clock) override;
  void prepare(Dynamics<D>& dynamics) override;
  void save(StateWriter& out) const override;
  void load(const StateReader& in) override;

 private:
  int order_;
  // Order 2 only; empty before the first step.
  CarriedUnknowns<D> last_velocity_{"last_velocity"};
  CarriedUnknowns<D> last_force_{"last_force"};  // F - (R + zeta_0) v
};

}  // namespace odpd
