#include "odpd/operator/edge_sums.h"

#include <algorithm>

#include "odpd/core/index.h"
#include "odpd/core/parallel.h"
#include "odpd/pairs/edge_loop.h"

namespace odpd {

namespace {

// The part of the bonds, which are few.
template <int D, class Value, class Sum>
void add_bonds(const PairNetwork<D>& network, bool opposite, const Value& value,
               std::vector<Sum>& sum) {
  for (auto k = index(network.pairs()); k < network.i.size(); ++k) {
    const Sum v = value(k);
    sum[index(network.i[k])] += v;
    Sum& other = sum[index(network.j[k])];
    if (opposite) {
      other -= v;
    } else {
      other += v;
    }
  }
}

// sum[p] += value(k) for the edges k of p that have it as i; those that have it as j add it, or subtract it if `opposite`.
template <int D, class Value, class Sum>
void add_edges(const PairNetwork<D>& network, bool opposite, const Value& value,
               std::vector<Sum>& sum) {
  if (network.first.empty()) {
    parallel_for(network.particles, [&](std::int64_t particle) {
      Sum& s = sum[index(particle)];
      for (const std::int32_t edge : network.edges_of(particle)) {
        const auto k = index(edge);
        if (opposite && network.i[k] != particle) {
          s -= value(k);
        } else {
          s += value(k);
        }
      }
    });
    return;
  }
  for_each_owned_edge(
      network,
      [&](std::size_t p, std::size_t k) {
        if (opposite) {
          sum[p] -= value(k);
        } else {
          sum[p] += value(k);
        }
      },
      [&](std::size_t p, std::size_t begin, std::size_t end) {
        Sum s = sum[p];
        for (std::size_t k = begin; k < end; ++k) s += value(k);
        sum[p] = s;
      });
  add_bonds(network, opposite, value, sum);
}

// torque[p] -= l_p e x value(k), value: force on i.
template <int D, class Value>
void add_torques(const PairNetwork<D>& network, const Value& value, std::vector<Vec<D>>& sum) {
  if (network.lever_i.empty()) return;
  parallel_for(network.particles, [&](std::int64_t particle) {
    for (const std::int32_t edge : network.edges_of(particle)) {
      const auto k = index(edge);
      const double arm = network.i[k] == particle ? network.lever_i[k] : network.lever_j[k];
      if (arm > 0.0) sum[index(particle)] -= arm * torque(network.e[k], value(k));
    }
  });
}

// Force on i of the stiffness of edge k.
template <int D>
Vec<D> spring_of(const PairNetwork<D>& network, std::size_t k, std::span<const Vec<D>> velocity) {
  return -std::max(network.k_c[k], 0.0) * dot(network.slip(k, velocity), network.e[k]) *
         network.e[k];
}

}  // namespace

template <int D>
void add_edge_forces(const PairNetwork<D>& network, std::span<const Vec<D>> edge_force,
                     std::vector<Vec<D>>& force) {
  add_edges(
      network, true, [&](std::size_t k) { return edge_force[k]; }, force);
}

template <int D>
void add_conservative_forces(const PairNetwork<D>& network, std::vector<Vec<D>>& force) {
  add_edges(
      network, true, [&](std::size_t k) { return network.f_c[k] * network.e[k]; }, force);
  if (network.beyond.empty()) return;
  const auto first_bond = index(network.pairs());
  add_bonds(
      network, true, [&](std::size_t k) { return network.beyond[k - first_bond].force; }, force);
}

template <int D>
void add_friction_forces(const PairNetwork<D>& network, std::span<const Vec<D>> velocity,
                         std::vector<Vec<D>>& force, std::span<const Vec<D>> spin) {
  if (spin.empty()) {
    add_edges(
        network, true,
        [&](std::size_t k) { return friction_of(network, k, network.inner_slip(k, velocity)); },
        force);
    return;
  }
  add_edges(
      network, true,
      [&](std::size_t k) { return friction_of(network, k, network.inner_slip(k, velocity, spin)); },
      force);
}

template <int D>
void add_sliding_friction(const PairNetwork<D>& network, std::vector<Vec<D>>& force) {
  if (network.slip_0.empty()) return;
  add_edges(
      network, true, [&](std::size_t k) { return friction_of(network, k, network.slip_0[k]); },
      force);
}

template <int D>
void add_edge_torques(const PairNetwork<D>& network, std::span<const Vec<D>> edge_force,
                      std::vector<Vec<D>>& torque) {
  add_torques(
      network, [&](std::size_t k) { return edge_force[k]; }, torque);
}

template <int D>
void add_friction_torques(const PairNetwork<D>& network, std::span<const Vec<D>> velocity,
                          std::span<const Vec<D>> spin, std::vector<Vec<D>>& torque) {
  add_torques(
      network,
      [&](std::size_t k) { return friction_of(network, k, network.inner_slip(k, velocity, spin)); },
      torque);
}

template <int D>
void add_sliding_torques(const PairNetwork<D>& network, std::vector<Vec<D>>& torque) {
  if (network.slip_0.empty()) return;
  add_torques(
      network, [&](std::size_t k) { return friction_of(network, k, network.slip_0[k]); }, torque);
}

template <int D>
void add_known_friction(const PairNetwork<D>& network, std::span<const std::int32_t> known,
                        std::span<const Vec<D>> velocity, std::vector<Vec<D>>& force) {
  for (const std::int32_t p : known)
    for (const std::int32_t edge : network.edges_of(p)) {
      const auto k = index(edge);
      const std::int32_t other = network.i[k] == p ? network.j[k] : network.i[k];
      force[index(other)] -= friction_of(network, k, velocity[index(p)]);
    }
}

template <int D>
void add_known_friction(const PairNetwork<D>& network, std::span<const std::int32_t> known,
                        std::span<const Vec<D>> velocity, std::span<const Vec<D>> spin,
                        std::vector<Vec<D>>& force, std::vector<Vec<D>>& moment) {
  if (network.lever_i.empty()) return add_known_friction(network, known, velocity, force);
  for (const std::int32_t p : known)
    for (const std::int32_t edge : network.edges_of(p)) {
      const auto k = index(edge);
      const bool first = network.i[k] == p;
      const auto other = index(first ? network.j[k] : network.i[k]);
      const double own = first ? network.lever_i[k] : network.lever_j[k];
      const double theirs = first ? network.lever_j[k] : network.lever_i[k];
      // As the other one sees it: e towards it.
      const Vec<D> e = first ? -1.0 * network.e[k] : network.e[k];
      const Vec<D> slip = -1.0 * velocity[index(p)] - swing(own * spin[index(p)], e);
      const Vec<D> f = friction_of(network, k, slip);
      force[other] += f;
      moment[other] -= theirs * torque(e, f);
    }
}

template <int D>
void add_spring_forces(const PairNetwork<D>& network, std::span<const Vec<D>> velocity,
                       std::vector<Vec<D>>& force) {
  add_edges(
      network, true, [&](std::size_t k) { return spring_of(network, k, velocity); }, force);
}

template <int D>
void add_bond_springs(const PairNetwork<D>& network, std::span<const Vec<D>> velocity,
                      std::vector<Vec<D>>& force) {
  add_bonds(
      network, true, [&](std::size_t k) { return spring_of(network, k, velocity); }, force);
}

template <int D>
void add_friction_blocks(const PairNetwork<D>& network,
                         std::vector<std::array<double, index(D* D)>>& blocks) {
  parallel_for(network.particles, [&](std::int64_t particle) {
    auto& block = blocks[index(particle)];
    for (const std::int32_t edge : network.edges_of(particle)) {
      const auto k = index(edge);
      const double along = network.zeta_par[k] - network.zeta_perp[k];
      for (std::size_t row = 0; row < D; ++row)
        for (std::size_t col = 0; col < D; ++col)
          block[row * D + col] += along * network.e[k].x[row] * network.e[k].x[col] +
                                  (row == col ? network.zeta_perp[k] : 0.0);
    }
  });
}

template <int D>
void add_laplacian(const PairNetwork<D>& network, std::vector<double>& laplacian) {
  // At r = 0 the Laplacian of a pair that repels is infinite. Such an edge is left out: coincident
  // particles have measure zero, and one must not make an average infinite for good.
  const auto share = [&](std::size_t k) {
    const bool acts = network.f_c[k] != 0.0 || k >= index(network.pairs());
    return acts && network.r[k] > 0.0 ? network.k_c[k] - (D - 1) * network.f_c[k] / network.r[k]
                                      : 0.0;
  };
  add_edges(network, false, share, laplacian);
  add_density_curvature(network, laplacian);
  if (network.beyond.empty()) return;
  const auto first_bond = index(network.pairs());
  add_bonds(
      network, false, [&](std::size_t k) { return network.beyond[k - first_bond].curvature; },
      laplacian);
}

template <int D>
void add_density_curvature(const PairNetwork<D>& network, std::vector<double>& laplacian) {
  const DensityColumns& columns = network.densities;
  if (columns.empty()) return;
  parallel_for(network.particles, [&](std::int64_t particle) {
    const auto p = index(particle);
    double sum = 0.0;
    Vec<D> gradient{};
    for (const std::int32_t edge : network.edges_of(particle)) {
      if (edge >= network.pairs()) break;  // bonds are the last
      const auto k = index(edge);
      const bool first = network.i[k] == particle;
      const auto q = index(first ? network.j[k] : network.i[k]);
      sum += columns.psi_2[q] * columns.W_1[k] * columns.W_1[k];
      gradient += (first ? columns.W_1[k] : -columns.W_1[k]) * network.e[k];
    }
    laplacian[p] += sum + columns.psi_2[p] * dot(gradient, gradient);
  });
}

#define ODPD_INSTANTIATE(D)                                                                 \
  template void add_edge_forces<D>(const PairNetwork<D>&, std::span<const Vec<D>>,          \
                                   std::vector<Vec<D>>&);                                   \
  template void add_conservative_forces<D>(const PairNetwork<D>&, std::vector<Vec<D>>&);    \
  template void add_friction_forces<D>(const PairNetwork<D>&, std::span<const Vec<D>>,      \
                                       std::vector<Vec<D>>&, std::span<const Vec<D>>);      \
  template void add_edge_torques<D>(const PairNetwork<D>&, std::span<const Vec<D>>,         \
                                    std::vector<Vec<D>>&);                                  \
  template void add_friction_torques<D>(const PairNetwork<D>&, std::span<const Vec<D>>,     \
                                        std::span<const Vec<D>>, std::vector<Vec<D>>&);     \
  template void add_sliding_torques<D>(const PairNetwork<D>&, std::vector<Vec<D>>&);        \
  template void add_known_friction<D>(const PairNetwork<D>&, std::span<const std::int32_t>, \
                                      std::span<const Vec<D>>, std::span<const Vec<D>>,     \
                                      std::vector<Vec<D>>&, std::vector<Vec<D>>&);          \
  template void add_sliding_friction<D>(const PairNetwork<D>&, std::vector<Vec<D>>&);       \
  template void add_known_friction<D>(const PairNetwork<D>&, std::span<const std::int32_t>, \
                                      std::span<const Vec<D>>, std::vector<Vec<D>>&);       \
  template void add_spring_forces<D>(const PairNetwork<D>&, std::span<const Vec<D>>,        \
                                     std::vector<Vec<D>>&);                                 \
  template void add_bond_springs<D>(const PairNetwork<D>&, std::span<const Vec<D>>,         \
                                    std::vector<Vec<D>>&);                                  \
  template void add_friction_blocks<D>(const PairNetwork<D>&,                               \
                                       std::vector<std::array<double, index(D* D)>>&);      \
  template void add_laplacian<D>(const PairNetwork<D>&, std::vector<double>&);              \
  template void add_density_curvature<D>(const PairNetwork<D>&, std::vector<double>&);
ODPD_INSTANTIATE(2)
ODPD_INSTANTIATE(3)
#undef ODPD_INSTANTIATE

}  // namespace odpd
