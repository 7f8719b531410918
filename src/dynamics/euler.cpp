#include "odpd/dynamics/euler.h"

namespace odpd {

template <int D>
const StepRecord<D>& Euler<D>::step(Dynamics<D>& dynamics, const Clock& clock) {
  record_.step = clock.step;
  record_.dt = clock.dt;
  dynamics.reorder_if_due(clock.step);
  dynamics.evaluate(dynamics.particles().position, clock.time(), record_.start);
  const std::vector<double> xi =
      dynamics.draw_noise(record_.start, clock.step, clock.dt, record_.edge_noise);
  std::vector<double> q(xi.size(), 0.0);
  dynamics.solve(record_.start, xi, q);
  record_.v_mid = record_.start.velocity;
  record_.alarm_crossings = dynamics.move(record_.v_mid, clock.dt);
  return record_;
}

template class Euler<2>;
template class Euler<3>;

}  // namespace odpd
