#include "odpd/analysis/observer.h"

#include <fmt/format.h>

#include <algorithm>

#include "odpd/analysis/density_residual.h"
#include "odpd/analysis/msd.h"
#include "odpd/analysis/profile.h"
#include "odpd/analysis/rdf.h"
#include "odpd/analysis/thermo.h"
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

// Direction across which a profile makes sense by default: that of a shear, or the first bounded one.
template <int D>
std::string default_axis(const Scene<D>& scene) {
  if (scene.box().shear) return {"xyz"[scene.box().shear->gradient]};
  for (int c = 0; c < D; ++c)
    if (!scene.box().is_periodic(c)) return {"xyz"[c]};
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
  const std::string fit = entry.choice("fit", {"none", "linear", "parabola"}, "none");
  p.fit = fit == "linear"     ? ProfileFit::linear
          : fit == "parabola" ? ProfileFit::parabola
                              : ProfileFit::none;
  p.component =
      read_axis(entry, "component", D, {"xyz"[scene.box().shear ? scene.box().shear->flow : 0]});
  // By default the fit keeps one cutoff clear of the surfaces, where walls order the fluid.
  const double margin = scene.box().is_periodic(p.axis) ? 0.0 : scene.model().cutoff();
  p.fit_from = entry.number("fit_from", scene.fluid_low()[p.axis] + margin);
  p.fit_to = entry.number("fit_to", scene.fluid_high()[p.axis] - margin);
  if (!(p.fit_from < p.fit_to)) entry.fail("fit_from", "must be less than fit_to");
  const std::int64_t needed = p.fit == ProfileFit::linear     ? 3
                              : p.fit == ProfileFit::parabola ? 4
                                                              : 0;
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
std::unique_ptr<Observer<D>> make_residual(const Config& entry, ObserverSettings settings,
                                           const Scene<D>& scene) {
  const Vec<D> extent = scene.fluid_high() - scene.fluid_low();
  std::vector<double> fallback;
  for (int c = 0; c < D; ++c) fallback.push_back(std::max(1.0, std::round(extent[c])));
  const std::vector<double> given = entry.numbers("bins", fallback);
  if (given.size() != D) entry.fail("bins", fmt::format("{} counts are needed", D));
  std::array<std::int64_t, static_cast<std::size_t>(D)> bins{};
  for (std::size_t c = 0; c < given.size(); ++c) {
    bins[c] = static_cast<std::int64_t>(given[c]);
    if (bins[c] < 1 || static_cast<double>(bins[c]) != given[c])
      entry.fail("bins", "counts must be whole and positive");
  }
  return std::make_unique<DensityResidual<D>>(std::move(settings), bins, scene);
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
std::unique_ptr<Observer<D>> make_msd(const Config& entry, ObserverSettings settings,
                                      const Scene<D>& scene, const Clock& clock) {
  MsdSettings m;
  m.window = entry.positive("window", 3.0);
  m.fit_from = entry.non_negative("fit_from", m.window / 3.0);
  if (m.fit_from >= m.window) entry.fail("fit_from", "must be less than window");
  // Along a bounded direction displacements saturate; along a moving wall or a force they are advection.
  std::vector<std::string> names, fallback;
  for (int c = 0; c < D; ++c) {
    names.emplace_back(1, "xyz"[c]);
    bool flows = scene.settings().body_force[c] != 0.0 || !scene.box().is_periodic(c);
    for (const auto& wall : scene.settings().walls) flows = flows || wall.velocity[c] != 0.0;
    const auto& shear = scene.box().shear;
    flows = flows || (shear && shear->flow == c);
    if (!flows) fallback.push_back(names.back());
  }
  if (fallback.empty())
    for (int c = 0; c < D; ++c)
      if (!scene.box().is_periodic(c)) fallback.push_back(names[static_cast<std::size_t>(c)]);
  if (fallback.empty()) fallback = names;
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
  return std::make_unique<Msd<D>>(std::move(settings), m, scene, clock.dt);
}

std::int64_t default_every(const std::string& kind, const Clock& clock) {
  if (kind == "thermo") return 5;
  if (kind == "rdf") return 20;
  // Fifty lags of up to 0.06 time units.
  if (kind == "msd") return std::max<std::int64_t>(1, std::llround(0.05 / clock.dt));
  return 1;
}

template <int D>
std::unique_ptr<Observer<D>> make_observer(const Config& entry, const std::string& kind,
                                           const Scene<D>& scene, const Clock& clock) {
  ObserverSettings settings;
  settings.kind = kind;
  settings.name = entry.text("name", kind);
  // It becomes the stem of files.
  if (!is_plain_name(settings.name) || settings.name == "particles")
    entry.fail("name", "use letters, digits, _ and - (and not 'particles', which names a picture)");
  settings.every = entry.positive_integer("every", default_every(kind, clock));
  settings.series = entry.boolean("series", false);
  if (kind == "thermo") return std::make_unique<Thermo<D>>(std::move(settings), scene);
  if (kind == "profile") return make_profile(entry, std::move(settings), scene);
  if (kind == "density-residual") return make_residual(entry, std::move(settings), scene);
  if (kind == "rdf") return make_rdf(entry, std::move(settings), scene);
  if (kind == "wall-force") {
    if (scene.settings().walls.empty())
      entry.fail("kind", "the scene has no [[wall]] to feel a force");
    return std::make_unique<WallForce<D>>(std::move(settings), scene);
  }
  return make_msd(entry, std::move(settings), scene, clock);
}

}  // namespace

template <int D>
std::vector<std::unique_ptr<Observer<D>>> make_observers(const Config& config,
                                                         const Scene<D>& scene, const Clock& clock,
                                                         bool steps_are_time) {
  const std::vector<std::string> kinds{"thermo", "profile", "density-residual",
                                       "rdf",    "msd",     "wall-force"};
  std::vector<std::unique_ptr<Observer<D>>> observers;
  const auto have = [&](const std::string& kind) {
    return std::any_of(observers.begin(), observers.end(),
                       [&](const auto& o) { return o->settings().kind == kind; });
  };
  for (const Config& entry : config.tables("observe")) {
    observers.push_back(make_observer(entry, entry.choice("kind", kinds), scene, clock));
    const ObserverSettings& newest = observers.back()->settings();
    for (const char* kind : {"thermo", "msd"})
      if (newest.name == kind && newest.kind != kind)
        entry.fail("name",
                   fmt::format("the name '{}' belongs to the observers of that kind", kind));
    for (std::size_t k = 0; k + 1 < observers.size(); ++k)
      if (observers[k]->settings().name == observers.back()->settings().name)
        entry.fail("name", fmt::format("two observers are named '{}': give each a name of its own",
                                       observers[k]->settings().name));
    if (newest.kind == "msd" && !steps_are_time) {
      log_warning(
          fmt::format("observer '{}' is left out: sweeps of monte-carlo are no time, so "
                      "displacements give no diffusion",
                      newest.name));
      observers.pop_back();
    }
  }
  const Config nothing = Config::from_text("", "defaults");
  for (const std::string kind : {"thermo", "msd"})
    if (!have(kind) && (steps_are_time || kind != "msd"))
      observers.push_back(make_observer(nothing, kind, scene, clock));
  return observers;
}

template std::vector<std::unique_ptr<Observer<2>>> make_observers<2>(const Config&, const Scene<2>&,
                                                                     const Clock&, bool);
template std::vector<std::unique_ptr<Observer<3>>> make_observers<3>(const Config&, const Scene<3>&,
                                                                     const Clock&, bool);

}  // namespace odpd
