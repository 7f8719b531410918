#include "odpd/dynamics/integrator.h"

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
}

template <int D>
void Integrator<D>::finish(Dynamics<D>& dynamics, const Clock& clock, const Unknowns& q_mid,
                           const Unknowns& p_mid) {
  Motion<D>& motion = dynamics.motion();
  record_.v_mid = motion.velocities(record_.start, q_mid);
  record_.alarm_crossings += motion.move(record_.v_mid, clock.dt, clock.time());
  if (!dynamics.has_mass()) return;
  // What goes on is momentum, linear and angular: in 3D moments of inertia turn with the body.
  Unknowns p = motion.times_inertia(record_.start, motion.end_velocity(record_.start), 1.0);
  for (std::size_t k = 0; k < p.size(); ++k) p[k] = 2.0 * p_mid[k] - p[k];
  motion.set_end_momentum(p);
}

namespace {

// For each node where its values stand by identity: the particles', then w and V of the bodies.
template <int D>
std::vector<std::size_t> places(Dynamics<D>& dynamics) {
  const DofMap<D>& dofs = dynamics.dofs();
  std::vector<std::size_t> place(index(dofs.nodes()));
  const auto free = dofs.free_particles();
  for (std::size_t k = 0; k < free.size(); ++k)
    place[dofs.free_node(k)] = index(dynamics.particles().id[index(free[k])]);
  auto next = index(dofs.particles());
  for (std::size_t b = 0; b < index(dofs.bodies()); ++b) {
    place[b] = next++;
    place[dofs.body_node(b)] = next++;
  }
  return place;
}

}  // namespace

template <int D>
std::vector<double> by_identity(Dynamics<D>& dynamics, const std::vector<double>& q) {
  const std::vector<std::size_t> place = places(dynamics);
  const auto entries = dynamics.dofs().particles() + 2 * dynamics.dofs().bodies();
  const auto block = index(dynamics.dofs().block_size());
  std::vector<double> values(index(entries) * block, 0.0);
  for (std::size_t n = 0; n < place.size(); ++n)
    for (std::size_t c = 0; c < block; ++c) values[place[n] * block + c] = q[n * block + c];
  return values;
}

template <int D>
std::vector<double> from_identity(Dynamics<D>& dynamics, const std::vector<double>& values) {
  const auto entries = dynamics.dofs().particles() + 2 * dynamics.dofs().bodies();
  const auto block = index(dynamics.dofs().block_size());
  if (values.size() != index(entries) * block)
    throw IoError(
        "the checkpoint's integrator arrays do not fit the particles: it is damaged or of another "
        "case");
  const std::vector<std::size_t> place = places(dynamics);
  std::vector<double> q(place.size() * block);
  for (std::size_t n = 0; n < place.size(); ++n)
    for (std::size_t c = 0; c < block; ++c) q[n * block + c] = values[place[n] * block + c];
  return q;
}

#define ODPD_INSTANTIATE(D)                                                              \
  template class Integrator<D>;                                                          \
  template std::vector<double> by_identity<D>(Dynamics<D>&, const std::vector<double>&); \
  template std::vector<double> from_identity<D>(Dynamics<D>&, const std::vector<double>&);
ODPD_INSTANTIATE(2)
ODPD_INSTANTIATE(3)
#undef ODPD_INSTANTIATE

}  // namespace odpd
