#include "odpd/dynamics/midpoint.h"

namespace odpd {

template <int D>
const StepRecord<D>& Midpoint<D>::step(Dynamics<D>& dynamics, const Clock& clock) {
  auto& record = this->record_;
  this->begin(dynamics, clock);
  record.start_weight = 0.0;
  const StepWeights weights{dynamics.inertia(clock.dt), 0.0};
  std::vector<double> q = dynamics.end_velocity();
  std::vector<double> impulse =
      dynamics.draw_noise(record.start, clock.step, clock.dt, record.edge_noise);
  for (std::size_t k = 0; k < q.size(); ++k) impulse[k] += weights.inertia * q[k];

  std::vector<double> load = dynamics.force(record.start);
  for (std::size_t k = 0; k < load.size(); ++k) load[k] += impulse[k];
  dynamics.solve(record.start, load, weights, q);

  const double half = 0.5 * clock.dt;
  const std::vector<Vec<D>> middle =
      dynamics.displaced(record.start.velocity, half, record.alarm_crossings);
  dynamics.evaluate(middle, clock.time() + half, record.corrector);
  load = dynamics.force(record.corrector);
  for (std::size_t k = 0; k < load.size(); ++k) load[k] += impulse[k];
  dynamics.solve(record.corrector, load, weights, q);
  this->finish(dynamics, clock, q);
  return record;
}

template class Midpoint<2>;
template class Midpoint<3>;

}  // namespace odpd
