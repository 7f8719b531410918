#include "odpd/analysis/frozen_pressure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "odpd/core/error.h"
#include "odpd/core/index.h"
#include "odpd/core/parallel.h"
#include "odpd/operator/edge_sums.h"

namespace odpd {

namespace {

constexpr int most_cg_steps = 200;
constexpr double mass_tolerance = 0.1;
// Of `tolerance`. Changes of the value fall to a third or less with each iteration, so that what is left is of the last one's size.
constexpr double value_tolerance = 0.2;
// Times the value without a pressure: it grows for ever.
constexpr double too_much = 100.0;

}  // namespace

template <int D>
FrozenPressure<D>::FrozenPressure(const Particles<D>& particles, const StepRecord<D>& record,
                                  const PressureRange& range, double spacing, double tolerance)
    : record_(record), ranks_(particles.ranks()), own_(particles.owned()) {
  const auto n = record.start.position.size();
  free_.resize(n);
  const auto colloid = [&](std::size_t i) {
    return !range.colloid.empty() && range.colloid[index(particles.species[i])] != 0;
  };
  for (std::size_t i = 0; i < n; ++i) free_[i] = particles.is_free(i) && !colloid(i) ? 1 : 0;
  place(spacing);
  find_tensions(particles, range, tolerance);
  for (auto i = index(own_.first); i < index(own_.end(std::ssize(free_))); ++i)
    around(i, [&](std::size_t g, double h) { diagonal_[g] += weight_[i] * h * h; });
  ranks_.sum(std::span(diagonal_));
  mass_ = on_nodes(weight_);
}

// Along bounded directions the grid spans the free particles.
template <int D>
void FrozenPressure<D>::place(double spacing) {
  const Stage<D>& stage = record_.start;
  Vec<D> origin{}, cell{};
  std::array<std::int32_t, index(D)> last{};
  std::size_t nodes = 1;
  for (int c = 0; c < D; ++c) {
    const bool periodic = stage.box.is_periodic(c);
    double low = 0.0, high = stage.box.size[c];
    if (!periodic) {
      std::swap(low, high);
      for (auto i = index(own_.first); i < index(own_.end(std::ssize(free_))); ++i) {
        if (free_[i] == 0) continue;
        low = std::min(low, stage.position[i][c]);
        high = std::max(high, stage.position[i][c]);
      }
      low = ranks_.smallest(low);
      high = std::max(ranks_.largest(high), low + 1e-6 * spacing);
    }
    // Two nodes at least: one alone knows no compression along this direction.
    const double cells = std::max(periodic ? 2.0 : 1.0, std::round((high - low) / spacing));
    origin[c] = low;
    cell[c] = (high - low) / cells;
    last[index(c)] = static_cast<std::int32_t>(cells) - 1;
    count_[index(c)] = static_cast<std::int32_t>(cells) + (periodic ? 0 : 1);
    nodes *= index(count_[index(c)]);
  }
  place_.resize(free_.size());
  parallel_for(std::ssize(place_), [&](std::int64_t i) {
    const Vec<D> r = stage.box.straightened(stage.position[index(i)]);
    Place& at = place_[index(i)];
    for (int c = 0; c < D; ++c) {
      const double x = (r[c] - origin[c]) / cell[c];
      at.low[index(c)] = std::clamp(static_cast<std::int32_t>(std::floor(x)), 0, last[index(c)]);
      at.beyond[c] = std::clamp(x - at.low[index(c)], 0.0, 1.0);
    }
  });
  diagonal_.resize(nodes);
}

template <int D>
void FrozenPressure<D>::find_tensions(const Particles<D>& particles, const PressureRange& range,
                                      double tolerance) {
  const PairNetwork<D>& network = record_.start.network;
  const std::size_t species = range.colloid.size();
  const auto reach_of = [&](std::size_t k) {
    if (range.reaches.empty()) return range.reach;
    const auto a = index(particles.species[index(network.i[k])]),
               b = index(particles.species[index(network.j[k])]);
    return range.reaches[a * species + b];
  };
  tension_.resize(index(network.size()));
  weight_.resize(free_.size());
  parallel_for(network.pairs(), [&](std::int64_t pair) {
    const auto k = index(pair);
    const int ends = free_[index(network.i[k])] + free_[index(network.j[k])];
    const double reach = reach_of(k);
    tension_[k] = -2.0 / reach * std::max(0.0, 1.0 - network.r[k] / reach) * ends * network.e[k];
  });
  parallel_for(network.particles, [&](std::int64_t particle) {
    const auto i = index(particle);
    if (free_[i] == 0) return;
    double sum = 0.0;
    for (const std::int32_t k : network.edges_of(particle))
      sum += network.r[index(k)] * norm(tension_[index(k)]);
    weight_[i] = sum * sum;
  });
  const ParticleMotions<D> w = record_.respond(loads_of(tension_), tolerance);
  parallel_for(network.size(), [&](std::int64_t edge) {
    const auto k = index(edge), i = index(network.i[k]), j = index(network.j[k]);
    tension_[k] += friction_of<D>(network, k, network.inner_slip(k, w.velocity, w.spin));
    if (free_[i] == free_[j]) tension_[k] = 0.5 * tension_[k];
  });
}

template <int D>
ParticleLoads<D> FrozenPressure<D>::loads_of(const std::vector<Vec<D>>& edge_force) const {
  const PairNetwork<D>& network = record_.start.network;
  ParticleLoads<D> loads{std::vector<Vec<D>>(free_.size())};
  add_edge_forces<D>(network, edge_force, loads.force);
  if (!network.lever_i.empty()) {
    loads.torque.resize(free_.size());
    add_edge_torques<D>(network, edge_force, loads.torque);
  }
  return loads;
}

template <int D>
template <class F>
void FrozenPressure<D>::around(std::size_t i, const F& f) const {
  const Place& place = place_[i];
  for (unsigned corner = 0; corner < (1u << D); ++corner) {
    std::size_t g = 0;
    double h = 1.0;
    for (std::size_t c = 0; c < D; ++c) {
      const bool up = ((corner >> c) & 1u) != 0;
      h *= up ? place.beyond.x[c] : 1.0 - place.beyond.x[c];
      std::int32_t at = place.low[c] + (up ? 1 : 0);
      if (at == count_[c]) at = 0;
      g = g * index(count_[c]) + index(at);
    }
    f(g, h);
  }
}

template <int D>
std::vector<double> FrozenPressure<D>::on_nodes(const std::vector<double>& of_particles) const {
  std::vector<double> sums(nodes());
  for (auto i = index(own_.first); i < index(own_.end(std::ssize(of_particles))); ++i)
    if (of_particles[i] != 0.0)
      around(i, [&](std::size_t g, double h) { sums[g] += h * of_particles[i]; });
  ranks_.sum(std::span(sums));
  return sums;
}

template <int D>
std::vector<double> FrozenPressure<D>::at_particles(std::span<const double> of_nodes) const {
  std::vector<double> values(place_.size());
  parallel_for(std::ssize(values), [&](std::int64_t i) {
    double sum = 0.0;
    around(index(i), [&](std::size_t g, double h) { sum += h * of_nodes[g]; });
    values[index(i)] = sum;
  });
  return values;
}

template <int D>
std::vector<double> FrozenPressure<D>::rates(const std::vector<Vec<D>>& slips) const {
  const PairNetwork<D>& network = record_.start.network;
  std::vector<double> rate(place_.size());
  parallel_for(network.particles, [&](std::int64_t particle) {
    const auto i = index(particle);
    for (const std::int32_t edge : network.edges_of(particle)) {
      const auto k = index(edge);
      if (has_pressure(i, k)) rate[i] += dot(tension_[k], slips[k]);
    }
  });
  return on_nodes(rate);
}

template <int D>
std::vector<double> FrozenPressure<D>::rates_of(const ParticleMotions<D>& motions) const {
  const PairNetwork<D>& network = record_.start.network;
  std::vector<Vec<D>> slips(index(network.size()));
  parallel_for(std::ssize(slips), [&](std::int64_t edge) {
    const auto k = index(edge);
    slips[k] = network.inner_slip(k, motions.velocity, motions.spin);
  });
  return rates(slips);
}

template <int D>
void FrozenPressure<D>::drop_whole(std::vector<double>& rates) const {
  const double share = fixed_sum(rates) / fixed_sum(mass_);
  for (std::size_t g = 0; g < rates.size(); ++g) rates[g] -= share * mass_[g];
}

template <int D>
ParticleLoads<D> FrozenPressure<D>::push(std::span<const double> pressure) const {
  const PairNetwork<D>& network = record_.start.network;
  const std::vector<double> p = at_particles(pressure);
  std::vector<Vec<D>> edge_force(index(network.size()));
  parallel_for(std::ssize(edge_force), [&](std::int64_t edge) {
    const auto k = index(edge), i = index(network.i[k]), j = index(network.j[k]);
    const double sum = (has_pressure(i, k) ? p[i] : 0.0) + (has_pressure(j, k) ? p[j] : 0.0);
    edge_force[k] = -sum * tension_[k];
  });
  return loads_of(edge_force);
}

// By conjugate gradients of their own: sums over particles alone, which cost less than one solve of R.
template <int D>
std::vector<double> FrozenPressure<D>::preconditioned(const std::vector<double>& r) const {
  const auto by_diagonal = [&](const std::vector<double>& x) {
    std::vector<double> y(x.size());
    for (std::size_t g = 0; g < x.size(); ++g)
      y[g] = diagonal_[g] > 0.0 ? x[g] / diagonal_[g] : 0.0;
    return y;
  };
  std::vector<double> z(r.size()), left = r, y = by_diagonal(left), direction = y;
  double product = fixed_dot(left, y);
  const double wanted = mass_tolerance * mass_tolerance * product;
  for (int n = 0; n < most_cg_steps && product > wanted; ++n) {
    std::vector<double> x = at_particles(direction);
    for (std::size_t i = 0; i < x.size(); ++i) x[i] *= weight_[i];
    const std::vector<double> M = on_nodes(x);
    const double alpha = product / fixed_dot(direction, M);
    for (std::size_t g = 0; g < z.size(); ++g) {
      z[g] += alpha * direction[g];
      left[g] -= alpha * M[g];
    }
    y = by_diagonal(left);
    const double next = fixed_dot(left, y);
    for (std::size_t g = 0; g < z.size(); ++g) direction[g] = y[g] + next / product * direction[g];
    product = next;
  }
  return z;
}

template <int D>
auto FrozenPressure<D>::hold(std::vector<double>& rates, ParticleMotions<D>& motions, double value,
                             double tolerance) const -> Held {
  Held held{.pressure = std::vector<double>(nodes()), .work = 0.0};
  int solves = 0;
  drop_whole(rates);
  std::vector<double> z = preconditioned(rates), direction = z;
  double product = fixed_dot(rates, z), gained = 0.0;
  int small = 0;
  while (product > 0.0 && small < 2) {
    const ParticleMotions<D> u = record_.respond(push(direction), tolerance);
    ++solves;
    const std::vector<double> change = rates_of(u);
    const double down = fixed_dot(rates, direction);
    const double step = -down / fixed_dot(direction, change);
    gained += step * down;
    if (!(step > 0.0 && gained < too_much * value) || solves > most_cg_steps)
      throw SolverError(fmt::format(
          "no pressure keeps the fluid from compression in what the configuration answers to a "
          "load (solve {}): some of its {} free particles cannot give way on a grid of {} nodes, "
          "or solves to {:.3g} are too loose; use a smaller tolerance, or incompressible = false",
          solves, std::count(free_.begin(), free_.end(), 1), nodes(), tolerance));
    const auto add = [&](const std::vector<Vec<D>>& part, std::vector<Vec<D>>& to) {
      parallel_for(std::ssize(to), [&](std::int64_t i) { to[index(i)] += step * part[index(i)]; });
    };
    add(u.velocity, motions.velocity);
    add(u.spin, motions.spin);
    const std::vector<double> before = rates;
    for (std::size_t g = 0; g < rates.size(); ++g) {
      held.pressure[g] += step * direction[g];
      rates[g] += step * change[g];
    }
    drop_whole(rates);
    small = step * down < value_tolerance * tolerance * value ? small + 1 : 0;
    // Of the flexible kind (Polak and Ribiere), as neither z nor the product is exact.
    z = preconditioned(rates);
    const double next = fixed_dot(rates, z), beta = (next - fixed_dot(before, z)) / product;
    for (std::size_t g = 0; g < z.size(); ++g) direction[g] = z[g] + beta * direction[g];
    product = next;
  }
  held.work = fixed_dot(held.pressure, rates);
  return held;
}

template <int D>
PressureRange pressure_range(const Scene<D>& scene) {
  PressureRange range{.reach = scene.model().cutoff(), .reaches = {}, .colloid = {}};
  range.colloid.assign(scene.settings().species.size(), 0);
  for (const MoleculeSettings<D>& m : scene.settings().molecules)
    if (m.beads() == 1) range.colloid[index(m.species[0])] = 1;
  const std::span<const double> reaches = scene.model().reaches();
  const std::size_t species = range.colloid.size();
  if (reaches.size() != species * species) return range;
  std::vector<std::int64_t> count(species, 0);
  const Particles<D>& particles = scene.particles();
  for (std::size_t i = 0; i < particles.species.size(); ++i)
    if (particles.is_free(i)) ++count[index(particles.species[i])];
  for (std::size_t s = 0; s < species; ++s)
    if (range.colloid[s] != 0) count[s] = 0;
  const auto fluid = index(std::max_element(count.begin(), count.end()) - count.begin());
  range.reach = reaches[fluid * species + fluid];
  range.reaches = reaches;
  return range;
}

template <int D>
std::optional<FrozenPressure<D>> pressure_on(const Particles<D>& particles,
                                             const StepRecord<D>& record, const Scene<D>& scene,
                                             bool wanted, double tolerance) {
  if (!wanted) return {};
  const PressureRange range = pressure_range(scene);
  return std::optional<FrozenPressure<D>>(std::in_place, particles, record, range,
                                          pressure_spacing * range.reach, tolerance);
}

#define ODPD_INSTANTIATE(D)                                  \
  template class FrozenPressure<D>;                          \
  template PressureRange pressure_range<D>(const Scene<D>&); \
  template std::optional<FrozenPressure<D>> pressure_on<D>(  \
      const Particles<D>&, const StepRecord<D>&, const Scene<D>&, bool, double);
ODPD_INSTANTIATE(2)
ODPD_INSTANTIATE(3)
#undef ODPD_INSTANTIATE

}  // namespace odpd
