#include "odpd/dynamics/integrator.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>

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

enum class Masses { any, zero, positive };
struct Entry {
  const char* name;
  Masses masses;
  bool bodies;  // moves rigid bodies of unknown motion
};
// Every integrator there is; `make_integrator` below makes them.
constexpr std::array<Entry, 9> table{{{"trapezoidal", Masses::any, true},
                                      {"midpoint", Masses::any, true},
                                      {"extrapolated", Masses::any, true},
                                      {"implicit", Masses::any, true},
                                      {"euler", Masses::zero, true},
                                      {"setd", Masses::positive, false},
                                      {"velocity-verlet", Masses::positive, false},
                                      {"shardlow", Masses::positive, false},
                                      {"monte-carlo", Masses::any, true}}};

}  // namespace

template <int D>
void Integrator<D>::begin(Dynamics<D>& dynamics, const Clock& clock) {
  record_.step = clock.step;
  record_.dt = clock.dt;
  record_.alarm_crossings = 0;
  dynamics.reorder_if_due(clock.step);
  dynamics.evaluate(dynamics.particles().position, clock.time(), record_.start);
  record_.v_start = dynamics.particles().end_velocity;
}

template <int D>
void Integrator<D>::finish(Dynamics<D>& dynamics, const Clock& clock, const Unknowns& q_mid,
                           const Unknowns& p_mid) {
  Motion<D>& motion = dynamics.motion();
  record_.v_mid = motion.velocities(record_.start, q_mid);
  record_.alarm_crossings += motion.move(record_.v_mid, clock.dt, clock.time());
  if (!dynamics.has_mass()) return;
  // What goes on is momentum, linear and angular: in 3D moments of inertia turn with the body.
  Unknowns p = motion.times_inertia(record_.start, motion.end_velocity(record_.start), 1.0);
  for (std::size_t k = 0; k < p.size(); ++k) p[k] = 2.0 * p_mid[k] - p[k];
  motion.set_end_momentum(p);
}

namespace {

// For each node where its values stand by identity: the particles', then w and V of the bodies.
template <int D>
std::vector<std::size_t> places(Dynamics<D>& dynamics) {
  const DofMap<D>& dofs = dynamics.dofs();
  std::vector<std::size_t> place(static_cast<std::size_t>(dofs.nodes()));
  const auto free = dofs.free_particles();
  for (std::size_t k = 0; k < free.size(); ++k)
    place[dofs.free_node(k)] =
        static_cast<std::size_t>(dynamics.particles().id[static_cast<std::size_t>(free[k])]);
  auto next = static_cast<std::size_t>(dofs.particles());
  for (std::size_t b = 0; b < static_cast<std::size_t>(dofs.bodies()); ++b) {
    place[b] = next++;
    place[dofs.body_node(b)] = next++;
  }
  return place;
}

}  // namespace

template <int D>
std::vector<double> by_identity(Dynamics<D>& dynamics, const std::vector<double>& q) {
  const std::vector<std::size_t> place = places(dynamics);
  const auto entries = dynamics.dofs().particles() + 2 * dynamics.dofs().bodies();
  std::vector<double> values(static_cast<std::size_t>(entries) * D, 0.0);
  for (std::size_t n = 0; n < place.size(); ++n)
    for (std::size_t c = 0; c < D; ++c) values[place[n] * D + c] = q[n * D + c];
  return values;
}

template <int D>
std::vector<double> from_identity(Dynamics<D>& dynamics, const std::vector<double>& values) {
  const auto entries = dynamics.dofs().particles() + 2 * dynamics.dofs().bodies();
  if (values.size() != static_cast<std::size_t>(entries) * D)
    throw IoError(
        "the checkpoint's integrator arrays do not fit the particles: it is damaged or of another "
        "case");
  const std::vector<std::size_t> place = places(dynamics);
  std::vector<double> q(place.size() * D);
  for (std::size_t n = 0; n < place.size(); ++n)
    for (std::size_t c = 0; c < D; ++c) q[n * D + c] = values[place[n] * D + c];
  return q;
}

std::vector<std::string> integrator_names() {
  std::vector<std::string> names;
  for (const Entry& entry : table) names.emplace_back(entry.name);
  return names;
}

