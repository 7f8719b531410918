#include "odpd/operator/dof_map.h"

#include "odpd/core/parallel.h"

namespace odpd {

template <int D>
DofMap<D>::DofMap(const Particles<D>& particles) {
  const auto n = static_cast<std::size_t>(particles.size());
  node_.assign(n, -1);
  for (std::size_t i = 0; i < n; ++i) {
    if (!particles.is_free(i)) continue;
    node_[i] = static_cast<std::int32_t>(particle_.size());
    particle_.push_back(static_cast<std::int32_t>(i));
  }
}

template <int D>
void DofMap<D>::gather(std::span<const Vec<D>> particle_values, std::vector<double>& q) const {
  q.resize(static_cast<std::size_t>(unknowns()));
  parallel_for(nodes(), [&](std::int64_t node) {
    const auto n = static_cast<std::size_t>(node);
    for (std::size_t c = 0; c < D; ++c)
      q[n * D + c] = particle_values[static_cast<std::size_t>(particle_[n])].x[c];
  });
}

template <int D>
void DofMap<D>::scatter(std::span<const double> q, std::span<const Vec<D>> known,
                        std::vector<Vec<D>>& velocity) const {
  velocity.resize(known.size());
  parallel_for(particles(), [&](std::int64_t particle) {
    const auto p = static_cast<std::size_t>(particle);
    const auto node = static_cast<std::size_t>(node_[p]);
    for (std::size_t c = 0; c < D; ++c)
      velocity[p].x[c] = node_[p] >= 0 ? q[node * D + c] : known[p].x[c];
  });
}

template class DofMap<2>;
template class DofMap<3>;

}  // namespace odpd
