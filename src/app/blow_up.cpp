#include "odpd/app/blow_up.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "odpd/analysis/thermo.h"
#include "odpd/core/index.h"
#include "odpd/core/parallel.h"
#include "odpd/operator/edge_sums.h"

namespace odpd {

namespace {

double two_digits_down(double x) {
  const double unit = std::pow(10.0, std::floor(std::log10(x)) - 1.0);
  return std::stod(fmt::format("{:.2g}", unit * std::floor(x / unit * (1.0 + 1e-12))));
}

}  // namespace

bool repulsion_is_explicit(const IntegratorSettings& integrator) {
  return integrator_traits(integrator.name).repulsion_limits_dt;
}

bool bonds_are_explicit(const IntegratorSettings& integrator) {
  const IntegratorTraits& traits = integrator_traits(integrator.name);
  return traits.repulsion_limits_dt && !(traits.takes_implicit_bonds && integrator.implicit_bonds);
}

template <int D>
struct BlowUpWatch<D>::Pairs {
  double count = 0.0, jumped = 0.0;
  double slip_squared = 0.0;  // of the end velocities
};

template <int D>
BlowUpWatch<D>::BlowUpWatch(const Scene<D>& scene, double multiple)
    : scene_(scene), multiple_(multiple) {
  double fastest_squared = 0.0;
  for (const auto& wall : scene.settings().walls)
    fastest_squared = std::max(fastest_squared, dot(wall.velocity, wall.velocity));
  for (const auto& body : scene.settings().bodies) {
    const double speed = norm(body.velocity.velocity) + norm(body.velocity.angular) * body.radius();
    fastest_squared = std::max(fastest_squared, speed * speed);
    const double lever = std::max(body.radius(), scene.model().cutoff());
    const double load = norm(body.load.force) + norm(body.load.torque) / lever;
    load_ += static_cast<double>(body.bodies()) * load;
    load_squared_ += static_cast<double>(body.bodies()) * load * load;
  }
  if (fastest_squared > 0.0)
    flow_slip_ = 2.0 * std::sqrt(fastest_squared * scene.model().cutoff() / fluid_depth());
  if (const SceneSettings<D>& s = scene.settings(); s.start_wave.number > 0)
    flow_slip_ += s.start_wave.largest(s.box, s.start_velocity) * scene.model().cutoff() *
                  std::sqrt(s.start_wave.wave_number_squared(s.box, s.start_velocity));
  // As between walls that move with half the sliding velocity each.
  if (const auto& shear = scene.box().shear)
    flow_slip_ += std::abs(shear->rate) *
                  std::sqrt(scene.model().cutoff() * scene.box().size[shear->gradient]);
}

template <int D>
double BlowUpWatch<D>::fluid_depth() const {
  double depth = 0.0;
  for (const auto& wall : scene_.settings().walls)
    depth = std::max(depth, scene_.fluid_high()[wall.axis] - scene_.fluid_low()[wall.axis]);
  const bool moved = std::any_of(scene_.settings().bodies.begin(), scene_.settings().bodies.end(),
                                 [](const auto& body) { return body.motion == BodyMotion::given; });
  if (depth > 0.0 || !(scene_.settings().force_varies() || moved)) return depth;
  // Without walls a force that varies, or a moving body, drives streams as wide as the box or less.
  for (int c = 0; c < D; ++c) depth = std::max(depth, scene_.box().size[c]);
  return depth;
}

template <int D>
auto BlowUpWatch<D>::sum_pairs(const Stage<D>& stage, double dt) const -> Pairs {
  const Particles<D>& particles = scene_.particles();
  const PairNetwork<D>& network = stage.network;
  double reach = 0.0;  // without the weak friction of longer range
  for (const PairMoments& p : scene_.pair_moments()) reach = std::max(reach, p.range);
  Pairs sum;
  for (std::size_t k = 0; k < network.i.size(); ++k) {
    if (!network.counts(k)) continue;
    const auto i = index(network.i[k]), j = index(network.j[k]);
    if (network.r[k] > reach || !particles.is_free(i) || !particles.is_free(j)) continue;
    sum.count += 1.0;
    const Vec<D> path = dt * network.slip(k, particles.velocity);
    if (dot(path, path) > std::pow(scene_.model().cutoff(), 2)) sum.jumped += 1.0;
    if (particles.end_velocity.empty()) continue;
    const Vec<D> slip = network.slip(k, particles.end_velocity);
    sum.slip_squared += dot(slip, slip);
  }
  std::array<double, 3> sums{sum.count, sum.jumped, sum.slip_squared};
  particles.ranks().sum(std::span(sums));
  return {sums[0], sums[1], sums[2]};
}

template <int D>
std::string BlowUpWatch<D>::judge_temperatures(const Stage<D>& stage, const Pairs& pairs,
                                               const std::vector<double>& force_squared,
                                               const std::vector<double>& laplacian) {
  const SceneSettings<D>& s = scene_.settings();
  const auto n = static_cast<double>(scene_.particles().free_count());
  const auto moving = static_cast<double>(scene_.particles().moving_count());
  const double kT = scene_.largest_kT();
  if (s.mass > 0.0 && pairs.count > 0.0) {
    const double freedom = D * std::min(pairs.count, n);
    const double kinetic = s.mass * pairs.slip_squared / (2.0 * D * pairs.count);
    const double bound = multiple_ * (kT + start_energy_ + s.mass * flow_slip_ * flow_slip_) *
                         (1.0 + 10.0 / freedom);
    if (kinetic > bound)
      return fmt::format(
          "the kinetic temperature of neighbours, {:.3g}, is more than {:.3g}, with kT = {} and "
          "run.blow_up = {}",
          kinetic, bound, kT, multiple_);
  }
  double force = 0.0, friction = 0.0;
  for (const PairMoments& p : scene_.pair_moments()) {
    force = std::max(force, p.force);
    friction = std::max(friction, p.zeta_par + p.zeta_perp);
  }
  if (!(force > 0.0) || !(kT > 0.0)) return {};
  const Share own = scene_.particles().owned();
  double squares = 0.0;
  for (const double x : own.part(std::span(laplacian), 1)) squares += x * x;
  squares = own.ranks->sum(squares);
  std::int64_t edges = 0;
  for (std::size_t k = 0; k < stage.network.i.size(); ++k) edges += stage.network.counts(k) ? 1 : 0;
  const double contacts = 2.0 * static_cast<double>(own.ranks->sum(edges)) / moving;
  const double drag =
      contacts * friction * flow_slip_ +
      s.largest_force() * fluid_depth() * std::pow(moving / scene_.fluid_volume(), 1.0 / D);
  const double square = own.sum(force_squared), curvature = own.sum(laplacian);
  const double driven = n * drag * drag + load_squared_;
  const double scale = kT * (std::max(curvature, 0.0) + 3.0 * std::sqrt(squares)) + driven;
  const bool sound = square <= multiple_ * scale;
  if (!sound && ordered_)
    return fmt::format(
        "the configurational temperature {} (kT = {}, run.blow_up = {}): the particles lie as if "
        "thrown there at random",
        curvature > 0.0
            ? fmt::format("is {:.3g}", square / curvature)
            : std::string("has no value, as the mean curvature of the energy is negative"),
        kT, multiple_);
  // The scatter S lets a small random arrangement pass now and then, so that it says nothing of the start.
  const bool settled = square <= 3.0 * (kT * curvature + driven);
  const bool had_time = stage.time > relaxations * repulsion_limit().value_or(0.0);
  ordered_ = ordered_ || settled || (sound && had_time);
  return {};
}

template <int D>
std::string BlowUpWatch<D>::judge(const Stage<D>& stage, double dt) {
  const SceneSettings<D>& s = scene_.settings();
  const auto n = static_cast<double>(scene_.particles().moving_count());
  const double kT = scene_.largest_kT();
  std::vector<double> force_squared, laplacian;
  double wall_energy = 0.0;
  configurational_terms(scene_, scene_.particles(), stage, force_squared, laplacian, wall_energy);
  const double energy = (stage.network.energy() + scene_.particles().ranks().sum(wall_energy)) / n;
  if (!std::isfinite(energy)) return "the energy is not finite";
  if (start_energy_ < 0.0) {
    // Attraction may take it below zero, which is no scale.
    start_energy_ = std::max(energy, 0.0);
    for (const PairMoments& p : scene_.pair_moments())
      if (p.energy_beyond_core)
        start_energy_ =
            std::max(start_energy_, 0.5 * (n / scene_.fluid_volume()) * *p.energy_beyond_core);
  }
  const double bound = multiple_ * (start_energy_ + D * kT + s.largest_force() * fluid_depth() +
                                    load_ * scene_.model().cutoff() / n);
  // Without any energy in the scene there is no scale to judge it by.
  if (bound > 0.0 && energy > bound)
    return fmt::format(
        "the energy per particle, {:.4g}, is more than {:.4g}, with run.blow_up = {}", energy,
        bound, multiple_);
  const Pairs pairs = sum_pairs(stage, dt);
  const auto& kinds = scene_.pair_moments();
  const bool strong = std::any_of(kinds.begin(), kinds.end(), [&](const PairMoments& p) {
    return p.force > 0.0 && p.force * p.force_range >= 10.0 * kT;
  });
  if (strong && 2.0 * pairs.jumped > pairs.count)
    return fmt::format(
        "{:.0f} % of the neighbours moved by more than a cutoff relative to each other in one step",
        100.0 * pairs.jumped / pairs.count);
  return judge_temperatures(stage, pairs, force_squared, laplacian);
}

template <int D>
std::int64_t BlowUpWatch<D>::fastest() const {
  const Particles<D>& particles = scene_.particles();
  const Share own = particles.owned();
  std::int64_t id = -1;
  double most = 0.0;
  for (auto i = index(own.first); i < index(own.last); ++i) {
    const double square = dot(particles.velocity[i], particles.velocity[i]);
    if (!particles.is_free(i) || !(square > most)) continue;
    most = square;
    id = particles.id[i];
  }
  // The first rank with the fastest of all tells. All ask, also those that have nobody free.
  const double fastest_of_all = own.ranks->largest(most);
  const bool here = id >= 0 && most == fastest_of_all;
  const std::int64_t teller =
      own.ranks->smallest(std::int64_t{here ? own.ranks->rank() : own.ranks->size()});
  return teller == own.ranks->size() ? -1 : own.ranks->sum(teller == own.ranks->rank() ? id : 0);
}

template <int D>
double BlowUpWatch<D>::friction_limit(const IntegratorSettings& integrator,
                                      const Stage<D>& stage) const {
  const int from = integrator_traits(integrator.name).friction_limits_dt_from;
  if (from == 0 || integrator.order < from) return std::numeric_limits<double>::infinity();
  std::vector<std::array<double, index(D * D)>> blocks(stage.position.size());
  add_friction_blocks<D>(stage.network, blocks);
  const Share own = scene_.particles().owned();
  double trace = 0.0;
  for (auto i = index(own.first); i < index(own.last); ++i)
    for (std::size_t c = 0; c < D && scene_.particles().is_free(i); ++c)
      trace += blocks[i][c * (D + 1)];
  trace = own.ranks->sum(trace);
  const double friction =
      trace / (D * static_cast<double>(scene_.particles().free_count())) + scene_.settings().zeta_0;
  const double turning = spin_relaxation(stage);
  const double linear = scene_.settings().mass / friction;
  return turning > 0.0 ? std::min(linear, 1.0 / turning) : linear;
}

// The largest rate at which friction stops a spin, l^2 zeta_perp over the moment of inertia; 0 where nobody has one. (A mean would not
// do: that of a particle in a dense place goes as the square of the distances there.)
template <int D>
double BlowUpWatch<D>::spin_relaxation(const Stage<D>& stage) const {
  const Particles<D>& particles = scene_.particles();
  const PairNetwork<D>& network = stage.network;
  const Share own = particles.owned();
  // Of e x, over the components of a spin.
  constexpr double across = static_cast<double>(D - 1) / rotation_components<D>;
  double largest = 0.0;
  for (auto i = index(own.first); i < index(own.last) && !network.lever_i.empty(); ++i) {
    if (!particles.spins(i)) continue;
    const double moment = particles.spin_of_species[index(particles.species[i])].moment;
    if (moment == 0.0) continue;
    double rate = 0.0;
    for (const std::int32_t edge : network.edges_of(static_cast<std::int64_t>(i))) {
      const auto k = index(edge);
      const double arm =
          network.i[k] == static_cast<std::int32_t>(i) ? network.lever_i[k] : network.lever_j[k];
      rate += across * network.zeta_perp[k] * arm * arm / moment;
    }
    largest = std::max(largest, rate);
  }
  return own.ranks->largest(largest);
}

template <int D>
std::optional<double> BlowUpWatch<D>::repulsion_limit() const {
  return scene_.explicit_step_limit();
}

template <int D>
double BlowUpWatch<D>::smaller_step(const IntegratorSettings& integrator, const Stage<D>& stage,
                                    double dt) const {
  const double repulsion = repulsion_is_explicit(integrator) ? repulsion_limit().value_or(dt) : dt;
  return two_digits_down(std::min({0.5 * dt, repulsion, friction_limit(integrator, stage)}));
}

template <int D>
std::string BlowUpWatch<D>::cure(const IntegratorSettings& integrator, const Stage<D>& stage,
                                 double dt, std::int64_t particle) const {
  std::vector<std::string> causes;
  const std::optional<double> repulsion = repulsion_limit();
  if (repulsion && dt > *repulsion && repulsion_is_explicit(integrator))
    causes.push_back(fmt::format(
        "integrator.dt = {} is beyond {:.2g}, the limit of explicit repulsion (0.2 zeta/k of the "
        "stiffest pair, in DPD 0.2 gamma/a{})",
        dt, *repulsion, scene_.settings().mass > 0.0 ? "; or 0.1 sqrt(m/k)" : ""));
  const double inertia = friction_limit(integrator, stage);
  if (dt > inertia)
    causes.push_back(fmt::format(
        "integrator.dt = {} is beyond {:.2g} = m/(friction of a particle){}, the limit "
        "of '{}' (not of "
        "trapezoidal or shardlow)",
        dt, inertia, stage.network.lever_i.empty() ? "" : " or I/(friction of its spin)",
        integrator.name));
  if (particle >= 0 && !stage.network.start.empty()) {
    const auto i = scene_.particles().index_of_id()[index(particle)];
    const std::size_t neighbours = stage.network.edges_of(i).size();
    if (neighbours <= D)
      causes.push_back(
          fmt::format("particle {} has only {} neighbour(s) to hold it (a rattler), which "
                      "fluid.rattler_friction, a "
                      "higher fluid.density, fluid.mass above 0 or, at rest, fluid.zeta_0 cures",
                      particle, neighbours));
  }
  if (causes.empty()) causes.emplace_back("integrator.dt is too large for this case");
  std::string text = "Likely cause: " + causes.front();
  for (std::size_t k = 1; k < causes.size(); ++k) text += "; and " + causes[k];
  return text + fmt::format(". Remedy: integrator.dt = {}", smaller_step(integrator, stage, dt));
}

template <int D>
void BlowUpWatch<D>::save(StateWriter& out) const {
  out.write("start_energy", std::vector<double>{start_energy_});
  out.write("ordered", std::vector<std::int64_t>{ordered_ ? 1 : 0});
}

template <int D>
void BlowUpWatch<D>::load(const StateReader& in) {
  start_energy_ = in.read_doubles("start_energy").at(0);
  ordered_ = in.read_integers("ordered").at(0) != 0;
}

template class BlowUpWatch<2>;
template class BlowUpWatch<3>;

}  // namespace odpd
