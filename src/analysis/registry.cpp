#include "odpd/analysis/registry.h"

#include <fmt/format.h>

#include <algorithm>

#include "odpd/analysis/angular_displacement.h"
#include "odpd/analysis/bodies.h"
#include "odpd/analysis/contact_angle.h"
#include "odpd/analysis/density_residual.h"
#include "odpd/analysis/divergence.h"
#include "odpd/analysis/drop.h"
#include "odpd/analysis/heat.h"
#include "odpd/analysis/high_frequency_viscosity.h"
#include "odpd/analysis/mobility.h"
#include "odpd/analysis/modes.h"
#include "odpd/analysis/molecules.h"
#include "odpd/analysis/msd.h"
#include "odpd/analysis/profile.h"
#include "odpd/analysis/rdf.h"
#include "odpd/analysis/stress.h"
#include "odpd/analysis/surface_tension.h"
#include "odpd/analysis/thermo.h"
#include "odpd/analysis/velocities.h"
#include "odpd/analysis/viscosity.h"
#include "odpd/analysis/wall_force.h"
#include "odpd/analysis/wave_amplitude.h"
#include "odpd/core/error.h"
#include "odpd/core/log.h"

namespace odpd {

template <int D>
const std::vector<ObserverKind<D>>& observer_kinds() {
  static const std::vector<ObserverKind<D>> table{
      {.name = "thermo", .make = Thermo<D>::make, .always = true},
      {.name = "profile", .make = Profile<D>::make},
      {.name = "density-residual", .make = DensityResidual<D>::make},
      {.name = "rdf", .make = Rdf<D>::make},
      {.name = "msd", .make = Msd<D>::make, .of_motion = true, .always = true},
      {.name = "rotation", .make = AngularDisplacement<D>::make, .of_motion = true},
      {.name = "heat", .make = Heat<D>::make, .of_motion = true},
      {.name = "wall-force", .make = WallForce<D>::make},
      {.name = "stress", .make = Stress<D>::make},
      {.name = "bodies", .make = Bodies<D>::make},
      {.name = "viscosity", .make = Viscosity<D>::make, .of_motion = true},
      {.name = "high-frequency-viscosity",
       .make = HighFrequencyViscosity<D>::make,
       .of_motion = true},
      {.name = "mobility", .make = Mobility<D>::make, .of_motion = true},
      {.name = "divergence", .make = Divergence<D>::make, .of_motion = true},
      {.name = "velocities", .make = Velocities<D>::make, .of_motion = true},
      {.name = "wave", .make = WaveAmplitude<D>::make, .of_motion = true},
      {.name = "modes", .make = Modes<D>::make, .of_motion = true},
      {.name = "molecules", .make = MoleculeStatistics<D>::make},
      {.name = "surface-tension", .make = SurfaceTension<D>::make},
      {.name = "drop", .make = Drop<D>::make},
      {.name = "contact-angle", .make = ContactAngle<D>::make}};
  return table;
}

namespace {

template <int D>
std::vector<ObserverKind<D>> all_kinds(const std::vector<ObserverKind<D>>& own) {
  std::vector<ObserverKind<D>> kinds = observer_kinds<D>();
  for (const ObserverKind<D>& kind : own) {
    if (std::any_of(kinds.begin(), kinds.end(), [&](const auto& k) { return k.name == kind.name; }))
      throw ConfigError(fmt::format(
          "there is a kind of observer '{}' already: give yours another name", kind.name));
    kinds.push_back(kind);
  }
  return kinds;
}

template <int D>
std::vector<std::string> names_of(const std::vector<ObserverKind<D>>& kinds) {
  std::vector<std::string> names;
  for (const ObserverKind<D>& kind : kinds) names.push_back(kind.name);
  return names;
}

// Refuses the newest observer where its name is taken.
template <int D>
void check_name(const Config& entry, const std::vector<ObserverKind<D>>& kinds,
                const std::vector<std::unique_ptr<Observer<D>>>& observers) {
  const ObserverSettings& newest = observers.back()->settings();
  // Results of those that are always there carry no prefix.
  for (const ObserverKind<D>& kind : kinds)
    if (kind.always && newest.name == kind.name && newest.kind != kind.name)
      entry.fail("name",
                 fmt::format("the name '{}' belongs to the observers of that kind", kind.name));
  for (std::size_t k = 0; k + 1 < observers.size(); ++k)
    if (observers[k]->settings().name == newest.name)
      entry.fail("name", fmt::format("two observers are named '{}': give each a name of its own",
                                     newest.name));
}

}  // namespace

template <int D>
std::vector<std::unique_ptr<Observer<D>>> make_observers(const Config& config,
                                                         const Scene<D>& scene, const Clock& clock,
                                                         const IntegratorTraits& integrator,
                                                         const std::vector<ObserverKind<D>>& own) {
  const std::vector<ObserverKind<D>> kinds = all_kinds(own);
  std::vector<std::unique_ptr<Observer<D>>> observers;
  for (const Config& entry : config.tables("observe")) {
    const std::string name = entry.choice("kind", names_of(kinds));
    const auto kind =
        std::find_if(kinds.begin(), kinds.end(), [&](const auto& k) { return k.name == name; });
    observers.push_back(kind->make({name, entry, scene, clock, integrator.in_time,
                                    integrator.two_stages, integrator.half_way_velocity}));
    check_name(entry, kinds, observers);
    if (!kind->of_motion || integrator.in_time) continue;
    log_warning(fmt::format(
        "observer '{}' is left out: sweeps of monte-carlo are no time and particles have no "
        "velocity, which '{}' measures by",
        observers.back()->settings().name, name));
    observers.pop_back();
  }
  const Config nothing = Config::from_text("", "defaults");
  for (const ObserverKind<D>& kind : kinds) {
    const bool there = std::any_of(observers.begin(), observers.end(),
                                   [&](const auto& o) { return o->settings().kind == kind.name; });
    if (kind.always && !there && (integrator.in_time || !kind.of_motion))
      observers.push_back(kind.make({kind.name, nothing, scene, clock, integrator.in_time,
                                     integrator.two_stages, integrator.half_way_velocity}));
  }
  return observers;
}

template const std::vector<ObserverKind<2>>& observer_kinds<2>();
template const std::vector<ObserverKind<3>>& observer_kinds<3>();
template std::vector<std::unique_ptr<Observer<2>>> make_observers<2>(
    const Config&, const Scene<2>&, const Clock&, const IntegratorTraits&,
    const std::vector<ObserverKind<2>>&);
template std::vector<std::unique_ptr<Observer<3>>> make_observers<3>(
    const Config&, const Scene<3>&, const Clock&, const IntegratorTraits&,
    const std::vector<ObserverKind<3>>&);

}  // namespace odpd