IntegratorSettings read_integrator(const Config& config) {
  IntegratorSettings settings;
  settings.name = config.choice("name", integrator_names(), settings.name);
  // monte-carlo runs any case, whatever scheme it was written for.
  const bool any = settings.name == "monte-carlo";
  if (settings.name == "velocity-verlet" || (any && config.has("lambda"))) {
    settings.lambda = config.non_negative("lambda", settings.lambda);
    if (settings.lambda > 1.0) config.fail("lambda", "must be between 0 and 1");
  }
  if (settings.name == "implicit" || (any && config.has("theta"))) {
    settings.theta = config.positive("theta", settings.theta);
    if (settings.theta > 1.0) config.fail("theta", "must be above 0 and at most 1");
  }
  const bool two_stages = settings.name == "trapezoidal" || settings.name == "midpoint";
  if ((two_stages || any) && config.has("implicit_bonds"))
    settings.implicit_bonds = config.boolean("implicit_bonds");
  if (settings.name == "setd" || (any && config.has("order"))) {
    const std::int64_t order = config.positive_integer("order", settings.order);
    if (order > 2) config.fail("order", "must be 1 or 2");
    settings.order = static_cast<int>(order);
  }
  if (settings.name == "monte-carlo") settings.step = config.positive("step", settings.step);
  return settings;
}

std::string mass_objection(const std::string& name, double mass) {
  const auto entry =
      std::find_if(table.begin(), table.end(), [&](const Entry& e) { return name == e.name; });
  if (entry == table.end()) return {};
  if (entry->masses == Masses::zero && mass > 0.0)
    return fmt::format(
        "'{}' is a scheme for mass 0 only, but fluid.mass = {}: use trapezoidal, or set fluid.mass "
        "= 0.0",
        name, mass);
  if (entry->masses == Masses::positive && mass == 0.0)
    return fmt::format(
        "'{}' needs fluid.mass above 0: at mass 0 use trapezoidal, midpoint or extrapolated", name);
  return {};
}

std::string bodies_objection(const std::string& name) {
  const auto entry =
      std::find_if(table.begin(), table.end(), [&](const Entry& e) { return name == e.name; });
  if (entry == table.end() || entry->bodies) return {};
  return fmt::format(
      "'{}' moves particles one by one, but the scene has bodies that move freely ([[body]]): use "
      "trapezoidal, at any mass",
      name);
}

std::string shear_objection(const std::string& name) {
  if (name != "monte-carlo") return {};
  return "'monte-carlo' samples an equilibrium, and a sheared fluid has none: leave [shear] "
         "out, or use trapezoidal";
}

template <int D>
std::unique_ptr<Integrator<D>> make_integrator(const IntegratorSettings& settings) {
  const std::string& name = settings.name;
  if (name == "trapezoidal") return std::make_unique<Trapezoidal<D>>(settings.implicit_bonds);
  if (name == "midpoint") return std::make_unique<Midpoint<D>>(settings.implicit_bonds);
  if (name == "extrapolated") return std::make_unique<Extrapolated<D>>();
  if (name == "implicit") return std::make_unique<Implicit<D>>(settings.theta);
  if (name == "euler") return std::make_unique<Euler<D>>();
  if (name == "setd") return std::make_unique<Setd<D>>(settings.order);
  if (name == "velocity-verlet") return std::make_unique<VelocityVerlet<D>>(settings.lambda);
  if (name == "shardlow") return std::make_unique<Shardlow<D>>();
  if (name == "monte-carlo") return std::make_unique<MonteCarlo<D>>(settings.step);
  throw ConfigError(fmt::format("there is no integrator '{}': use one of {}", name,
                                fmt::join(integrator_names(), ", ")));
}

#define ODPD_INSTANTIATE(D)                                                                \
  template class Integrator<D>;                                                            \
  template std::vector<double> by_identity<D>(Dynamics<D>&, const std::vector<double>&);   \
  template std::vector<double> from_identity<D>(Dynamics<D>&, const std::vector<double>&); \
  template std::unique_ptr<Integrator<D>> make_integrator<D>(const IntegratorSettings& settings);
ODPD_INSTANTIATE(2)
ODPD_INSTANTIATE(3)
#undef ODPD_INSTANTIATE

}  // namespace odpd
