#pragma once
// Viscosity by every route that the scene allows, each from observers that say how they measure:
//
//   <name>.wall     shear stress on two facing walls / slope of the linear velocity profile      (wall_force.h, profile.h)
//   <name>.stress   shear stress between the walls / that slope, or in the box / the rate of [shear]  (stress.h)
//   <name>.profile  curvature of the profile under a body force, n f/(-2 c_2)                    (profile.h)
//   <name>.sine     amplitude under a sinusoidal force, n F L^2/(4 pi^2 k^2 A), k waves in L     (profile.h)
//   <name>.helfand  growth of the integrated stress in a fully periodic box at rest              (helfand.h, mode_growth.h)
//
// The stress between sliding images fluctuates by what the noise makes of it, which has no mean; with `control` that is subtracted
// (shear_control of helfand.h; without it: <name>.plain). A shear stress is that of the force along the flow across the gradient, S_ba of a
// flow along a with its gradient along b, which with friction across lines of centres is not S_ab.
//
// `viscosity` (`<name>.viscosity` under another name) is the one of smallest standard error; a note says which. Errors of
// quotients take numerator and denominator as independent.
#include <memory>
#include <optional>

#include "odpd/analysis/block_average.h"
#include "odpd/analysis/mode_growth.h"
#include "odpd/analysis/observer_keys.h"
#include "odpd/analysis/profile.h"
#include "odpd/analysis/stress.h"
#include "odpd/analysis/wall_force.h"

namespace odpd {

/// How a scene shows its viscosity.
struct ViscosityScene {
  enum class Kind { none, images, sheared, parabola, sine, at_rest } kind = Kind::none;
  int axis = 1;                 ///< of the profile
  int component = 0;            ///< of the velocity
  double from = 0.0, to = 0.0;  ///< coordinates of the fit
  bool needs_every_step() const { return kind == Kind::at_rest; }
  bool has_profile() const {
    return kind == Kind::sheared || kind == Kind::parabola || kind == Kind::sine;
  }
};

/// The first that applies: steady [shear], facing walls that move differently, a sinusoidal force, a uniform force between
/// walls or in a region, a fully periodic box at rest with kT > 0.
template <int D>
ViscosityScene viscosity_scene(const Scene<D>& scene);

struct ViscositySettings {
  std::int64_t bins = 20;               ///< of the profile
  double window = 0.5, fit_from = 0.2;  ///< of helfand (time)
  ControlKeys control = {};             ///< of helfand, and of sliding images
};

template <int D>
class Viscosity : public Observer<D> {
 public:
  Viscosity(ObserverSettings settings, const ViscositySettings& viscosity, const Scene<D>& scene,
            double dt);
  static std::unique_ptr<Observer<D>> make(const ObserverEntry<D>& entry);
  /// The integrated stress is that up to the step's end.
  double moment() const override { return growth_ ? 1.0 : 0.5; }
  double solves() const override {
    if (growth_) return growth_->solves();
    return controlled_ ? 1.0 / static_cast<double>(this->settings().every) : 0.0;
  }
  void measure(const Clock& clock, const Particles<D>& particles,
               const StepRecord<D>& record) override;
  void add_results(Results& results) const override;
  std::vector<std::string> series_columns() const override;
  std::vector<double> series_row() const override;
  void save(StateWriter& out) const override;
  void load(const StateReader& in) override;

 private:
  std::vector<Scalar> routes(Results& results) const;
  /// Viscosity from what G^2 grows by.
  Scalar helfand(const std::string& what, const ModeGrowth::Estimate& growth) const;
  Table growth_table() const;

  ViscosityScene kind_;
  const Scene<D>& scene_;
  std::vector<std::unique_ptr<Observer<D>>>
      parts_;                         // profile, wall-force, stress: what the routes need
  std::optional<ModeGrowth> growth_;  // of the integrated stress
  // Stress over rate as it is, without what the noise makes of it, and eta_0; of the last sample.
  std::optional<BlockAverage> controlled_;
  std::vector<double> row_;
  double control_tolerance_;
};

}  // namespace odpd
