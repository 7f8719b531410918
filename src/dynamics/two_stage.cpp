#include "odpd/dynamics/two_stage.h"

#include "odpd/core/index.h"

namespace odpd {

namespace {

// zeta/M about which the momentum goes over to the first stage (docs/accuracy.md).
constexpr double crossover = 20.0;

// M + zeta, the mean diagonal of the matrix of the particles that move.
template <int D>
double mean_diagonal(const Resistance<D>& matrix) {
  std::vector<double> trace;
  for (const auto& block : matrix.diagonal()) {
    trace.push_back(0.0);
    for (std::size_t c = 0; c < D; ++c) trace.back() += block[c * D + c];
  }
  const Share share = matrix.share();
  return share.sum(trace) / static_cast<double>(D * share.count(std::ssize(trace)));
}

// g (M + R) g/g g in the unknowns of the solve: what a load meets along itself (1 for no load).
template <int D>
double resistance_to(const SpinResistance<D>& matrix, std::vector<double> g) {
  matrix.scale_load(g);
  std::vector<double> met(g.size());
  matrix.system().apply(g, met);
  const Share share = matrix.system().share();
  const double square = share.dot(g, g, D);
  return square > 0.0 ? share.dot(g, met, D) / square : 1.0;
}

}  // namespace

// P^T (F(r*) - F(r)), forces of potentials alone.
template <int D>
std::vector<double> TwoStage<D>::potential_change(Dynamics<D>& dynamics) const {
  const auto& record = this->record_;
  std::vector<double> before, change;
  dynamics.dofs().gather(record.start.arms, record.start.potential_force, before);
  dynamics.dofs().gather(record.corrector.arms, record.corrector.potential_force, change);
  for (std::size_t k = 0; k < change.size(); ++k) change[k] -= before[k];
  return change;
}

// dt/2 K* q + (c - 1/2) dt K q, what the second stage makes up for the implicit bonds of both.
template <int D>
void TwoStage<D>::add_bond_terms(Dynamics<D>& dynamics, double dt, const std::vector<double>& q,
                                 std::vector<double>& load) const {
  const auto& record = this->record_;
  const std::vector<double> ahead = dynamics.bond_spring(record.corrector, q);
  for (std::size_t k = 0; k < load.size(); ++k) load[k] += 0.5 * dt * ahead[k];
  if (reach_ == 0.5) return;
  const std::vector<double> here = dynamics.bond_spring(record.start, q);
  for (std::size_t k = 0; k < load.size(); ++k) load[k] += (reach_ - 0.5) * dt * here[k];
}

template <int D>
const StepRecord<D>& TwoStage<D>::step(Dynamics<D>& dynamics, const Clock& clock) {
  auto& record = this->record_;
  Motion<D>& motion = dynamics.motion();
  this->begin(dynamics, clock);
  record.start_weight = start_weight_;
  const bool implicit_bonds = implicit_bonds_ && record.start.network.bonds > 0;
  const StepWeights weights{dynamics.inertia(clock.dt), 0.0, implicit_bonds ? 0.5 * clock.dt : 0.0};
  std::vector<double> q = motion.end_velocity(record.start);
  std::vector<double> impulse =
      dynamics.draw_noise(record.start, clock.step, clock.dt, record.edge_noise);
  const std::vector<double> momentum = motion.times_inertia(record.start, q, weights.inertia);
  for (std::size_t k = 0; k < q.size(); ++k) impulse[k] += momentum[k];

  std::vector<double> load = dynamics.force(record.start);
  for (std::size_t k = 0; k < load.size(); ++k) load[k] += impulse[k];
  dynamics.solve(record.start, load, weights, q);
  std::vector<double> q_mid = q;
  std::vector<double> p_mid;
  double end_weight = 1.0 - start_weight_;
  if (dynamics.has_mass()) {
    const double x = mean_diagonal(dynamics.resistance()) / weights.inertia - 1.0;
    end_weight /= 1.0 + x * x / (crossover * crossover);
    p_mid = motion.times_inertia(record.start, q, 1.0 - end_weight);
  }

  const double ahead = reach_ * clock.dt;
  const std::vector<Vec<D>> predicted =
      motion.displaced(record.start.velocity, ahead, clock.time(), record.alarm_crossings);
  dynamics.evaluate(predicted, clock.time() + ahead, record.corrector);
  load = dynamics.force(record.corrector);
  // The noise is the stored vector, never drawn again or projected with the edges of r*.
  for (std::size_t k = 0; k < load.size(); ++k) load[k] += impulse[k];
  if (implicit_bonds) add_bond_terms(dynamics, clock.dt, q, load);
  if (dynamics.has_mass()) {
    std::vector<double> g = potential_change(dynamics);
    if (implicit_bonds) add_bond_terms(dynamics, clock.dt, q, g);
    // The matrix is still that of the first stage.
    const double weight = 1.0 - start_weight_ - end_weight;
    const double a = weight / resistance_to(dynamics.spin_resistance(), g);
    for (std::size_t k = 0; k < g.size(); ++k) p_mid[k] += a * g[k];
  }
  // The first answer is the guess of the second solve.
  dynamics.solve(record.corrector, load, weights, q);

  for (std::size_t k = 0; k < q.size(); ++k)
    q_mid[k] = start_weight_ * q_mid[k] + (1.0 - start_weight_) * q[k];
  if (dynamics.has_mass()) {
    const auto rest = motion.times_inertia(record.corrector, q, end_weight);
    for (std::size_t k = 0; k < q.size(); ++k) p_mid[k] += rest[k];
  }
  this->finish(dynamics, clock, q_mid, p_mid);
  record.respond = [this, &dynamics, again = false](const ParticleLoads<D>& loads,
                                                    double tolerance) mutable {
    auto motions = dynamics.respond(this->record_.start, loads, tolerance, again);
    again = true;
    return motions;
  };
  return record;
}

template class TwoStage<2>;
template class TwoStage<3>;

}  // namespace odpd
