#include "odpd/pairs/density_writer.h"

#include <algorithm>
#include <array>

#include "odpd/core/index.h"
#include "odpd/core/parallel.h"
#include "odpd/pairs/edge_loop.h"

namespace odpd {

namespace {

// The second phase, d and psi. Pairs that are no edges count as well, with the distances they have at this moment: those
// inside a body stay, but not to the last bit, and those of two walls or bodies of known velocity may change.
template <int D>
void sum_densities(const Densities& functions, const DensityWeights<D>& weigh, double cutoff,
                   const PairList<D>& list, const Box<D>& box, std::span<const Vec<D>> positions,
                   const Particles<D>& particles, PairNetwork<D>& network) {
  DensityColumns& columns = network.densities;
  parallel_for(network.particles, [&](std::int64_t particle) {
    const auto i = index(particle);
    columns.d[i] = functions.self(site_of(particles, i));
  });
  PairNetwork<D> rigid;
  write_rigid_geometry(list, cutoff, box, positions, particles, rigid);
  if (rigid.size() > 0) {
    std::vector<double> W(index(rigid.size()));
    parallel_ranges(rigid.size(), density_block, [&](std::int64_t begin, std::int64_t end) {
      weigh(rigid, index(begin), index(end), {.W = &W[index(begin)]});
    });
    add_to_ends<D>(rigid, W, columns.d);
  }
  add_to_ends<D>(network, columns.W, columns.d);
  // Between the phases: here ranks would fetch d of the particles that others own.
  parallel_for(network.particles, [&](std::int64_t particle) {
    const auto i = index(particle);
    const Derivatives psi = functions.energy(site_of(particles, i, columns.d[i]));
    columns.psi[i] = psi.value;
    columns.psi_1[i] = psi.first;
    columns.psi_2[i] = psi.second;
  });
}

}  // namespace

template <int D>
DensityWeights<D> weights_of(const Densities& functions, const Particles<D>& particles) {
  return [&](const PairNetwork<D>& network, std::size_t begin, std::size_t end,
             const WeightColumns& columns) {
    for (std::size_t k = begin; k < end; ++k) {
      const Derivatives w = functions.weight(network.r[k], site_of(particles, index(network.i[k])),
                                             site_of(particles, index(network.j[k])));
      if (columns.W != nullptr) columns.W[k - begin] = w.value;
      if (columns.W_1 != nullptr) columns.W_1[k - begin] = w.first;
      if (columns.W_2 != nullptr) columns.W_2[k - begin] = w.second;
    }
  };
}

template <int D>
void add_to_ends(const PairNetwork<D>& network, std::span<const double> value,
                 std::vector<double>& sum) {
  for_each_owned_edge(
      network, [&](std::size_t p, std::size_t k) { sum[p] += value[k]; },
      [&](std::size_t p, std::size_t begin, std::size_t end) {
        double own = sum[p];
        for (std::size_t k = begin; k < end; ++k) own += value[k];
        sum[p] = own;
      });
}

template <int D>
void write_density_edges(const Densities& functions, const DensityWeights<D>& weigh,
                         const DensityFill<D>& fill, double cutoff, const PairList<D>& list,
                         const Box<D>& box, std::span<const Vec<D>> positions,
                         const Particles<D>& particles, PairNetwork<D>& network) {
  network.k_c.each();
  network.densities.d.resize(index(list.rows()));
  const auto weigh_block = [&](PairNetwork<D>& n, std::size_t begin, std::size_t end) {
    weigh(n, begin, end, {.W = &n.densities.W[begin], .W_1 = &n.densities.W_1[begin]});
  };
  write_edge_geometry<D>(list, cutoff, box, positions, particles, weigh_block, network);
  sum_densities(functions, weigh, cutoff, list, box, positions, particles, network);
  parallel_ranges(network.size(), density_block, [&](std::int64_t first, std::int64_t last) {
    const auto begin = index(first);
    std::array<double, density_block> W_2;
    fill(network, begin, index(last), W_2.data());
    const double* const psi_1 = network.densities.psi_1.data();
    const double* const W_1 = &network.densities.W_1[begin];
    double* const f_c = &network.f_c[begin];
    double* const k_c = &network.k_c.each()[begin];
    for (std::size_t k = 0; k < index(last - first); ++k) {
      const double slope = psi_1[index(network.i[begin + k])] + psi_1[index(network.j[begin + k])];
      f_c[k] -= slope * W_1[k];
      k_c[k] += slope * W_2[k];
    }
  });
}

#define ODPD_INSTANTIATE(D)                                                               \
  template DensityWeights<D> weights_of<D>(const Densities&, const Particles<D>&);        \
  template void add_to_ends<D>(const PairNetwork<D>&, std::span<const double>,            \
                               std::vector<double>&);                                     \
  template void write_density_edges<D>(const Densities&, const DensityWeights<D>&,        \
                                       const DensityFill<D>&, double, const PairList<D>&, \
                                       const Box<D>&, std::span<const Vec<D>>,            \
                                       const Particles<D>&, PairNetwork<D>&);
ODPD_INSTANTIATE(2)
ODPD_INSTANTIATE(3)
#undef ODPD_INSTANTIATE

}  // namespace odpd
