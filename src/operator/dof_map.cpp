#include "odpd/operator/dof_map.h"

#include <algorithm>

#include "odpd/core/index.h"

namespace odpd {

namespace {

template <int D>
std::span<const double> flat(std::span<const Vec<D>> v) {
  return {v.empty() ? nullptr : v.front().x.data(), v.size() * D};
}

}  // namespace

template <int D>
DofMap<D>::DofMap(const Particles<D>& particles) : owned_(particles.owned()) {
  const auto n = index(particles.size());
  std::vector<std::int32_t> index_of;
  for (const RigidBody<D>& body : particles.bodies) {
    unknown_ += body.known ? 0 : 1;
    if (index_of.empty()) index_of = particles.index_of_id();
    body_.emplace_back();
    for (const std::int64_t id : body.members) body_.back().push_back(index_of[index(id)]);
  }
  std::vector<char> without(n);
  for (std::size_t i = 0; i < n; ++i) without[i] = particles.is_free(i) ? 0 : 1;
  free_ = NodeMap(without, block_size());
  if (unknown_ == 0) return;
  for (std::size_t i = 0; i < n; ++i) without[i] = particles.is_known(i) ? 1 : 0;
  mobile_ = NodeMap(without, block_size());
}

template <int D>
Share DofMap<D>::share() const {
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
  q.resize(index(unknowns()));
  free_.gather(flat(forces), std::span(q).subspan(free_node(0) * D));
  for (std::size_t b = 0; b < unknown_; ++b) {
    Vec<D> force{}, moment{};
    for (const std::int32_t particle : body_[b]) {
      const auto p = index(particle);
      if (!owned_.owns(p)) continue;
      force += forces[p];
      moment += torque(arms[p], forces[p]);
    }
    for (std::size_t c = 0; c < D; ++c) {
      q[body_node(b) * D + c] = force.x[c];
      q[b * D + c] = moment.x[c];
    }
  }
  if (unknown_ == 0) return;
  owned_.ranks->sum(std::span(q).first(unknown_ * D));
  owned_.ranks->sum(std::span(q).last(unknown_ * D));
}

template <int D>
void DofMap<D>::scatter(std::span<const Vec<D>> arms, std::span<const double> q,
                        std::span<const Vec<D>> known, std::vector<Vec<D>>& velocity) const {
  velocity.assign(known.begin(), known.end());
  if (!velocity.empty())
    free_.scatter(q.subspan(free_node(0) * D), {velocity.front().x.data(), velocity.size() * D});
  for (std::size_t b = 0; b < unknown_; ++b) {
    Vec<D> v, w;
    for (std::size_t c = 0; c < D; ++c) {
      v.x[c] = q[body_node(b) * D + c];
      w.x[c] = q[b * D + c];
    }
    for (const std::int32_t particle : body_[b]) {
      const auto p = index(particle);
      velocity[p] = v + swing(w, arms[p]);
    }
  }
}

template <int D>
void DofMap<D>::divide_by_inertia(std::span<const Vec<D>> arms, std::vector<double>& l) const {
  std::vector<Vec<D>> own;
  for (std::size_t b = 0; b < unknown_; ++b) {
    own.clear();
    for (const std::int32_t particle : body_[b]) own.push_back(arms[index(particle)]);
    double* const linear = &l[body_node(b) * D];
    double* const angular = &l[b * D];
    Vec<D> moment;
    for (std::size_t c = 0; c < D; ++c) {
      linear[c] /= static_cast<double>(own.size());
      moment.x[c] = angular[c];
    }
    const Vec<D> w = angular_velocity<D>(own, moment);
    for (std::size_t c = 0; c < D; ++c) angular[c] = w.x[c];
  }
}

template class DofMap<2>;
template class DofMap<3>;

}  // namespace odpd
