#include "odpd/dynamics/shardlow.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "odpd/core/index.h"
#include "odpd/core/parallel.h"
#include "odpd/pairs/noise.h"

namespace odpd {

namespace {

/// Lowest colour that neither of two particles has yet; their sets grow as needed.
std::size_t lowest_free(const std::vector<std::uint64_t>& a, const std::vector<std::uint64_t>& b) {
  for (std::size_t word = 0;; ++word) {
    const std::uint64_t taken = (word < a.size() ? a[word] : 0) | (word < b.size() ? b[word] : 0);
    if (~taken != 0) return 64 * word + index(std::countr_one(taken));
  }
}

void insert(std::vector<std::uint64_t>& set, std::size_t colour) {
  if (set.size() <= colour / 64) set.resize(colour / 64 + 1, 0);
  set[colour / 64] |= std::uint64_t{1} << (colour % 64);
}

// What friction zeta and its noise change of a velocity u over dt, exactly; mu: (reduced) mass, w: standard normal.
double relaxation(double u, double zeta, double mu, double kT, double dt, double w) {
  const double x = zeta * dt / mu;
  return u * std::expm1(-x) + std::sqrt(-kT / mu * std::expm1(-2.0 * x)) * w;
}

// 1/I of each particle that spins, 0 for others; empty where nobody does.
template <int D>
std::vector<double> inverse_moments(const Particles<D>& particles) {
  std::vector<double> over(particles.spin_of_species.empty() ? 0 : particles.position.size());
  for (std::size_t i = 0; i < over.size(); ++i)
    if (particles.spins(i))
      over[i] = 1.0 / particles.spin_of_species[index(particles.species[i])].moment;
  return over;
}

// mu_perp of edge k, mu its reduced mass: the same where neither end turns.
template <int D>
double turning_mass(const PairNetwork<D>& network, std::size_t k,
                    const std::vector<double>& over_moment, double mu) {
  if (over_moment.empty() || network.lever_i.empty()) return mu;
  const double i = network.lever_i[k], j = network.lever_j[k];
  return 1.0 / (1.0 / mu + i * i * over_moment[index(network.i[k])] +
                j * j * over_moment[index(network.j[k])]);
}

}  // namespace

void EdgeColours::assign(std::span<const std::int32_t> i, std::span<const std::int32_t> j,
                         std::span<const char> free) {
  std::vector<std::vector<std::uint64_t>> taken(free.size());
  const std::vector<std::uint64_t> none;
  std::vector<std::size_t> colour(i.size());
  std::size_t most = 0;
  for (std::size_t k = 0; k < i.size(); ++k) {
    const auto p = index(i[k]), q = index(j[k]);
    colour[k] = lowest_free(free[p] ? taken[p] : none, free[q] ? taken[q] : none);
    if (free[p]) insert(taken[p], colour[k]);
    if (free[q]) insert(taken[q], colour[k]);
    most = std::max(most, colour[k] + 1);
  }
  start_.assign(most + 1, 0);
  for (const std::size_t c : colour) ++start_[c + 1];
  for (std::size_t c = 0; c < most; ++c) start_[c + 1] += start_[c];
  std::vector<std::size_t> next(start_.begin(), start_.end() - 1);
  edge_.resize(i.size());
  for (std::size_t k = 0; k < i.size(); ++k)
    edge_[next[colour[k]]++] = static_cast<std::int32_t>(k);
}

template <int D>
void Shardlow<D>::kick(Dynamics<D>& dynamics, double dt, std::vector<Vec<D>>& velocity) const {
  const Stage<D>& stage = this->record_.start;
  const double weight = dt / dynamics.constants().mass;
  for (std::size_t i = 0; i < velocity.size(); ++i)
    if (dynamics.particles().is_free(i))
      velocity[i] += weight * (stage.potential_force[i] + stage.driving_force[i]);
}

// Friction and noise of all pairs. The record gets what friction at the start's velocities leaves of the force that
// acted.
template <int D>
void Shardlow<D>::exchange(Dynamics<D>& dynamics, const Clock& clock, std::vector<Vec<D>>& velocity,
                           std::vector<Vec<D>>& spin) {
  const Particles<D>& particles = dynamics.particles();
  const PairNetwork<D>& network = this->record_.start.network;
  const double mass = dynamics.constants().mass;
  std::vector<char> free(velocity.size());
  for (std::size_t i = 0; i < free.size(); ++i) free[i] = particles.is_free(i) ? 1 : 0;
  colours_.assign(network.i, network.j, free);
  const std::vector<Vec<D>>&start = this->record_.start.velocity,
        &start_spin = this->record_.start.spin;
  const std::vector<double> over_moment = inverse_moments(particles);
  std::vector<Vec<D>>& edge_force = this->record_.edge_noise;
  edge_force.resize(index(network.size()));
  const PairRandom random(dynamics.settings().seed, static_cast<std::uint64_t>(clock.step));
  const bool thermal = dynamics.model().thermal();
  const auto pass = [&](std::size_t k) {
    const auto i = index(network.i[k]), j = index(network.j[k]);
    const Vec<D>& e = network.e[k];
    const double mu = free[i] && free[j] ? 0.5 * mass : mass;
    const EdgeNormals<D> w(random, network, particles, k);
    const Vec<D> slip = network.slip(k, velocity, spin);
    const double along = dot(slip, e);
    Vec<D> change = relaxation(along, network.zeta_par[k], mu, network.kT[k], clock.dt,
                               thermal ? w.along() : 0.0) *
                    e;
    if (network.zeta_perp[k] > 0.0) {
      const Vec<D> across = slip - along * e, n = thermal ? w.across() : Vec<D>{};
      const double mu_perp = turning_mass(network, k, over_moment, mu), share = mu_perp / mu;
      for (int c = 0; c < D; ++c)
        change[c] += share * relaxation(across[c], network.zeta_perp[k], mu_perp, network.kT[k],
                                        clock.dt, n[c]);
    }
    if (!over_moment.empty() && !network.lever_i.empty()) {
      const Vec<D> turn = torque(e, mu * change);
      if (over_moment[i] > 0.0) spin[i] -= network.lever_i[k] * over_moment[i] * turn;
      if (over_moment[j] > 0.0) spin[j] -= network.lever_j[k] * over_moment[j] * turn;
    }
    if (free[i]) velocity[i] += (mu / mass) * change;
    if (free[j]) velocity[j] -= (mu / mass) * change;
    const Vec<D> first = network.slip(k, start, start_spin);
    const double zeta = network.zeta_par[k] - network.zeta_perp[k];
    edge_force[k] =
        (mu / clock.dt) * change + zeta * dot(first, e) * e + network.zeta_perp[k] * first;
  };
  for (std::size_t colour = 0; colour < colours_.count(); ++colour) {
    const auto edges = colours_.edges(colour);
    parallel_for(static_cast<std::int64_t>(edges.size()),
                 [&](std::int64_t n) { pass(index(edges[index(n)])); });
  }
}

template <int D>
void Shardlow<D>::drag(Dynamics<D>& dynamics, const Clock& clock,
                       std::vector<Vec<D>>& velocity) const {
  const ParticleConstants& s = dynamics.constants();
  if (s.zeta_0 == 0.0) return;
  std::vector<Vec<D>> w(velocity.size());
  if (dynamics.model().thermal())
    add_drag_noise(dynamics.particles(), dynamics.settings().seed,
                   static_cast<std::uint64_t>(clock.step), 1.0, w);
  for (std::size_t i = 0; i < velocity.size(); ++i)
    for (int c = 0; c < D; ++c)
      if (dynamics.particles().is_free(i))
        velocity[i][c] += relaxation(velocity[i][c], s.zeta_0, s.mass, s.kT, clock.dt, w[i][c]);
}

template <int D>
const StepRecord<D>& Shardlow<D>::step(Dynamics<D>& dynamics, const Clock& clock) {
  auto& record = this->record_;
  Motion<D>& motion = dynamics.motion();
  this->begin(dynamics, clock);
  const std::vector<double> end = motion.end_velocity(record.start);
  std::vector<Vec<D>> velocity = motion.velocities(record.start, end);
  std::vector<Vec<D>> spin = motion.spins(record.start, end);
  if (begun_) kick(dynamics, 0.5 * clock.dt, velocity);
  record.start.velocity = velocity;
  record.start.spin = spin;
  record.v_start = velocity;
  record.w_start = spin;
  {
    const PhaseTimer timer(dynamics.phases(), Phase::solve);
    exchange(dynamics, clock, velocity, spin);
    drag(dynamics, clock, velocity);
  }
  kick(dynamics, 0.5 * clock.dt, velocity);
  begun_ = true;
  std::vector<double> q;
  dynamics.dofs().gather({}, velocity, spin, q);
  this->move(dynamics, clock, q);
  dynamics.dofs().times_inertia({}, q);
  motion.set_end_momentum(q);
  return record;
}

template class Shardlow<2>;
template class Shardlow<3>;

}  // namespace odpd
