#include "odpd/pairs/noise.h"

#include <algorithm>

#include "odpd/core/parallel.h"
#include "odpd/core/random.h"

namespace odpd {

template <int D>
void draw_edge_noise(const PairNetwork<D>& network, const Particles<D>& particles,
                     std::uint64_t seed, std::uint64_t step, double dt,
                     std::vector<Vec<D>>& force) {
  const CounterRandom random(seed, Stream::pair_noise);
  force.resize(static_cast<std::size_t>(network.size()));
  parallel_for(network.size(), [&](std::int64_t edge) {
    const auto k = static_cast<std::size_t>(edge);
    const std::int64_t id_i = particles.id[static_cast<std::size_t>(network.i[k])];
    const std::int64_t id_j = particles.id[static_cast<std::size_t>(network.j[k])];
    const auto low = static_cast<std::uint64_t>(std::min(id_i, id_j));
    const auto high = static_cast<std::uint64_t>(std::max(id_i, id_j));
    const Vec<D>& e = network.e[k];
    const double strength = 2.0 * network.kT[k] / dt;
    force[k] = std::sqrt(strength * network.zeta_par[k]) * random.normal(step, 0, low, high) * e;
    if (network.zeta_perp[k] == 0.0) return;
    // The vector part changes sign with the order of i and j, as e does: the force is a function of the pair.
    const double across = (id_i < id_j ? 1.0 : -1.0) * std::sqrt(strength * network.zeta_perp[k]);
    const auto w = random.normals(step, 1, low, high);
    Vec<D> n;
    for (int c = 0; c < D; ++c) n[c] = w[static_cast<std::size_t>(c)];
    force[k] += across * (n - dot(n, e) * e);
  });
}

template void draw_edge_noise<2>(const PairNetwork<2>&, const Particles<2>&, std::uint64_t,
                                 std::uint64_t, double, std::vector<Vec<2>>&);
template void draw_edge_noise<3>(const PairNetwork<3>&, const Particles<3>&, std::uint64_t,
                                 std::uint64_t, double, std::vector<Vec<3>>&);

}  // namespace odpd
