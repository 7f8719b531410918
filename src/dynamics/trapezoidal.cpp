#include "odpd/dynamics/trapezoidal.h"

namespace odpd {

template <int D>
const StepRecord<D>& Trapezoidal<D>::step(Dynamics<D>& dynamics, const Clock& clock) {
  auto& record = this->record_;
  this->begin(dynamics, clock);
  record.start_weight = 0.5;
  const StepWeights weights{dynamics.inertia(clock.dt), 0.0};
  std::vector<double> q = dynamics.end_velocity();
  std::vector<double> impulse =
      dynamics.draw_noise(record.start, clock.step, clock.dt, record.edge_noise);
  for (std::size_t k = 0; k < q.size(); ++k) impulse[k] += weights.inertia * q[k];

  std::vector<double> load = dynamics.force(record.start);
  for (std::size_t k = 0; k < load.size(); ++k) load[k] += impulse[k];
  dynamics.solve(record.start, load, weights, q);
  std::vector<double> q_mid = q;

  const std::vector<Vec<D>> predicted =
      dynamics.displaced(record.start.velocity, clock.dt, record.alarm_crossings);
  dynamics.evaluate(predicted, clock.time() + clock.dt, record.corrector);
  load = dynamics.force(record.corrector);
  // The noise is the stored vector, never drawn again or projected with the edges of r*.
  for (std::size_t k = 0; k < load.size(); ++k) load[k] += impulse[k];
  dynamics.solve(record.corrector, load, weights, q);

  for (std::size_t k = 0; k < q.size(); ++k) q_mid[k] = 0.5 * (q_mid[k] + q[k]);
  this->finish(dynamics, clock, q_mid);
  return record;
}

template class Trapezoidal<2>;
template class Trapezoidal<3>;

}  // namespace odpd
