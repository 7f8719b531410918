#include "odpd/analysis/frozen.h"

#include "odpd/analysis/force_points.h"
#include "odpd/core/index.h"
#include "odpd/operator/edge_sums.h"

namespace odpd {

namespace {

// Of slips at the edges of this rank: s.Z s, and s.F_B where a random force was drawn.
template <int D, class Slip>
std::array<double, 2> work_of(const StepRecord<D>& record, const Slip& slip_of) {
  const PairNetwork<D>& network = record.start.network;
  std::array<double, 2> sums{};
  for (std::size_t k = 0; k < index(network.size()); ++k) {
    if (!network.counts(k)) continue;
    const Vec<D> slip = slip_of(k);
    sums[0] -= dot(slip, friction_of<D>(network, k, slip));
    if (!record.edge_noise.empty()) sums[1] += dot(record.edge_noise[k], slip);
  }
  return sums;
}

// Of the loads on particles of this rank.
template <int D>
double work_done(const ParticleLoads<D>& loads, const ParticleMotions<D>& motions,
                 const Share& own) {
  double work = 0.0;
  for (auto i = index(own.first); i < index(own.end(std::ssize(motions.velocity))); ++i) {
    work += dot(loads.force[i], motions.velocity[i]);
    if (!loads.torque.empty() && !motions.spin.empty())
      work += dot(loads.torque[i], motions.spin[i]);
  }
  return work;
}

}  // namespace

template <int D>
ForceAnswer<D> answer_to_force(const Particles<D>& particles, const StepRecord<D>& record,
                               const ParticleLoads<D>& loads, double zeta_0, double tolerance,
                               const FrozenPressure<D>* pressure) {
  const PairNetwork<D>& network = record.start.network;
  ForceAnswer<D> answer;
  static_cast<ParticleMotions<D>&>(answer) = record.respond(loads, tolerance);
  const std::vector<Vec<D>>&w = answer.velocity, &spin = answer.spin;
  const Share own = particles.owned();
  double of_rates = 0.0;
  if (pressure != nullptr) {
    const double plain = particles.ranks().sum(work_done(loads, answer, own));
    std::vector<double> rates = pressure->rates_of(answer);
    of_rates = pressure->hold(rates, answer, plain, tolerance).work;
  }
  const auto [power, noise] =
      work_of<D>(record, [&](std::size_t k) { return network.inner_slip(k, w, spin); });
  const double along = work_done(loads, answer, own);
  double drag = 0.0;
  for (auto i = index(own.first); i < index(own.end(std::ssize(w))); ++i)
    drag += zeta_0 * dot(w[i], w[i]);
  std::array<double, 2> sums{2.0 * along - power - drag, noise};
  particles.ranks().sum(std::span(sums));
  answer.mobility = sums[0] - 2.0 * of_rates;
  answer.noise = sums[1];
  return answer;
}

template <int D>
FlowAnswer answer_to_flow(const Particles<D>& particles, const StepRecord<D>& record,
                          const Gradient<D>& E, double tolerance,
                          const FrozenPressure<D>* pressure) {
  const PairNetwork<D>& network = record.start.network;
  const ForcePoints<D> points(particles, record.start);
  const auto affine = [&](std::size_t k) {
    const Vec<D> r = points.between(network, k);
    Vec<D> slip;
    for (std::size_t c = 0; c < D; ++c) slip.x[c] = dot(E[c], r);
    return slip;
  };
  std::vector<Vec<D>> friction(index(network.size()));
  ParticleLoads<D> load{std::vector<Vec<D>>(record.start.position.size())};
  for (std::size_t k = 0; k < friction.size(); ++k)
    friction[k] = -1.0 * friction_of<D>(network, k, affine(k));
  add_edge_forces<D>(network, friction, load.force);
  if (!network.lever_i.empty()) {
    load.torque.resize(load.force.size());
    add_edge_torques<D>(network, friction, load.torque);
  }
  // u = -w, what the particles move besides the flow.
  ParticleMotions<D> u = record.respond(load, tolerance);
  for (Vec<D>& v : u.velocity) v = -1.0 * v;
  for (Vec<D>& w : u.spin) w = -1.0 * w;
  const auto slip = [&](std::size_t k) {
    return affine(k) + u.velocity[index(network.i[k])] - u.velocity[index(network.j[k])] +
           network.spin_slip(k, u.spin);
  };
  double of_rates = 0.0;
  if (pressure != nullptr) {
    const double plain = particles.ranks().sum(work_of<D>(record, slip)[0]);
    std::vector<Vec<D>> slips(friction.size());
    for (std::size_t k = 0; k < slips.size(); ++k) slips[k] = slip(k);
    std::vector<double> rates = pressure->rates(slips);
    of_rates = pressure->hold(rates, u, plain, tolerance).work;
  }
  std::array<double, 2> sums = work_of<D>(record, slip);
  particles.ranks().sum(std::span(sums));
  return {.power = sums[0] + 2.0 * of_rates, .noise = sums[1]};
}

#define ODPD_INSTANTIATE(D)                                                             \
  template ForceAnswer<D> answer_to_force<D>(const Particles<D>&, const StepRecord<D>&, \
                                             const ParticleLoads<D>&, double, double,   \
                                             const FrozenPressure<D>*);                 \
  template FlowAnswer answer_to_flow<D>(const Particles<D>&, const StepRecord<D>&,      \
                                        const Gradient<D>&, double, const FrozenPressure<D>*);
ODPD_INSTANTIATE(2)
ODPD_INSTANTIATE(3)
#undef ODPD_INSTANTIATE

}  // namespace odpd
