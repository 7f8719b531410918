#include "odpd/analysis/observer_keys.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "odpd/core/index.h"

namespace odpd {

template <int D>
int read_direction(const Config& config, const std::string& key, int fallback) {
  std::vector<std::string> names;
  for (int c = 0; c < D; ++c) names.emplace_back(1, "xyz"[c]);
  return config.choice(key, names, {"xyz"[fallback]})[0] - 'x';
}

namespace {

template <int D>
int default_axis(const Scene<D>& scene) {
  if (scene.box().shear) return scene.box().shear->gradient;
  for (int c = 0; c < D; ++c)
    if (!scene.box().is_periodic(c)) return c;
  const auto& s = scene.settings();
  if (s.force_wave.number > 0) return s.force_wave.along;
  if (!s.force_regions.empty()) return s.force_regions[0].axis;
  return 1;
}

}  // namespace

template <int D>
int read_axis(const ObserverEntry<D>& entry) {
  return read_direction<D>(entry.config, "axis", default_axis(entry.scene));
}

template <int D>
bool flows_along(const Scene<D>& scene, int direction) {
  const SceneSettings<D>& s = scene.settings();
  const auto& shear = scene.box().shear;
  bool flows = s.forces_along(direction) || (shear && shear->flow == direction);
  for (const auto& wall : s.walls) flows = flows || wall.velocity[direction] != 0.0;
  for (const auto& body : s.bodies)
    flows = flows || body.velocity.velocity[direction] != 0.0 || body.load.force[direction] != 0.0;
  return flows;
}

template <int D>
std::vector<int> read_directions(const Config& config, const std::vector<int>& fallback) {
  std::vector<std::string> names, texts;
  for (int c = 0; c < D; ++c) names.emplace_back(1, "xyz"[c]);
  for (const int c : fallback) texts.push_back(names[index(c)]);
  std::vector<int> directions;
  for (const std::string& name : config.texts("directions", texts)) {
    const auto at = std::find(names.begin(), names.end(), name);
    if (at == names.end())
      config.fail("directions", fmt::format("there is no direction '{}'", name));
    directions.push_back(static_cast<int>(at - names.begin()));
  }
  if (directions.empty()) config.fail("directions", "at least one direction is needed");
  return directions;
}

template <int D>
typename Grid<D>::Counts read_cells(const ObserverEntry<D>& entry, double fewest) {
  const Vec<D> extent = entry.scene.fluid_high() - entry.scene.fluid_low();
  std::vector<double> fallback;
  for (int c = 0; c < D; ++c) fallback.push_back(std::max(fewest, std::round(extent[c])));
  const std::vector<double> given = entry.config.numbers("bins", fallback);
  if (given.size() != D) entry.config.fail("bins", fmt::format("{} counts are needed", D));
  typename Grid<D>::Counts bins{};
  for (std::size_t c = 0; c < given.size(); ++c) {
    bins[c] = static_cast<std::int64_t>(given[c]);
    if (bins[c] < 1 || static_cast<double>(bins[c]) != given[c])
      entry.config.fail("bins", "counts must be whole and positive");
  }
  return bins;
}

template <int D>
double read_r_max(const ObserverEntry<D>& entry, bool far) {
  const Box<D>& box = entry.scene.box();
  double most = std::numeric_limits<double>::infinity();
  for (int c = 0; c < D; ++c)
    if (box.is_periodic(c)) most = std::min(most, 0.5 * box.size[c]);
  const double near = std::min(most, 2.0 * entry.scene.model().cutoff());
  const double r_max = entry.config.positive("r_max", far && std::isfinite(most) ? most : near);
  if (r_max > most)
    entry.config.fail(
        "r_max",
        fmt::format("must be at most half the shortest periodic edge of the box, {}", most));
  return r_max;
}

LagRange read_lags(const Config& config) {
  LagRange lags{};
  lags.window = config.positive("window", 3.0);
  lags.fit_from = config.non_negative("fit_from", lags.window / 3.0);
  if (lags.fit_from >= lags.window) config.fail("fit_from", "must be less than window");
  return lags;
}

ControlKeys read_control(const Config& config, double window, double dt) {
  ControlKeys control;
  if (!config.boolean("control", false)) return control;
  control.every = window > 0.0 ? config.positive_integer("control_every", 1) : 1;
  control.tolerance = config.positive("control_tolerance", control.tolerance);
  if (control.tolerance >= 1.0) config.fail("control_tolerance", "must be less than 1");
  if (window > 0.0 && static_cast<double>(control.every) * dt > 0.25 * window)
    config.fail("control_every", "the window must hold four controlled steps");
  return control;
}

std::string control_with_bonds(const std::string& observer) {
  return observer +
         ": bonds that are taken implicitly and relax within a step (dt H near the friction or "
         "above) "
         "are missing in the memory, which makes eta too low: compare with plain, or with half the "
         "dt";
}

template <int D>
void refuse_frozen(const ObserverEntry<D>& entry) {
  if (entry.scene.settings().mass > 0.0)
    entry.config.fail(
        "kind", "is of particles without mass, which a load moves at once: set fluid.mass = 0");
  if (!entry.two_stages)
    entry.config.fail("kind",
                      "asks for solves at the step's start, which schemes of two stages give: use "
                      "the integrator 'trapezoidal' or 'midpoint'");
}

template <int D>
bool read_incompressible(const ObserverEntry<D>& entry) {
  const bool wanted = entry.config.boolean("incompressible", true);
  if (wanted && entry.scene.particles().free_count() == 0)
    entry.config.fail(entry.config.has("incompressible") ? "incompressible" : "kind",
                      "no particle is free, so that there is no fluid whose density a pressure "
                      "could keep: set incompressible = false");
  return wanted;
}

double read_frozen_tolerance(const Config& config) {
  const double tolerance = config.positive("tolerance", 0.01);
  if (tolerance >= 1.0) config.fail("tolerance", "must be less than 1");
  return tolerance;
}

void require_two_steps(const Config& config, double window, double dt) {
  if (config.has("window") && window < 2.0 * dt * (1.0 - 1e-9))
    config.fail("window", fmt::format("is {}: it must hold two steps of {} at least", window, dt));
}

#define ODPD_INSTANTIATE(D)                                                             \
  template int read_direction<D>(const Config&, const std::string&, int);               \
  template int read_axis<D>(const ObserverEntry<D>&);                                   \
  template bool flows_along<D>(const Scene<D>&, int);                                   \
  template std::vector<int> read_directions<D>(const Config&, const std::vector<int>&); \
  template typename Grid<D>::Counts read_cells<D>(const ObserverEntry<D>&, double);     \
  template void refuse_frozen<D>(const ObserverEntry<D>&);                              \
  template bool read_incompressible<D>(const ObserverEntry<D>&);                        \
  template double read_r_max<D>(const ObserverEntry<D>&, bool);
ODPD_INSTANTIATE(2)
ODPD_INSTANTIATE(3)
#undef ODPD_INSTANTIATE

}  // namespace odpd
