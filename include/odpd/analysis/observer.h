#pragma once
// Observers only read the state. Each samples every so many steps of the measured part of a run and gives numbers with
// standard errors by block averaging, tables and charts. Made by kind from the case file's [[observe]] entries:
//
//   thermo            energy per particle, pressure, configurational temperature
//   profile           density, velocity and configurational temperature across bins, with a fit
//   density-residual  unevenness of the time-averaged density on a grid
//   divergence        of the time-averaged flow on a grid
//   rdf               radial distribution functions per pair of species
//   wall-force        force per area on each wall, shear stress between two
//   bodies            force, torque, motion and diffusion of obstacles and rigid bodies, the fluid around them
//   stress            stress tensor, overall and by bins, and the parts of the pressure
//   viscosity         by every route that the scene allows
//   heat              produced heat, power put in, change of energy
//   msd               mean-square displacement and self-diffusion per species
//   molecules         lengths of bonds, radius of gyration and diffusion of each kind of molecule
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "odpd/analysis/results.h"
#include "odpd/core/archive.h"
#include "odpd/core/config.h"
#include "odpd/dynamics/clock.h"
#include "odpd/dynamics/step_record.h"
#include "odpd/scene/scene.h"

namespace odpd {

/// What every observer has.
struct ObserverSettings {
  std::string kind;
  std::string name;        ///< prefix of its scalars and stem of its files
  std::int64_t every = 1;  ///< steps between samples
  bool series = false;     ///< write a time series
  /// Measured steps that may be sampled: after `from` of them, up to `until`.
  std::int64_t from = 0, until = std::numeric_limits<std::int64_t>::max();
};

template <int D>
class Observer {
 public:
  explicit Observer(ObserverSettings settings) : settings_(std::move(settings)) {}
  virtual ~Observer() = default;
  const ObserverSettings& settings() const { return settings_; }

  bool is_due(const Clock& clock) const {
    const std::int64_t step = clock.measured_steps();
    return clock.measuring() && step % settings_.every == 0 && step > settings_.from &&
           step <= settings_.until;
  }
  /// One sample from the step just done (clock.step already advanced past it).
  virtual void measure(const Clock& clock, const Particles<D>& particles,
                       const StepRecord<D>& record) = 0;
  virtual void add_results(Results& results) const = 0;

  /// Columns after `time`, and the row of the newest sample (empty: nothing new to write).
  virtual std::vector<std::string> series_columns() const = 0;
  virtual std::vector<double> series_row() const = 0;

  virtual void save(StateWriter& out) const = 0;
  virtual void load(const StateReader& in) = 0;

 private:
  ObserverSettings settings_;
};

/// The observers of a case: its [[observe]] entries, and `thermo` and `msd` with their defaults when it names none of
/// that kind. Without `steps_are_time` (Monte Carlo) there is no `msd` (nor others that need motion): the default one is not made,
/// a named one is left out with a warning. `scene` must outlive them. Throws ConfigError for unknown kinds and bad keys.
template <int D>
std::vector<std::unique_ptr<Observer<D>>> make_observers(const Config& config,
                                                         const Scene<D>& scene, const Clock& clock,
                                                         bool steps_are_time = true);

}  // namespace odpd
