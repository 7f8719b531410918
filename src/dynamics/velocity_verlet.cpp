#include "odpd/dynamics/velocity_verlet.h"

namespace odpd {

template <int D>
const StepRecord<D>& VelocityVerlet<D>::step(Dynamics<D>& dynamics, const Clock& clock) {
  auto& record = this->record_;
  Motion<D>& motion = dynamics.motion();
  this->begin(dynamics, clock);
  const double half_kick = 0.5 * clock.dt / dynamics.constants().mass;
  // The end velocity of the particles is the predicted one.
  std::vector<double> predicted = motion.end_velocity(record.start);
  record.start.velocity = motion.velocities(record.start, predicted);
  record.start.spin = motion.spins(record.start, predicted);
  std::vector<double> force =
      dynamics.draw_noise(record.start, clock.step, clock.dt, record.edge_noise);
  const std::vector<double> rest = dynamics.total_force(record.start, predicted);
  for (std::size_t k = 0; k < force.size(); ++k) force[k] += rest[k];
  dynamics.dofs().divide_by_inertia({}, force);  // torques by I/m: accelerations times m

  std::vector<double> v = predicted;
  if (!half_way_.empty()) {
    v = half_way_.unknowns(dynamics);
    for (std::size_t k = 0; k < v.size(); ++k) v[k] += half_kick * force[k];
  }
  record.v_start = motion.velocities(record.start, v);
  record.w_start = motion.spins(record.start, v);
  std::vector<double> half_way = v;
  for (std::size_t k = 0; k < v.size(); ++k) {
    half_way[k] += half_kick * force[k];
    predicted[k] = v[k] + 2.0 * lambda_ * half_kick * force[k];
  }
  this->move(dynamics, clock, half_way);
  motion.cross_faces(half_way);
  half_way_.keep(dynamics, half_way);
  dynamics.dofs().times_inertia({}, predicted);
  motion.set_end_momentum(predicted);
  return record;
}

template class VelocityVerlet<2>;
template class VelocityVerlet<3>;

}  // namespace odpd
