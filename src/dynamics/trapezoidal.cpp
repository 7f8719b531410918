#include "odpd/dynamics/trapezoidal.h"

namespace odpd {

template <int D>
const StepRecord<D>& Trapezoidal<D>::step(Dynamics<D>& dynamics, const Clock& clock) {
  record_.step = clock.step;
  record_.dt = clock.dt;
  record_.has_corrector = true;
  record_.alarm_crossings = 0;
  dynamics.reorder_if_due(clock.step);
  dynamics.evaluate(dynamics.particles().position, clock.time(), record_.start);
  const std::vector<double> xi =
      dynamics.draw_noise(record_.start, clock.step, clock.dt, record_.edge_noise);
  std::vector<double> q(xi.size(), 0.0);
  dynamics.solve(record_.start, xi, q);

  const std::vector<Vec<D>> predicted =
      dynamics.displaced(record_.start.velocity, clock.dt, record_.alarm_crossings);
  dynamics.evaluate(predicted, clock.time() + clock.dt, record_.corrector);
  // The first answer is the guess of the second solve; the noise is the stored vector, never drawn again.
  dynamics.solve(record_.corrector, xi, q);

  record_.v_mid.resize(record_.start.velocity.size());
  for (std::size_t i = 0; i < record_.v_mid.size(); ++i)
    record_.v_mid[i] = 0.5 * (record_.start.velocity[i] + record_.corrector.velocity[i]);
  record_.alarm_crossings += dynamics.move(record_.v_mid, clock.dt);
  return record_;
}

template class Trapezoidal<2>;
template class Trapezoidal<3>;

}  // namespace odpd
