#include "odpd/analysis/observer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "odpd/analysis/bodies.h"
#include "odpd/analysis/density_residual.h"
#include "odpd/analysis/divergence.h"
#include "odpd/analysis/heat.h"
#include "odpd/analysis/molecules.h"
#include "odpd/analysis/msd.h"
#include "odpd/analysis/profile.h"
#include "odpd/analysis/rdf.h"
#include "odpd/analysis/stress.h"
#include "odpd/analysis/thermo.h"
#include "odpd/analysis/viscosity.h"
#include "odpd/analysis/wall_force.h"
#include "odpd/core/log.h"

namespace odpd {

namespace {

int read_axis(const Config& config, const std::string& key, int dimension,
              const std::string& fallback) {
  std::vector<std::string> names;
  for (int c = 0; c < dimension; ++c) names.emplace_back(1, "xyz"[c]);
  return config.choice(key, names, fallback)[0] - 'x';
}

// Direction across which a profile makes sense by default: that of a shear, the first bounded one, or that along which the
// force varies.
template <int D>
std::string default_axis(const Scene<D>& scene) {
  if (scene.box().shear) return {"xyz"[scene.box().shear->gradient]};
  for (int c = 0; c < D; ++c)
    if (!scene.box().is_periodic(c)) return {"xyz"[c]};
  const auto& s = scene.settings();
  if (s.force_wave.number > 0) return {"xyz"[s.force_wave.along]};
  if (!s.force_regions.empty()) return {"xyz"[s.force_regions[0].axis]};
  return "y";
}

// Bins whose centres a fit would use.
template <int D>
std::int64_t bins_between(const ProfileSettings& p, const Scene<D>& scene) {
  const double low = scene.fluid_low()[p.axis];
  const double width = (scene.fluid_high()[p.axis] - low) / static_cast<double>(p.bins);
  std::int64_t count = 0;
  for (std::int64_t b = 0; b < p.bins; ++b) {
    const double centre = low + width * (static_cast<double>(b) + 0.5);
    if (centre >= p.fit_from && centre <= p.fit_to) ++count;
  }
  return count;
}

template <int D>
std::unique_ptr<Observer<D>> make_profile(const Config& entry, ObserverSettings settings,
                                          const Scene<D>& scene) {
  ProfileSettings p;
  p.axis = read_axis(entry, "axis", D, default_axis(scene));
  p.bins = entry.positive_integer("bins", 20);
  const std::string fit = entry.choice("fit", {"none", "linear", "parabola", "sine"}, "none");
  p.fit = fit == "linear"     ? ProfileFit::linear
          : fit == "parabola" ? ProfileFit::parabola
          : fit == "sine"     ? ProfileFit::sine
                              : ProfileFit::none;
  const ForceWave& wave = scene.settings().force_wave;
  if (p.fit == ProfileFit::sine && (wave.number == 0 || wave.along != p.axis))
    entry.fail("fit", "a sine needs body_force.wave along the profile's axis");
  p.component =
      read_axis(entry, "component", D, {"xyz"[scene.box().shear ? scene.box().shear->flow : 0]});
  // By default the fit keeps one cutoff clear of the surfaces, where walls order the fluid.
  const double margin = scene.box().is_periodic(p.axis) ? 0.0 : scene.model().cutoff();
  p.fit_from = entry.number("fit_from", scene.fluid_low()[p.axis] + margin);
  p.fit_to = entry.number("fit_to", scene.fluid_high()[p.axis] - margin);
  if (!(p.fit_from < p.fit_to)) entry.fail("fit_from", "must be less than fit_to");
  const std::int64_t needed = p.fit == ProfileFit::none ? 0 : p.fit == ProfileFit::parabola ? 4 : 3;
  if (bins_between(p, scene) < needed)
    entry.fail(
        "fit",
        fmt::format(
            "needs at least {} bins with centres between fit_from = {} and fit_to = {}: use more "
            "bins or a wider range",
            needed, p.fit_from, p.fit_to));
  return std::make_unique<Profile<D>>(std::move(settings), p, scene);
}

template <int D>
typename Grid<D>::Counts read_cells(const Config& entry, const Scene<D>& scene) {
  const Vec<D> extent = scene.fluid_high() - scene.fluid_low();
  std::vector<double> fallback;
  for (int c = 0; c < D; ++c) fallback.push_back(std::max(1.0, std::round(extent[c])));
  const std::vector<double> given = entry.numbers("bins", fallback);
  if (given.size() != D) entry.fail("bins", fmt::format("{} counts are needed", D));
  typename Grid<D>::Counts bins{};
  for (std::size_t c = 0; c < given.size(); ++c) {
    bins[c] = static_cast<std::int64_t>(given[c]);
    if (bins[c] < 1 || static_cast<double>(bins[c]) != given[c])
      entry.fail("bins", "counts must be whole and positive");
  }
  return bins;
}

template <int D>
std::unique_ptr<Observer<D>> make_residual(const Config& entry, ObserverSettings settings,
                                           const Scene<D>& scene) {
  const auto cells = read_cells(entry, scene);
  const double clear = entry.non_negative("clear_of_bodies", 0.0);
  if (clear > 0.0) {
    const auto& bodies = scene.settings().bodies;
    if (bodies.empty()) entry.fail("clear_of_bodies", "the scene has no [[body]]");
    if (scene.box().shear)
      entry.fail("clear_of_bodies",
                 "under [shear] cells behind a sliding face move past the bodies: leave the key "
                 "out");
    for (const auto& body : bodies)
      if (body.motion != BodyMotion::fixed)
        entry.fail(
            "clear_of_bodies",
            fmt::format("cells are left out around fixed bodies only, and '{}' moves: give it "
                        "motion = \"fixed\" or leave the key out",
                        body.name));
    if (DensityResidual<D>(settings, cells, scene, clear).cells() < 2)
      entry.fail("clear_of_bodies", "leaves less than two cells: use a smaller one, or more bins");
  }
  return std::make_unique<DensityResidual<D>>(std::move(settings), cells, scene, clear);
}

template <int D>
std::unique_ptr<Observer<D>> make_divergence(const Config& entry, ObserverSettings settings,
                                             const Scene<D>& scene) {
  if (scene.box().shear)
    entry.fail("kind",
               "under [shear] neighbouring cells of two images slide past each other: use "
               "walls, or a profile");
  const auto cells = read_cells(entry, scene);
  for (int c = 0; c < D; ++c)
    if (cells[static_cast<std::size_t>(c)] < 3)
      entry.fail("bins", "differences need at least 3 cells in every direction");
  return std::make_unique<Divergence<D>>(std::move(settings), cells, scene);
}

template <int D>
std::unique_ptr<Observer<D>> make_heat(const Config& entry, ObserverSettings settings,
                                       const Scene<D>& scene) {
  if (scene.settings().mass > 0.0)
    entry.fail("kind", "the balance of heat is that of a massless fluid: fluid.mass must be 0");
  if (scene.settings().zeta_0 > 0.0)
    entry.fail("kind", "the balance of heat leaves out the drag: fluid.zeta_0 must be 0");
  return std::make_unique<Heat<D>>(std::move(settings), scene);
}

template <int D>
std::unique_ptr<Observer<D>> make_rdf(const Config& entry, ObserverSettings settings,
                                      const Scene<D>& scene) {
  double most = 4.0 * scene.model().cutoff();
  for (int c = 0; c < D; ++c)
    if (scene.box().is_periodic(c)) most = std::min(most, 0.5 * scene.box().size[c]);
  const double r_max = entry.positive("r_max", std::min(most, 2.0 * scene.model().cutoff()));
  for (int c = 0; c < D; ++c)
    if (scene.box().is_periodic(c) && r_max > 0.5 * scene.box().size[c])
      entry.fail("r_max",
                 fmt::format("must be at most half the shortest periodic edge of the box, {}",
                             0.5 * scene.box().size[c]));
  const std::int64_t bins = entry.positive_integer("bins", 100);
  std::optional<RdfComparison> comparison;
  if (entry.has("reference")) {
    comparison = {entry.number("reference"), entry.non_negative("compare_from", 0.0),
                  entry.positive("compare_to", r_max)};
    if (comparison->to - comparison->from < r_max / static_cast<double>(bins) ||
        comparison->to > r_max)
      entry.fail("compare_to", fmt::format("must be at least a bin above compare_from and at most "
                                           "r_max = {}",
                                           r_max));
  }
  return std::make_unique<Rdf<D>>(std::move(settings), r_max, bins, scene, comparison);
}

template <int D>
MsdSettings read_msd(const Config& entry, const Scene<D>& scene) {
  MsdSettings m;
  m.window = entry.positive("window", 3.0);
  m.fit_from = entry.non_negative("fit_from", m.window / 3.0);
  if (m.fit_from >= m.window) entry.fail("fit_from", "must be less than window");
  // Along a bounded direction displacements saturate; along a moving wall or a force they are advection.
  std::vector<std::string> names, fallback;
  for (int c = 0; c < D; ++c) {
    names.emplace_back(1, "xyz"[c]);
    bool flows = scene.settings().forces_along(c) || !scene.box().is_periodic(c);
    for (const auto& wall : scene.settings().walls) flows = flows || wall.velocity[c] != 0.0;
    const auto& shear = scene.box().shear;
    flows = flows || (shear && shear->flow == c);
    for (const auto& body : scene.settings().bodies)
      flows = flows || body.velocity.velocity[c] != 0.0 || body.load.force[c] != 0.0;
    if (!flows) fallback.push_back(names.back());
  }
  if (fallback.empty())
    for (int c = 0; c < D; ++c)
      if (!scene.box().is_periodic(c)) fallback.push_back(names[static_cast<std::size_t>(c)]);
  if (fallback.empty())
    for (int c = 0; c < D; ++c)
      if (!scene.box().shear || scene.box().shear->flow != c)
        fallback.push_back(names[static_cast<std::size_t>(c)]);
  for (const std::string& name : entry.texts("directions", fallback)) {
    const auto at = std::find(names.begin(), names.end(), name);
    if (at == names.end())
      entry.fail("directions", fmt::format("there is no direction '{}'", name));
    m.directions.push_back(static_cast<int>(at - names.begin()));
    if (scene.box().shear && scene.box().shear->flow == m.directions.back())
      entry.fail("directions",
                 fmt::format("{} is the flow direction of [shear]: displacements along it are "
                             "advection, and jump where a particle crosses a sliding face",
                             name));
  }
  if (m.directions.empty()) entry.fail("directions", "at least one direction is needed");
  return m;
}

template <int D>
std::unique_ptr<Observer<D>> make_bodies(const Config& entry, ObserverSettings settings,
                                         const Scene<D>& scene, const Clock& clock, bool in_time) {
  if (scene.settings().bodies.empty()) entry.fail("kind", "the scene has no [[body]]");
  BodiesSettings b;
  b.msd = read_msd(entry, scene);
  double most = std::numeric_limits<double>::infinity();
  for (int c = 0; c < D; ++c)
    if (scene.box().is_periodic(c)) most = std::min(most, 0.5 * scene.box().size[c]);
  b.r_max = entry.positive("r_max", std::min(most, 2.0 * scene.model().cutoff()));
  if (b.r_max > most)
    entry.fail("r_max",
               fmt::format("must be at most half the shortest periodic edge of the box, {}", most));
  b.bin = entry.positive("bin", b.bin);
  if (b.bin > b.r_max) entry.fail("bin", "must be less than r_max");
  b.empty = entry.positive("empty", b.empty);
  if (b.empty >= 1.0) entry.fail("empty", "must be below 1, the mean density of the fluid");
  return std::make_unique<Bodies<D>>(std::move(settings), b, scene, clock.dt, in_time);
}

template <int D>
std::unique_ptr<Observer<D>> make_stress(const Config& entry, ObserverSettings settings,
                                         const Scene<D>& scene) {
  StressBins bins;
  bins.bins = entry.integer("bins", 0);
  if (bins.bins < 0) entry.fail("bins", "must be zero (none) or positive");
  if (bins.bins > 0) bins.axis = read_axis(entry, "axis", D, default_axis(scene));
  return std::make_unique<Stress<D>>(std::move(settings), bins, scene);
}

template <int D>
std::unique_ptr<Observer<D>> make_viscosity(const Config& entry, ObserverSettings settings,
                                            const Scene<D>& scene, const Clock& clock) {
  const ViscosityScene kind = viscosity_scene(scene);
  if (kind.kind == ViscosityScene::Kind::none)
    entry.fail("kind",
               "nothing in this scene shows a viscosity: move a wall, shear it steadily, drive the "
               "fluid along its "
               "walls or by body_force.wave, or leave a fully periodic fluid of kT > 0 at rest");
  ViscositySettings v;
  if (kind.has_profile()) {
    v.bins = entry.positive_integer("bins", 20);
    const ProfileSettings p{
        .axis = kind.axis, .bins = v.bins, .fit_from = kind.from, .fit_to = kind.to};
    if (bins_between(p, scene) < 4)
      entry.fail("bins", fmt::format("at least 4 bins with centres between {} and {} are needed: "
                                     "use more, or a wider stream",
                                     kind.from, kind.to));
    return std::make_unique<Viscosity<D>>(std::move(settings), v, scene, clock.dt);
  }
  if (!kind.needs_every_step())
    return std::make_unique<Viscosity<D>>(std::move(settings), v, scene, clock.dt);
  v.window = entry.positive("window", v.window);
  v.fit_from = entry.non_negative("fit_from", 0.4 * v.window);
  if (v.fit_from >= v.window) entry.fail("fit_from", "must be less than window");
  if (settings.every != 1)
    entry.fail("every", "must be 1: the stress is integrated over every step");
  return std::make_unique<Viscosity<D>>(std::move(settings), v, scene, clock.dt);
}

std::int64_t default_every(const std::string& kind, const Clock& clock) {
  if (kind == "thermo") return 5;
  if (kind == "rdf") return 20;
  if (kind == "bodies") return 2;
  // Fifty lags of up to 0.06 time units.
  if (kind == "msd" || kind == "molecules")
    return std::max<std::int64_t>(1, std::llround(0.05 / clock.dt));
  return 1;
}

// Steps of the measured part that an entry asks for by times.
void read_time_window(const Config& entry, const Clock& clock, ObserverSettings& settings) {
  if (entry.has("from")) settings.from = std::llround(entry.non_negative("from", 0.0) / clock.dt);
  if (entry.has("until")) settings.until = std::llround(entry.positive("until") / clock.dt);
  const std::int64_t last = std::min(settings.until, clock.total_steps - clock.equilibration_steps);
  const std::int64_t every = settings.every;
  if ((entry.has("from") || entry.has("until")) && last / every <= settings.from / every)
    entry.fail(
        entry.has("from") ? "from" : "until",
        fmt::format(
            "no step of the run is left to sample: after {} and up to {} of its {} "
            "measured time units, every {} step(s)",
            static_cast<double>(settings.from) * clock.dt, static_cast<double>(last) * clock.dt,
            static_cast<double>(clock.total_steps - clock.equilibration_steps) * clock.dt, every));
}

template <int D>
std::unique_ptr<Observer<D>> make_observer(const Config& entry, const std::string& kind,
                                           const Scene<D>& scene, const Clock& clock,
                                           bool in_time) {
  ObserverSettings settings;
  settings.kind = kind;
  settings.name = entry.text("name", kind);
  // It becomes the stem of files.
  if (!is_plain_name(settings.name) || settings.name == "particles")
    entry.fail("name", "use letters, digits, _ and - (and not 'particles', which names a picture)");
  settings.every = entry.positive_integer("every", default_every(kind, clock));
  settings.series = entry.boolean("series", false);
  read_time_window(entry, clock, settings);
  if (kind == "thermo") return std::make_unique<Thermo<D>>(std::move(settings), scene);
  if (kind == "profile") return make_profile(entry, std::move(settings), scene);
  if (kind == "density-residual") return make_residual(entry, std::move(settings), scene);
  if (kind == "divergence") return make_divergence(entry, std::move(settings), scene);
  if (kind == "heat") return make_heat(entry, std::move(settings), scene);
  if (kind == "stress") return make_stress(entry, std::move(settings), scene);
  if (kind == "viscosity") return make_viscosity(entry, std::move(settings), scene, clock);
  if (kind == "rdf") return make_rdf(entry, std::move(settings), scene);
  if (kind == "wall-force") {
    if (scene.settings().walls.empty())
      entry.fail("kind", "the scene has no [[wall]] to feel a force");
    return std::make_unique<WallForce<D>>(std::move(settings), scene);
  }
  if (kind == "bodies") return make_bodies(entry, std::move(settings), scene, clock, in_time);
  if (kind == "molecules") {
    if (scene.settings().molecules.empty()) entry.fail("kind", "the scene has no [[molecule]]");
    return std::make_unique<MoleculeStatistics<D>>(std::move(settings), read_msd(entry, scene),
                                                   scene, clock.dt, in_time);
  }
  return std::make_unique<Msd<D>>(std::move(settings), read_msd(entry, scene), scene, clock.dt);
}

}  // namespace

template <int D>
std::vector<std::unique_ptr<Observer<D>>> make_observers(const Config& config,
                                                         const Scene<D>& scene, const Clock& clock,
                                                         bool steps_are_time) {
  const std::vector<std::string> kinds{"thermo", "profile",   "density-residual", "rdf",
                                       "msd",    "heat",      "wall-force",       "stress",
                                       "bodies", "viscosity", "divergence",       "molecules"};
  const std::vector<std::string> of_motion{"msd", "viscosity", "heat", "divergence"};
  std::vector<std::unique_ptr<Observer<D>>> observers;
  const auto have = [&](const std::string& kind) {
    return std::any_of(observers.begin(), observers.end(),
                       [&](const auto& o) { return o->settings().kind == kind; });
  };
  for (const Config& entry : config.tables("observe")) {
    observers.push_back(
        make_observer(entry, entry.choice("kind", kinds), scene, clock, steps_are_time));
    const ObserverSettings& newest = observers.back()->settings();
    for (const char* kind : {"thermo", "msd"})
      if (newest.name == kind && newest.kind != kind)
        entry.fail("name",
                   fmt::format("the name '{}' belongs to the observers of that kind", kind));
    for (std::size_t k = 0; k + 1 < observers.size(); ++k)
      if (observers[k]->settings().name == observers.back()->settings().name)
        entry.fail("name", fmt::format("two observers are named '{}': give each a name of its own",
                                       observers[k]->settings().name));
    if (std::find(of_motion.begin(), of_motion.end(), newest.kind) != of_motion.end() &&
        !steps_are_time) {
      log_warning(fmt::format(
          "observer '{}' is left out: sweeps of monte-carlo are no time and particles have no "
          "velocity, which '{}' measures by",
          newest.name, newest.kind));
      observers.pop_back();
    }
  }
  const Config nothing = Config::from_text("", "defaults");
  for (const std::string kind : {"thermo", "msd"})
    if (!have(kind) && (steps_are_time || kind != "msd"))
      observers.push_back(make_observer(nothing, kind, scene, clock, steps_are_time));
  return observers;
}

template std::vector<std::unique_ptr<Observer<2>>> make_observers<2>(const Config&, const Scene<2>&,
                                                                     const Clock&, bool);
template std::vector<std::unique_ptr<Observer<3>>> make_observers<3>(const Config&, const Scene<3>&,
                                                                     const Clock&, bool);

}  // namespace odpd
