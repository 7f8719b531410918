#pragma once
// The edges of a model with densities (pairs/densities.h), in three phases: their geometry; d of each particle, a sum over all
// its partners; their terms, for which d is known at both ends. No phase begins before the last is done with all particles.
#include "odpd/core/index.h"
#include "odpd/core/parallel.h"
#include "odpd/pairs/edge_writer.h"

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

/// The second phase, d and psi. Pairs that are no edges count as well, with the distances they have at this moment: those
/// inside a body stay, but not to the last bit, and those of two walls or bodies of known velocity may change.
template <int D, class Functions>
void sum_densities(const Functions& functions, double cutoff, const PairList<D>& list,
                   const Box<D>& box, std::span<const Vec<D>> positions,
                   const Particles<D>& particles, PairNetwork<D>& network) {
  DensityColumns& columns = network.densities;
  const auto particle_count = index(network.particles);
  columns.d.resize(particle_count);
  parallel_for(network.particles, [&](std::int64_t particle) {
    const auto i = index(particle);
    columns.d[i] = functions.self(site_of(particles, i));
  });
  const auto add = [&](const PairNetwork<D>& pairs) {
    columns.resize(particle_count, index(pairs.size()));
    parallel_for(pairs.size(), [&](std::int64_t edge) {
      const auto k = index(edge);
      const Derivatives w = functions.weight(pairs.r[k], site_of(particles, index(pairs.i[k])),
                                             site_of(particles, index(pairs.j[k])));
      columns.W[k] = w.value;
      columns.W_1[k] = w.first;
    });
    add_to_ends<D>(pairs, columns.W, columns.d);
  };
  PairNetwork<D> rigid;
  write_rigid_geometry(list, cutoff, box, positions, particles, rigid);
  if (rigid.size() > 0) add(rigid);
  add(network);
  // Between the phases: here ranks would fetch d of the particles that others own.
  parallel_for(network.particles, [&](std::int64_t particle) {
    const auto i = index(particle);
    const Derivatives psi = functions.energy(site_of(particles, i, columns.d[i]));
    columns.psi[i] = psi.value;
    columns.psi_1[i] = psi.first;
    columns.psi_2[i] = psi.second;
  });
}

/// `functions` is the model's Densities, and `terms(r, site_i, site_j)` its inline pair function at the densities of the sites:
/// the forces of psi are added here.
template <int D, class Functions, class Terms>
void write_density_edges(const Functions& functions, const Terms& terms, double cutoff,
                         const PairList<D>& list, const Box<D>& box,
                         std::span<const Vec<D>> positions, const Particles<D>& particles,
                         PairNetwork<D>& network) {
  for (Column* column : {&network.u, &network.k_c, &network.zeta_perp, &network.kT}) column->each();
  write_edge_geometry<D>(
      list, cutoff, box, positions, particles, [](PairNetwork<D>&, std::size_t, std::size_t) {},
      network);
  sum_densities(functions, cutoff, list, box, positions, particles, network);
  const DensityColumns& columns = network.densities;
  const auto site = [&](std::size_t i) { return site_of(particles, i, columns.d[i]); };
  constexpr std::int64_t at_a_time = 256;
  parallel_ranges(network.size(), at_a_time, [&](std::int64_t begin, std::int64_t end) {
    const auto k_c = network.k_c.each();
    fill_terms(terms, site, index(begin), index(end), network);
    for (auto k = index(begin); k < index(end); ++k) {
      const auto i = index(network.i[k]), j = index(network.j[k]);
      const double slope = columns.psi_1[i] + columns.psi_1[j];
      network.f_c[k] -= slope * columns.W_1[k];
      k_c[k] += slope * functions.weight(network.r[k], site(i), site(j)).second;
    }
  });
  network.transverse = false;
  for (const double z : network.zeta_perp.each()) network.transverse |= z != 0.0;
}

}  // namespace odpd
