#include "odpd/dynamics/extrapolated.h"

namespace odpd {

template <int D>
const StepRecord<D>& Extrapolated<D>::step(Dynamics<D>& dynamics, const Clock& clock) {
  auto& record = this->record_;
  Motion<D>& motion = dynamics.motion();
  this->begin(dynamics, clock);
  const double inertia = dynamics.inertia(clock.dt);
  const double stiffness_time = theta_ * clock.dt;
  std::vector<double> q = motion.end_velocity(record.start);
  const std::vector<double> momentum = motion.times_inertia(record.start, q, inertia);
  const std::vector<double> force = dynamics.force(record.start);
  std::vector<double> load =
      dynamics.draw_noise(record.start, clock.step, clock.dt, record.edge_noise);
  for (std::size_t k = 0; k < q.size(); ++k) load[k] += momentum[k] + force[k];

  if (!last_velocity_.empty()) {
    const std::vector<double> last = last_velocity_.unknowns(dynamics);
    const std::vector<double> last_force = last_force_.unknowns(dynamics);
    const std::vector<double> drag = dynamics.friction(record.start, last);
    for (std::size_t k = 0; k < q.size(); ++k)
      load[k] += 0.5 * (force[k] - drag[k] - last_force[k]);
    if (theta_ > 0.0) {
      const std::vector<double> spring = dynamics.spring(record.start, last);
      for (std::size_t k = 0; k < q.size(); ++k) load[k] += stiffness_time * spring[k];
    }
  }
  dynamics.solve(record.start, load, {inertia, stiffness_time, stiffness_time}, q);

  const std::vector<double> drag = dynamics.friction(record.start, q);
  this->finish(dynamics, clock, q,
               dynamics.has_mass() ? motion.times_inertia(record.start, q, 1.0) : q);
  std::vector<double> rest = force;
  for (std::size_t k = 0; k < q.size(); ++k) rest[k] -= drag[k];
  last_force_.keep(dynamics, rest);
  motion.cross_faces(q);
  last_velocity_.keep(dynamics, q);
  return record;
}

template <int D>
void Extrapolated<D>::prepare(Dynamics<D>& dynamics) {
  for (auto* kept : {&last_velocity_, &last_force_}) kept->prepare(dynamics);
}

template <int D>
void Extrapolated<D>::save(StateWriter& out) const {
  for (const auto* kept : {&last_velocity_, &last_force_}) kept->save(out);
}

template <int D>
void Extrapolated<D>::load(const StateReader& in) {
  for (auto* kept : {&last_velocity_, &last_force_}) kept->load(in);
}

template class Extrapolated<2>;
template class Extrapolated<3>;

}  // namespace odpd
