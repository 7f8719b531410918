#pragma once
// Metropolis Monte Carlo (Metropolis et al. 1953): no motion, samples of exp(-U/kT) with U the scene's energy. One step
// is one sweep, a trial move of every free particle in the order of their identities,
//
//   r' = r + step (2 u - 1),  u uniform in (0, 1)^D;   accepted with probability min(1, exp(-(U(r') - U(r))/kT))
//
// and then of every rigid body: its centre likewise, and its orientation by exp(step/radius (2 u - 1)) in the same trial;
// and rejected where r' leaves the box in a bounded direction. U: energies of pairs and densities, wall potentials, and -f.r
// of a body force f along bounded directions.
//
// Exact for any fixed step: each trial move obeys detailed balance, and their order does not depend on positions. (In
// the spatial order of memory it would, and a sweep would no longer leave the distribution alone.) The step is tuned
// towards 40 % acceptance during equilibration only. integrator.dt counts sweeps and is no time: there are no
// velocities, and displacements say nothing about diffusion. Slow, not wrong, where particles are caged. Breaks where
// there is no equilibrium, and refuses all of these: moving walls, a body force along a periodic direction, kT = 0,
// pairs of different kT.
#include <cstdint>
#include <memory>

#include "odpd/core/random.h"
#include "odpd/dynamics/integrator.h"
#include "odpd/dynamics/local_energy.h"

namespace odpd {

template <int D>
class MonteCarlo : public Integrator<D> {
 public:
  /// step: largest trial displacement per component at the start (length); 0: 0.3 cutoffs.
  explicit MonteCarlo(double step = 0.0) : step_(step) {}

  std::string name() const override { return "monte-carlo"; }
  int solves() const override { return 0; }
  void prepare(Dynamics<D>& dynamics) override;
  std::string summary() const override;
  /// One sweep. The record holds its start, with zero velocities. One object serves one Dynamics.
  const StepRecord<D>& step(Dynamics<D>& dynamics, const Clock& clock) override;
  void save(StateWriter& out) const override;
  void load(const StateReader& in) override;

  double trial_step() const { return step_; }
  /// Of the trial moves since the step was last changed, or equilibration ended.
  double acceptance() const;

 private:
  void refuse_driving(Dynamics<D>& dynamics, double time);
  bool try_move(Dynamics<D>& dynamics, std::size_t i, const std::array<double, 4>& u);
  bool try_body(Dynamics<D>& dynamics, std::size_t body, const CounterRandom& random,
                std::int64_t step);
  void sweep(Dynamics<D>& dynamics, std::int64_t step);
  void tune(const Box<D>& box);

  double step_;
  std::int64_t trials_ = 0, accepted_ = 0;
  std::unique_ptr<LocalEnergy<D>> energy_;  // made at the first step, placed anew in each
  std::vector<Vec<D>> force_;               // body force on each particle
  using Integrator<D>::record_;
};

}  // namespace odpd
