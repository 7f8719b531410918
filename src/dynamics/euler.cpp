#include "odpd/dynamics/euler.h"

namespace odpd {

template <int D>
const StepRecord<D>& Euler<D>::step(Dynamics<D>& dynamics, const Clock& clock) {
  auto& record = this->record_;
  this->begin(dynamics, clock);
  std::vector<double> load =
      dynamics.draw_noise(record.start, clock.step, clock.dt, record.edge_noise);
  const std::vector<double> force = dynamics.force(record.start);
  for (std::size_t k = 0; k < load.size(); ++k) load[k] += force[k];
  std::vector<double> q(load.size(), 0.0);
  dynamics.solve(record.start, load, {}, q);
  this->finish(dynamics, clock, q, q);
  return record;
}

template class Euler<2>;
template class Euler<3>;

}  // namespace odpd
