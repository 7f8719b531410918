#pragma once
// The edges of a model with densities (pairs/densities.h), in three phases: their geometry and W; d of each particle, a sum over all
// its partners; their terms, for which d is known at both ends. No phase begins before the last is done with all particles.
#include "odpd/pairs/edge_writer.h"
#include "odpd/pairs/weight_columns.h"

namespace odpd {

/// The pairs closer than the cutoff that `write_edge_geometry` leaves out, as it writes the others but without the index.
template <int D>
void write_rigid_geometry(const PairList<D>& list, double cutoff, const Box<D>& box,
                          std::span<const Vec<D>> positions, const Particles<D>& particles,
                          PairNetwork<D>& network);

/// sum[p] += value[k] over the edges k of p, for networks ordered by (i, j): the same bits on any number of threads.
template <int D>
void add_to_ends(const PairNetwork<D>& network, std::span<const double> value,
                 std::vector<double>& sum);

/// Edges written at a time.
inline constexpr std::int64_t density_block = 256;

/// weigh(network, begin, end, columns): W of the edges begin <= k < end to `columns`, which start at `begin`. It may run on any thread.
template <int D>
using DensityWeights =
    std::function<void(const PairNetwork<D>&, std::size_t, std::size_t, const WeightColumns&)>;
/// By `functions`, edge by edge, for any pairs of species. No slope.
template <int D>
DensityWeights<D> weights_of(const Densities& functions, const Particles<D>& particles);

/// fill(network, begin, end, W_2): what the model's pair function gives for the edges begin <= k < end, at most density_block of them, with
/// d of their ends in `network.densities`: f_c, k_c, zeta_par and those of u, zeta_perp and kT that vary; and W'' of each, from W_2 on. It may
/// run on any thread.
template <int D>
using DensityFill = std::function<void(PairNetwork<D>&, std::size_t, std::size_t, double*)>;

/// The forces of psi are added to what `fill` writes.
template <int D>
void write_density_edges(const Densities& functions, const DensityWeights<D>& weigh,
                         const DensityFill<D>& fill, double cutoff, const PairList<D>& list,
                         const Box<D>& box, std::span<const Vec<D>> positions,
                         const Particles<D>& particles, PairNetwork<D>& network);

/// The same by `terms(r, site_i, site_j)`, the model's inline pair function at the densities of the sites.
template <int D, class Terms>
void write_density_terms(const Densities& functions, const Terms& terms, double cutoff,
                         const PairList<D>& list, const Box<D>& box,
                         std::span<const Vec<D>> positions, const Particles<D>& particles,
                         PairNetwork<D>& network) {
  for (Column* column : {&network.u, &network.zeta_perp, &network.kT}) column->each();
  const DensityWeights<D> weigh = weights_of(functions, particles);
  const auto fill = [&](PairNetwork<D>& n, std::size_t begin, std::size_t end, double* W_2) {
    const auto site = [&](std::size_t i) { return site_of(particles, i, n.densities.d[i]); };
    fill_terms(terms, site, begin, end, n);
    weigh(n, begin, end, {.W_2 = W_2});
  };
  write_density_edges<D>(functions, weigh, fill, cutoff, list, box, positions, particles, network);
  network.transverse = false;
  for (const double z : network.zeta_perp.each()) network.transverse |= z != 0.0;
}

}  // namespace odpd
