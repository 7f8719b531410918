#include "odpd/operator/dof_map.h"

#include <algorithm>

#include "odpd/core/error.h"
#include "odpd/core/index.h"

namespace odpd {

namespace {

template <int D>
std::span<const double> flat(std::span<const Vec<D>> v) {
  return {v.empty() ? nullptr : v.front().x.data(), v.size() * D};
}

}  // namespace

template <int D>
DofMap<D>::DofMap(const Particles<D>& particles, double mass)
    : constituents_(particles), owned_(particles.owned()) {
  const auto n = index(particles.size());
  for (const RigidBody<D>& body : particles.bodies) unknown_ += body.known ? 0 : 1;
  std::vector<char> without(n);
  for (std::size_t i = 0; i < n; ++i) without[i] = particles.is_free(i) ? 0 : 1;
  free_ = NodeMap(without, block_size());
  any_spin_ = !particles.spin_of_species.empty();
  if (any_spin_) {
    for (std::size_t i = 0; i < n; ++i) without[i] = particles.spins(i) ? 0 : 1;
    spins_ = NodeMap(without, block_size());
    for (const std::int32_t p : spins_.node_particles()) {
      const Spin& spin = particles.spin_of_species[index(particles.species[index(p)])];
      moment_.push_back(mass > 0.0 ? spin.moment / mass : 0.0);
    }
  }
  if (unknown_ == 0) return;
  for (std::size_t i = 0; i < n; ++i) without[i] = particles.is_known(i) ? 1 : 0;
  mobile_ = NodeMap(without, block_size());
}

template <int D>
RigidMotion<D> DofMap<D>::motion_of(std::size_t b, std::span<const double> all) const {
  const std::span<const double> q = velocities(all);
  RigidMotion<D> motion;
  for (std::size_t c = 0; c < D; ++c) {
    motion.velocity.x[c] = q[body_node(b) * D + c];
    motion.angular.x[c] = q[b * D + c];
  }
  return motion;
}

template <int D>
void DofMap<D>::set(std::size_t b, const Vec<D>& linear, const Vec<D>& angular,
                    std::span<double> all) const {
  const std::span<double> q = velocities(all);
  for (std::size_t c = 0; c < D; ++c) {
    q[body_node(b) * D + c] = linear.x[c];
    q[b * D + c] = angular.x[c];
  }
}

template <int D>
Share DofMap<D>::share() const {
  if (!any_spin_) return node_share();
  if (owned_.ranks->size() > 1)
    throw SolverError(
        "particles that spin (lever_radius) run on one rank so far: run the case on one");
  return {owned_.ranks, 0, spins() + nodes()};
}

template <int D>
Share DofMap<D>::node_share() const {
  Share nodes_of_rank = run_of(free_particles());
  nodes_of_rank.first += bodies();
  nodes_of_rank.last += bodies();
  if (owned_.ranks->rank() == 0) nodes_of_rank.first = 0;
  if (owned_.ranks->rank() + 1 == owned_.ranks->size()) nodes_of_rank.last = nodes();
  return nodes_of_rank;
}

template <int D>
Share DofMap<D>::run_of(std::span<const std::int32_t> particles) const {
  const auto place = [&](std::int64_t particle) {
    return std::lower_bound(particles.begin(), particles.end(), particle) - particles.begin();
  };
  return {owned_.ranks, place(owned_.first), place(owned_.last)};
}

template <int D>
void DofMap<D>::gather(std::span<const Vec<D>> arms, std::span<const Vec<D>> forces,
                       std::vector<double>& q) const {
  gather(arms, forces, {}, q);
}

template <int D>
void DofMap<D>::gather(std::span<const Vec<D>> arms, std::span<const Vec<D>> forces,
                       std::span<const Vec<D>> torques, std::vector<double>& q) const {
  q.resize(index(unknowns()));
  if (torques.empty()) {
    std::fill_n(q.begin(), spins() * D, 0.0);
  } else {
    spins_.gather(flat(torques), q);
  }
  const std::span<double> of_nodes = velocities(std::span(q));
  free_.gather(flat(forces), of_nodes.subspan(free_node(0) * D));
  if (unknown_ == 0) return;
  for_each_body<D>(unknown_, [&](std::size_t b, auto&) {
    Vec<D> force{}, moment{};
    for (const std::int32_t particle : constituents(b)) {
      const auto p = index(particle);
      if (!owned_.owns(p)) continue;
      force += forces[p];
      moment += torque(arms[p], forces[p]);
      if (!torques.empty()) moment += torques[p];
    }
    set(b, force, moment, q);
  });
  owned_.ranks->sum(of_nodes.first(unknown_ * D));
  owned_.ranks->sum(of_nodes.last(unknown_ * D));
}

template <int D>
void DofMap<D>::scatter(std::span<const Vec<D>> arms, std::span<const double> q,
                        std::span<const Vec<D>> known, std::vector<Vec<D>>& velocity) const {
  velocity.assign(known.begin(), known.end());
  if (!velocity.empty())
    free_.scatter(velocities(q).subspan(free_node(0) * D),
                  {velocity.front().x.data(), velocity.size() * D});
  for_each_body<D>(unknown_, [&](std::size_t b, auto&) {
    const RigidMotion<D> motion = motion_of(b, q);
    for (const std::int32_t particle : constituents(b)) {
      const auto p = index(particle);
      velocity[p] = motion.velocity + swing(motion.angular, arms[p]);
    }
  });
}

template <int D>
void DofMap<D>::scatter_spins(std::span<const double> q, std::span<const Vec<D>> known,
                              std::vector<Vec<D>>& spin) const {
  spin.clear();
  if (!any_spin_) return;
  spin.assign(known.begin(), known.end());
  if (spins() > 0) spins_.scatter(q, {spin.front().x.data(), spin.size() * D});
  for_each_body<D>(unknown_, [&](std::size_t b, auto&) {
    const Vec<D> angular = motion_of(b, q).angular;
    for (const std::int32_t particle : constituents(b)) spin[index(particle)] = angular;
  });
}

template <int D>
void DofMap<D>::times_inertia(std::span<const Vec<D>> arms, std::vector<double>& q) const {
  for (std::size_t s = 0; s < moment_.size(); ++s)
    for (std::size_t c = 0; c < D; ++c) q[s * D + c] *= moment_[s];
  for_each_body<D>(unknown_, [&](std::size_t b, auto&) {
    const RigidMotion<D> motion = motion_of(b, q);
    Vec<D> linear{}, angular{};
    for (const std::int32_t particle : constituents(b)) {
      const Vec<D>& arm = arms[index(particle)];
      const Vec<D> v = motion.velocity + swing(motion.angular, arm);
      linear += v;
      angular += torque(arm, v);
    }
    set(b, linear, angular, q);
  });
}

template <int D>
void DofMap<D>::divide_by_inertia(std::span<const Vec<D>> arms, std::vector<double>& l) const {
  for (std::size_t s = 0; s < moment_.size(); ++s)
    for (std::size_t c = 0; c < D; ++c)
      l[s * D + c] = moment_[s] > 0.0 ? l[s * D + c] / moment_[s] : 0.0;
  for_each_body<D>(unknown_, [&](std::size_t b, BodyScratch<D>& scratch) {
    scratch.arms.clear();
    for (const std::int32_t particle : constituents(b))
      scratch.arms.push_back(arms[index(particle)]);
    const RigidMotion<D> momentum = motion_of(b, l);
    Vec<D> v = momentum.velocity;
    for (double& component : v.x) component /= static_cast<double>(scratch.arms.size());
    set(b, v, angular_velocity<D>(scratch.arms, momentum.angular), l);
  });
}

template class DofMap<2>;
template class DofMap<3>;

}  // namespace odpd
