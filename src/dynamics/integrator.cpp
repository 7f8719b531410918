#include "odpd/dynamics/integrator.h"

#include <fmt/format.h>

#include <algorithm>

#include "odpd/core/error.h"
#include "odpd/core/index.h"

namespace odpd {

template <int D>
void Integrator<D>::begin(Dynamics<D>& dynamics, const Clock& clock) {
  record_.step = clock.step;
  record_.dt = clock.dt;
  record_.alarm_crossings = 0;
  dynamics.reorder_if_due(clock.step);
  dynamics.evaluate(dynamics.particles().position, clock.time(), record_.start);
  record_.v_start = dynamics.particles().end_velocity;
  record_.w_start = dynamics.particles().end_spin;
}

template <int D>
void Integrator<D>::finish(Dynamics<D>& dynamics, const Clock& clock, const Unknowns& q_mid,
                           const Unknowns& p_mid) {
  Motion<D>& motion = dynamics.motion();
  move(dynamics, clock, q_mid);
  if (!dynamics.has_mass()) return;
  // What goes on is momentum, linear and angular: in 3D moments of inertia turn with the body.
  Unknowns p = motion.times_inertia(record_.start, motion.end_velocity(record_.start), 1.0);
  for (std::size_t k = 0; k < p.size(); ++k) p[k] = 2.0 * p_mid[k] - p[k];
  motion.set_end_momentum(p);
}

template <int D>
void Integrator<D>::move(Dynamics<D>& dynamics, const Clock& clock, const Unknowns& q_mid) {
  Motion<D>& motion = dynamics.motion();
  record_.v_mid = motion.velocities(record_.start, q_mid);
  record_.w_mid = motion.spins(record_.start, q_mid);
  record_.alarm_crossings += motion.move(record_.v_mid, clock.dt, clock.time());
  dynamics.particles().spin = record_.w_mid;
}

template <int D>
std::string CarriedUnknowns<D>::spin_name() const {
  return name_ + "_spin";
}

template <int D>
void CarriedUnknowns<D>::prepare(Dynamics<D>& dynamics) {
  dynamics.particles().carry(name_);
  if (dynamics.dofs().any_spin()) dynamics.particles().carry(spin_name());
  prepared_ = true;
}

template <int D>
void CarriedUnknowns<D>::keep(Dynamics<D>& dynamics, const std::vector<double>& all) {
  const DofMap<D>& dofs = dynamics.dofs();
  const std::span<const double> q = dofs.velocities(std::span(all));
  const auto spinning = dofs.spin_particles();
  if (!spinning.empty()) {
    std::vector<Vec<D>>& spins = dynamics.particles().carry(spin_name());
    for (std::size_t s = 0; s < spinning.size(); ++s)
      for (std::size_t c = 0; c < D; ++c) spins[index(spinning[s])].x[c] = all[s * D + c];
  }
  std::vector<Vec<D>>& column = dynamics.particles().carry(name_);
  const auto free = dofs.free_particles();
  for (std::size_t k = 0; k < free.size(); ++k)
    for (std::size_t c = 0; c < D; ++c) column[index(free[k])].x[c] = q[dofs.free_node(k) * D + c];
  const auto of_bodies = static_cast<std::ptrdiff_t>(dofs.bodies() * D);
  bodies_.assign(q.begin(), q.begin() + of_bodies);
  bodies_.insert(bodies_.end(), q.end() - of_bodies, q.end());
  empty_ = false;
}

template <int D>
std::vector<double> CarriedUnknowns<D>::unknowns(Dynamics<D>& dynamics) const {
  const DofMap<D>& dofs = dynamics.dofs();
  if (std::ssize(bodies_) != 2 * dofs.bodies() * D)
    throw IoError(
        "the checkpoint's integrator arrays do not fit the bodies: it is damaged or of another "
        "case");
  const std::vector<Vec<D>>& column = dynamics.particles().carry(name_);
  std::vector<double> all(index(dofs.unknowns()));
  const auto spinning = dofs.spin_particles();
  if (!spinning.empty()) {
    const std::vector<Vec<D>>& spins = dynamics.particles().carry(spin_name());
    for (std::size_t s = 0; s < spinning.size(); ++s)
      for (std::size_t c = 0; c < D; ++c) all[s * D + c] = spins[index(spinning[s])].x[c];
  }
  const std::span<double> q = dofs.velocities(std::span(all));
  const auto free = dofs.free_particles();
  for (std::size_t k = 0; k < free.size(); ++k)
    for (std::size_t c = 0; c < D; ++c) q[dofs.free_node(k) * D + c] = column[index(free[k])].x[c];
  const auto middle = bodies_.begin() + dofs.bodies() * D;
  std::copy(bodies_.begin(), middle, q.begin());
  std::copy(middle, bodies_.end(), q.end() - dofs.bodies() * D);
  return all;
}

template <int D>
void CarriedUnknowns<D>::save(StateWriter& out) const {
  out.write(name_ + "_kept", std::vector<std::int64_t>{empty_ ? 0 : 1});
  out.write(name_ + "_bodies", bodies_);
}

template <int D>
void CarriedUnknowns<D>::load(const StateReader& in) {
  empty_ = in.read_integers(name_ + "_kept").at(0) == 0;
  if (!empty_ && !prepared_)
    throw IoError(fmt::format(
        "the checkpoint has '{}' of the integrator, which prepares nothing to take it: call "
        "CarriedUnknowns::prepare in Integrator::prepare",
        name_));
  bodies_ = in.read_doubles(name_ + "_bodies");
}

template class Integrator<2>;
template class Integrator<3>;
template class CarriedUnknowns<2>;
template class CarriedUnknowns<3>;

}  // namespace odpd
