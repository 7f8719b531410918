#include "odpd/operator/edge_sums.h"

#include <algorithm>

#include "odpd/core/parallel.h"

namespace odpd {

namespace {

// add(p, edge, sign): sign +1 where p is the edge's i.
template <int D, class Add>
void for_each_incidence(const PairNetwork<D>& network, const Add& add) {
  parallel_for(network.particles, [&](std::int64_t particle) {
    const auto p = static_cast<std::size_t>(particle);
    for (const std::int32_t edge : network.edges_of(particle)) {
      const auto k = static_cast<std::size_t>(edge);
      add(p, k, network.i[k] == particle ? 1.0 : -1.0);
    }
  });
}

}  // namespace

template <int D>
void add_edge_forces(const PairNetwork<D>& network, std::span<const Vec<D>> edge_force,
                     std::vector<Vec<D>>& force) {
  for_each_incidence(network, [&](std::size_t p, std::size_t k, double sign) {
    force[p] += sign * edge_force[k];
  });
}

template <int D>
void add_conservative_forces(const PairNetwork<D>& network, std::vector<Vec<D>>& force) {
  for_each_incidence(network, [&](std::size_t p, std::size_t k, double sign) {
    force[p] += sign * network.f_c[k] * network.e[k];
  });
}

template <int D>
void add_friction_forces(const PairNetwork<D>& network, std::span<const Vec<D>> velocity,
                         std::vector<Vec<D>>& force) {
  for_each_incidence(network, [&](std::size_t p, std::size_t k, double sign) {
    const Vec<D> slip = velocity[static_cast<std::size_t>(network.i[k])] -
                        velocity[static_cast<std::size_t>(network.j[k])];
    const double along = dot(slip, network.e[k]);
    Vec<D> drag = (network.zeta_par[k] - network.zeta_perp[k]) * along * network.e[k];
    drag += network.zeta_perp[k] * slip;
    force[p] -= sign * drag;
  });
}

template <int D>
void add_spring_forces(const PairNetwork<D>& network, std::span<const Vec<D>> velocity,
                       std::vector<Vec<D>>& force) {
  for_each_incidence(network, [&](std::size_t p, std::size_t k, double sign) {
    const Vec<D> slip = velocity[static_cast<std::size_t>(network.i[k])] -
                        velocity[static_cast<std::size_t>(network.j[k])];
    force[p] -= sign * std::max(network.k_c[k], 0.0) * dot(slip, network.e[k]) * network.e[k];
  });
}

template <int D>
void add_friction_blocks(const PairNetwork<D>& network,
                         std::vector<std::array<double, static_cast<std::size_t>(D* D)>>& blocks) {
  for_each_incidence(network, [&](std::size_t p, std::size_t k, double) {
    const double along = network.zeta_par[k] - network.zeta_perp[k];
    for (std::size_t row = 0; row < D; ++row)
      for (std::size_t col = 0; col < D; ++col)
        blocks[p][row * D + col] += along * network.e[k].x[row] * network.e[k].x[col] +
                                    (row == col ? network.zeta_perp[k] : 0.0);
  });
}

template <int D>
void add_laplacian(const PairNetwork<D>& network, std::vector<double>& laplacian) {
  for_each_incidence(network, [&](std::size_t p, std::size_t k, double) {
    // At r = 0 the Laplacian of a pair that repels is infinite. Such an edge is left out: coincident
    // particles have measure zero, and one must not make an average infinite for good.
    if (network.f_c[k] != 0.0 && network.r[k] > 0.0)
      laplacian[p] += network.k_c[k] - (D - 1) * network.f_c[k] / network.r[k];
  });
}

#define ODPD_INSTANTIATE(D)                                                                      \
  template void add_edge_forces<D>(const PairNetwork<D>&, std::span<const Vec<D>>,               \
                                   std::vector<Vec<D>>&);                                        \
  template void add_conservative_forces<D>(const PairNetwork<D>&, std::vector<Vec<D>>&);         \
  template void add_friction_forces<D>(const PairNetwork<D>&, std::span<const Vec<D>>,           \
                                       std::vector<Vec<D>>&);                                    \
  template void add_spring_forces<D>(const PairNetwork<D>&, std::span<const Vec<D>>,             \
                                     std::vector<Vec<D>>&);                                      \
  template void add_friction_blocks<D>(                                                          \
      const PairNetwork<D>&, std::vector<std::array<double, static_cast<std::size_t>(D * D)>>&); \
  template void add_laplacian<D>(const PairNetwork<D>&, std::vector<double>&);
ODPD_INSTANTIATE(2)
ODPD_INSTANTIATE(3)
#undef ODPD_INSTANTIATE

}  // namespace odpd
