#pragma once
// Energy balance of a massless fluid, per time and per volume between the wall surfaces, each stage of a step for itself and then
// their mean:
//
//   produced     sum_edges -(F_D + F_B) . slip = v . (R v - xi): what friction heats, less what the noise gives back
//   walls        power of whoever moves them, and bodies of known motion, -sum v_i . (F_C + F_D + F_B)_i over their particles
//   body_force   sum v . F_drive, with that of the forces and torques on bodies
//   shear        power of the sliding images of [shear], -sum_edges slip_0 . (F_C + F_D + F_B)
//   energy_rate  dU/dt = -sum v . F_C (and of the images), wall potentials included
//
//   produced + energy_rate = walls + body_force + shear, in every stage, to the tolerance of the solver
//
// residual: the largest miss of that over stages and samples, over sum_edges -F_D . slip (v . R v alone holds the noise's power,
// 2 kT/dt per degree of freedom). `extrapolated` and `implicit` solve another balance in a step: theirs does not close.
#include "odpd/analysis/observer.h"

namespace odpd {

template <int D>
class Heat : public Observer<D> {
 public:
  Heat(ObserverSettings settings, const Scene<D>& scene)
      : Observer<D>(std::move(settings),
                    {"produced", "walls", "body_force", "shear", "energy_rate"}),
        scene_(scene) {}
  static std::unique_ptr<Observer<D>> make(const ObserverEntry<D>& entry);
  double moment() const override { return 0.5; }
  void measure(const Clock& clock, const Particles<D>& particles,
               const StepRecord<D>& record) override;
  void add_results(Results& results) const override;
  void save(StateWriter& out) const override;
  void load(const StateReader& in) override;

 private:
  void add_stage(const Particles<D>& particles, const Stage<D>& stage, const StepRecord<D>& record,
                 double weight, std::vector<double>& sample);

  const Scene<D>& scene_;
  double worst_ = 0.0;
};

}  // namespace odpd
