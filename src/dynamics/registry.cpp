// The name table of the integrators.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <tuple>

#include "odpd/core/error.h"
#include "odpd/dynamics/euler.h"
#include "odpd/dynamics/extrapolated.h"
#include "odpd/dynamics/implicit.h"
#include "odpd/dynamics/midpoint.h"
#include "odpd/dynamics/monte_carlo.h"
#include "odpd/dynamics/setd.h"
#include "odpd/dynamics/shardlow.h"
#include "odpd/dynamics/trapezoidal.h"
#include "odpd/dynamics/velocity_verlet.h"

namespace odpd {

namespace {

void read_lambda(const Config& config, IntegratorSettings& settings) {
  settings.lambda = config.non_negative("lambda", settings.lambda);
  if (settings.lambda > 1.0) config.fail("lambda", "must be between 0 and 1");
}

void read_theta(const Config& config, IntegratorSettings& settings) {
  settings.theta = config.positive("theta", settings.theta);
  if (settings.theta > 1.0) config.fail("theta", "must be above 0 and at most 1");
}

void read_implicit_bonds(const Config& config, IntegratorSettings& settings) {
  if (config.has("implicit_bonds")) settings.implicit_bonds = config.boolean("implicit_bonds");
}

void read_order(const Config& config, IntegratorSettings& settings) {
  const std::int64_t order = config.positive_integer("order", settings.order);
  if (order > 2) config.fail("order", "must be 1 or 2");
  settings.order = static_cast<int>(order);
}

void read_step(const Config& config, IntegratorSettings& settings) {
  settings.step = config.positive("step", settings.step);
}

// A key of the file, besides name and dt.
struct Key {
  const char* name = nullptr;
  void (*read)(const Config&, IntegratorSettings&) = nullptr;
};

template <int D>
using Maker = std::unique_ptr<Integrator<D>> (*)(const IntegratorSettings&);

struct Row {
  const char* name;
  IntegratorTraits traits;
  Key key;
  std::tuple<Maker<2>, Maker<3>> make;
};

template <template <int> class Scheme, int D, auto... parameters>
std::unique_ptr<Integrator<D>> make_scheme(const IntegratorSettings& settings) {
  return std::make_unique<Scheme<D>>(settings.*parameters...);
}

// parameters: what the scheme's constructor takes.
template <template <int> class Scheme, auto... parameters>
constexpr Row row(const char* name, const IntegratorTraits& traits, const Key& key = {}) {
  return {name,
          traits,
          key,
          {&make_scheme<Scheme, 2, parameters...>, &make_scheme<Scheme, 3, parameters...>}};
}

using S = IntegratorSettings;
constexpr auto positive = Masses::positive;
// Every integrator there is.
constexpr std::array table{
    row<Trapezoidal, &S::implicit_bonds>("trapezoidal",
                                         {.two_stages = true, .takes_implicit_bonds = true},
                                         {"implicit_bonds", &read_implicit_bonds}),
    row<Midpoint, &S::implicit_bonds>("midpoint",
                                      {.two_stages = true, .takes_implicit_bonds = true},
                                      {"implicit_bonds", &read_implicit_bonds}),
    row<Extrapolated>("extrapolated", {}),
    row<Implicit, &S::theta>("implicit", {.repulsion_limits_dt = false}, {"theta", &read_theta}),
    row<Euler>("euler", {.masses = Masses::zero}),
    row<Setd, &S::order>("setd",
                         {.masses = positive,
                          .moves_bodies = false,
                          .turns_particles = false,
                          .friction_limits_dt_from = 2},
                         {"order", &read_order}),
    row<VelocityVerlet, &S::lambda>("velocity-verlet",
                                    {.masses = positive,
                                     .half_way_velocity = true,
                                     .moves_bodies = false,
                                     .friction_limits_dt_from = 1},
                                    {"lambda", &read_lambda}),
    row<Shardlow>("shardlow", {.masses = positive, .moves_bodies = false}),
    row<MonteCarlo, &S::step>(
        "monte-carlo", {.in_time = false, .runs_sheared = false, .repulsion_limits_dt = false},
        {"step", &read_step})};

const Row& find_scheme(const std::string& name) {
  const auto found =
      std::find_if(table.begin(), table.end(), [&](const Row& r) { return name == r.name; });
  if (found != table.end()) return *found;
  throw ConfigError(fmt::format("there is no integrator '{}': use one of {}", name,
                                fmt::join(integrator_names(), ", ")));
}

}  // namespace

std::vector<std::string> integrator_names() {
  std::vector<std::string> names;
  for (const Row& scheme : table) names.emplace_back(scheme.name);
  return names;
}

const IntegratorTraits& integrator_traits(const std::string& name) {
  return find_scheme(name).traits;
}

IntegratorSettings read_integrator(const Config& config) {
  IntegratorSettings settings;
  settings.name = config.choice("name", integrator_names(), settings.name);
  const Row& scheme = find_scheme(settings.name);
  if (scheme.key.read != nullptr) scheme.key.read(config, settings);
  // Monte Carlo runs any case, whatever scheme it was written for.
  if (!scheme.traits.in_time)
    for (const Row& other : table)
      if (other.key.read != nullptr && config.has(other.key.name)) other.key.read(config, settings);
  return settings;
}

std::string mass_objection(const std::string& name, double mass) {
  const Masses masses = integrator_traits(name).masses;
  if (masses == Masses::zero && mass > 0.0)
    return fmt::format(
        "'{}' is a scheme for mass 0 only, but fluid.mass = {}: use trapezoidal, or set fluid.mass "
        "= 0.0",
        name, mass);
  if (masses == Masses::positive && mass == 0.0)
    return fmt::format(
        "'{}' needs fluid.mass above 0: at mass 0 use trapezoidal, midpoint or extrapolated", name);
  return {};
}

std::string bodies_objection(const std::string& name) {
  if (integrator_traits(name).moves_bodies) return {};
  return fmt::format(
      "'{}' moves particles one by one, but the scene has bodies that move freely ([[body]]): use "
      "trapezoidal, at any mass",
      name);
}

std::string spin_objection(const std::string& name, bool massless) {
  const IntegratorTraits& traits = integrator_traits(name);
  if (!traits.turns_particles)
    return fmt::format(
        "'{}' knows no spins, but particles have a lever_radius: use trapezoidal, at any mass, or "
        "shardlow",
        name);
  if (traits.masses == Masses::positive && massless)
    return fmt::format(
        "'{}' turns particles by their moment of inertia, and that of some is 0: give moment > 0, "
        "or use trapezoidal",
        name);
  return {};
}

std::string shear_objection(const std::string& name) {
  if (integrator_traits(name).runs_sheared) return {};
  return fmt::format(
      "'{}' samples an equilibrium, and a sheared fluid has none: leave [shear] out, or use "
      "trapezoidal",
      name);
}

template <int D>
std::unique_ptr<Integrator<D>> make_integrator(const IntegratorSettings& settings) {
  return std::get<Maker<D>>(find_scheme(settings.name).make)(settings);
}

template std::unique_ptr<Integrator<2>> make_integrator<2>(const IntegratorSettings&);
template std::unique_ptr<Integrator<3>> make_integrator<3>(const IntegratorSettings&);

}  // namespace odpd
