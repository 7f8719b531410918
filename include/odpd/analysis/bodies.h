#pragma once
// What happens to obstacles and rigid bodies, per [[body]] and averaged over its bodies:
//
//   force, torque     of the edges (conservative, friction and random), stage means; about the body's centre
//   velocity, angular_velocity   of the motion over the step; under [shear] without held bodies less that of the flow at the
//                     centre
//   diffusion, rotational_diffusion   from mean-square displacements of centre and orientation, the latter about each axis
//                     that a body turns about: three in 3D, two of a rod (free bodies; not under [shear], where they turn with
//                     the flow)
//   mobility          velocity per force on one body along the same directions, with `control`: how its displacement grows at
//                     equilibrium, <x(t)^2>/(2 kT) -> mobility t, with the noise taken out by one solve for each body and
//                     direction (analysis/mode_growth.h); D = kT mobility (Einstein). frozen_mobility: what configurations that
//                     do not change would give
//   g(q)              density of the fluid at distance q from the centre, and the exclusion radius (analysis/fluid_around.h)
//
// and the mean velocity of the fluid particles, likewise. The orientation is followed by adding up the rotation from sample
// to sample, so it must turn by less than half a turn between two.
#include "odpd/analysis/displacements.h"
#include "odpd/analysis/fluid_around.h"
#include "odpd/analysis/mode_growth.h"
#include "odpd/analysis/msd.h"
#include "odpd/analysis/observer.h"
#include "odpd/analysis/observer_keys.h"
#include "odpd/particles/constituents.h"

namespace odpd {

struct BodiesSettings {
  MsdSettings msd;             ///< lags; the directions are those of the centre's displacements
  FluidAroundSettings around;  ///< g(q)
  ControlKeys control{};       ///< of the mobility; every 0: none
};

template <int D>
class Bodies : public Observer<D> {
 public:
  /// in_time: steps are steps in time; otherwise (Monte Carlo) there are neither velocities nor diffusion.
  Bodies(ObserverSettings settings, BodiesSettings bodies, const Scene<D>& scene, double dt,
         bool in_time = true);
  static std::unique_ptr<Observer<D>> make(const ObserverEntry<D>& entry);
  double moment() const override { return 0.5; }
  double solves() const override;
  void measure(const Clock& clock, const Particles<D>& particles,
               const StepRecord<D>& record) override;
  void add_results(Results& results) const override;
  std::vector<std::string> series_columns() const override;
  void save(StateWriter& out) const override;
  void load(const StateReader& in) override;

 private:
  static constexpr std::size_t turns = rotation_components<D>;
  static constexpr std::size_t width = 2 * (D + turns);  // columns of a [[body]]
  void add_stage(const Stage<D>& stage, const StepRecord<D>& record, const ParticleLoads<D>& noise,
                 double weight, std::vector<double>& sample) const;
  void add_motion(const Particles<D>& particles, const StepRecord<D>& record,
                  std::vector<double>& sample) const;
  void follow(const Particles<D>& particles);
  void add_growth(const Particles<D>& particles, const StepRecord<D>& record);
  void add_mobility(const std::string& name, std::size_t kind, Results& results) const;
  void count_fluid(const Particles<D>& particles, const Stage<D>& stage);
  void add_diffusion(const std::string& name, std::size_t kind, Results& results) const;

  BodiesSettings bodies_;
  bool in_time_;
  const Scene<D>& scene_;
  std::vector<std::size_t> kind_;   // of each body
  std::vector<std::string> names_;  // of each [[body]]
  std::vector<double> share_;       // 1/bodies of each [[body]]
  Constituents members_;            // in this sample
  // A sample: [[body]] after [[body]], then the fluid's velocity.
  FluidAround<D> around_;
  Displacements places_, turns_;
  std::vector<double> angle_;        // rotation so far, D numbers per body
  std::vector<double> orientation_;  // at the last sample
  std::vector<ModeGrowth>
      growth_;  // of each [[body]] with control; a mode is a body and a direction
};

}  // namespace odpd
