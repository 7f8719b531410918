#include "odpd/operator/dof_map.h"

#include "odpd/core/parallel.h"

namespace odpd {

template <int D>
DofMap<D>::DofMap(const Particles<D>& particles) {
  const auto n = static_cast<std::size_t>(particles.size());
  std::vector<std::int32_t> index;
  for (const RigidBody<D>& body : particles.bodies) {
    unknown_ += body.known ? 0 : 1;
    if (index.empty()) index = particles.index_of_id();
    body_.emplace_back();
    for (const std::int64_t id : body.members)
      body_.back().push_back(index[static_cast<std::size_t>(id)]);
  }
  site_.assign(n, -1);
  std::int32_t sites = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (particles.is_known(i)) continue;
    site_[i] = sites++;
    if (particles.is_free(i)) free_.push_back(static_cast<std::int32_t>(i));
    if (unknown_ > 0) moves_.push_back(static_cast<std::int32_t>(i));
  }
}

template <int D>
void DofMap<D>::gather(std::span<const Vec<D>> arms, std::span<const Vec<D>> forces,
                       std::vector<double>& q) const {
  q.resize(static_cast<std::size_t>(unknowns()));
  parallel_for(static_cast<std::int64_t>(free_.size()), [&](std::int64_t node) {
    const auto n = static_cast<std::size_t>(node);
    for (std::size_t c = 0; c < D; ++c)
      q[free_node(n) * D + c] = forces[static_cast<std::size_t>(free_[n])].x[c];
  });
  for (std::size_t b = 0; b < unknown_; ++b) {
    Vec<D> force{}, moment{};
    for (const std::int32_t particle : body_[b]) {
      const auto p = static_cast<std::size_t>(particle);
      force += forces[p];
      moment += torque(arms[p], forces[p]);
    }
    for (std::size_t c = 0; c < D; ++c) {
      q[body_node(b) * D + c] = force.x[c];
      q[b * D + c] = moment.x[c];
    }
  }
}

template <int D>
void DofMap<D>::scatter(std::span<const Vec<D>> arms, std::span<const double> q,
                        std::span<const Vec<D>> known, std::vector<Vec<D>>& velocity) const {
  velocity.assign(known.begin(), known.end());
  parallel_for(static_cast<std::int64_t>(free_.size()), [&](std::int64_t node) {
    const auto n = static_cast<std::size_t>(node);
    for (std::size_t c = 0; c < D; ++c)
      velocity[static_cast<std::size_t>(free_[n])].x[c] = q[free_node(n) * D + c];
  });
  for (std::size_t b = 0; b < unknown_; ++b) {
    Vec<D> v, w;
    for (std::size_t c = 0; c < D; ++c) {
      v.x[c] = q[body_node(b) * D + c];
      w.x[c] = q[b * D + c];
    }
    for (const std::int32_t particle : body_[b]) {
      const auto p = static_cast<std::size_t>(particle);
      velocity[p] = v + swing(w, arms[p]);
    }
  }
}

template <int D>
void DofMap<D>::divide_by_inertia(std::span<const Vec<D>> arms, std::vector<double>& l) const {
  std::vector<Vec<D>> own;
  for (std::size_t b = 0; b < unknown_; ++b) {
    own.clear();
    for (const std::int32_t particle : body_[b])
      own.push_back(arms[static_cast<std::size_t>(particle)]);
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
