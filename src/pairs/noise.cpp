#include "odpd/pairs/noise.h"

#include <algorithm>

#include "odpd/core/parallel.h"
#include "odpd/core/random.h"

namespace odpd {

template <int D>
EdgeNormals<D>::EdgeNormals(const CounterRandom& random, const PairNetwork<D>& network,
                            const Particles<D>& particles, std::size_t k, std::uint64_t step)
    : random_(random), e_(network.e[k]), step_(step) {
  const std::int64_t id_i = particles.id[static_cast<std::size_t>(network.i[k])];
  const std::int64_t id_j = particles.id[static_cast<std::size_t>(network.j[k])];
  low_ = static_cast<std::uint64_t>(std::min(id_i, id_j));
  high_ = static_cast<std::uint64_t>(std::max(id_i, id_j));
  // A vector changes sign with the order of i and j, as e does: the force is a function of the pair.
  sign_ = id_i < id_j ? 1.0 : -1.0;
}

template <int D>
Vec<D> EdgeNormals<D>::across() const {
  const auto w = random_.normals(step_, 1, low_, high_);
  Vec<D> n;
  for (int c = 0; c < D; ++c) n[c] = sign_ * w[static_cast<std::size_t>(c)];
  return n - dot(n, e_) * e_;
}

template <int D>
void draw_edge_noise(const PairNetwork<D>& network, const Particles<D>& particles,
                     std::uint64_t seed, std::uint64_t step, double dt,
                     std::vector<Vec<D>>& force) {
  const CounterRandom random(seed, Stream::pair_noise);
  force.resize(static_cast<std::size_t>(network.size()));
  parallel_for(network.size(), [&](std::int64_t edge) {
    const auto k = static_cast<std::size_t>(edge);
    const EdgeNormals<D> w(random, network, particles, k, step);
    const double strength = 2.0 * network.kT[k] / dt;
    force[k] = std::sqrt(strength * network.zeta_par[k]) * w.along() * network.e[k];
    if (network.zeta_perp[k] != 0.0)
      force[k] += std::sqrt(strength * network.zeta_perp[k]) * w.across();
  });
}

template <int D>
void add_drag_noise(const Particles<D>& particles, std::uint64_t seed, std::uint64_t step,
                    double amplitude, std::vector<Vec<D>>& force) {
  const CounterRandom random(seed, Stream::drag_noise);
  parallel_for(particles.size(), [&](std::int64_t particle) {
    const auto i = static_cast<std::size_t>(particle);
    if (!particles.is_free(i)) return;
    const auto n = random.normals(step, 0, static_cast<std::uint64_t>(particles.id[i]), 0);
    for (std::size_t c = 0; c < D; ++c) force[i].x[c] += amplitude * n[c];
  });
}

template class EdgeNormals<2>;
template class EdgeNormals<3>;
template void add_drag_noise<2>(const Particles<2>&, std::uint64_t, std::uint64_t, double,
                                std::vector<Vec<2>>&);
template void add_drag_noise<3>(const Particles<3>&, std::uint64_t, std::uint64_t, double,
                                std::vector<Vec<3>>&);
template void draw_edge_noise<2>(const PairNetwork<2>&, const Particles<2>&, std::uint64_t,
                                 std::uint64_t, double, std::vector<Vec<2>>&);
template void draw_edge_noise<3>(const PairNetwork<3>&, const Particles<3>&, std::uint64_t,
                                 std::uint64_t, double, std::vector<Vec<3>>&);

}  // namespace odpd
