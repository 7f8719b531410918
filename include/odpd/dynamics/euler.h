#pragma once
// The step of the overdamped paper (Phan-Thien et al. 2016, eq. 15 and 28):
//
//   R(r) v = F(r, t) + xi,   r' = r + dt v
//
// Drift: none. The term kT div R^-1 is missing, so the scheme samples a wrong distribution at every dt: at the
// standard 2D state the energy is 0.9 % low and the configurational temperature 0.82 as dt -> 0; an ideal gas
// (a = 0) gets g(r) up to 1.6. Order without noise: 1. For mass 0 only. Breaks at dt of about gamma/a.
#include "odpd/dynamics/integrator.h"

namespace odpd {

template <int D>
class Euler : public Integrator<D> {
 public:
  std::string name() const override { return "euler"; }
  int solves() const override { return 1; }
  std::string warning() const override {
    return "integrator 'euler' leaves out the drift kT div R^-1 and is biased at every dt (energy "
           "about -1 %, "
           "configurational temperature about 0.82 at the standard 2D state): use it to reproduce "
           "the paper only";
  }
  const StepRecord<D>& step(Dynamics<D>& dynamics, const Clock& clock) override;
};

}  // namespace odpd
