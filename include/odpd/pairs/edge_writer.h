#pragma once
// The loop every pair model shares: pair list -> edges, in parallel, in an order fixed by the list alone.
#include <functional>

#include "odpd/core/index.h"
#include "odpd/core/random.h"
#include "odpd/pairs/pair_model.h"

namespace odpd {

/// Direction of an edge at r = 0, where e is undefined: fixed by the identities, antisymmetric in them.
template <int D>
Vec<D> overlap_direction(std::int64_t id_i, std::int64_t id_j) {
  const auto low = static_cast<std::uint64_t>(std::min(id_i, id_j));
  const auto high = static_cast<std::uint64_t>(std::max(id_i, id_j));
  const auto normal = CounterRandom(0, Stream::overlap_direction).normals(0, 0, low, high);
  Vec<D> e;
  for (int c = 0; c < D; ++c) e[c] = normal[index(c)];
  return (id_i < id_j ? 1.0 : -1.0) / norm(e) * e;
}

/// Fills i, j, e, r and the index of `network` with the pairs of the list closer than the cutoff, and closer than the one of `reaches` that
/// is of their species (PairModel::reaches). `fill(begin, end)` then
/// writes the other columns of the edges begin <= k < end, from r, while these are close at hand. It may run on any thread, and
/// again for the same edges: it must not add to what it finds, nor sum over them.
template <int D>
void write_edge_geometry(const PairList<D>& list, double cutoff, const Box<D>& box,
                         std::span<const Vec<D>> positions, const Particles<D>& particles,
                         const std::function<void(PairNetwork<D>&, std::size_t, std::size_t)>& fill,
                         PairNetwork<D>& network, std::span<const double> reaches = {});

/// The columns of the edges begin <= k < end that `terms(r, site_i, site_j)`, the model's inline pair function, gives for what
/// `site(i)` says of a particle.
template <int D, class Terms, class SiteOf>
void fill_terms(const Terms& terms, const SiteOf& site, std::size_t begin, std::size_t end,
                PairNetwork<D>& n) {
  const auto u = n.u.each(), k_c = n.k_c.each(), zeta_perp = n.zeta_perp.each(), kT = n.kT.each();
  for (std::size_t k = begin; k < end; ++k) {
    const PairTerms t = terms(n.r[k], site(index(n.i[k])), site(index(n.j[k])));
    u[k] = t.u;
    n.f_c[k] = t.f_c;
    k_c[k] = t.k_c;
    n.zeta_par[k] = t.zeta_par;
    zeta_perp[k] = t.zeta_perp;
    kT[k] = t.kT;
  }
}

/// All edges in one pass, each while its geometry is close at hand.
template <int D, class Terms>
void write_pair_edges(const Terms& terms, double cutoff, const PairList<D>& list, const Box<D>& box,
                      std::span<const Vec<D>> positions, const Particles<D>& particles,
                      PairNetwork<D>& network, std::span<const double> reaches = {}) {
  for (Column* column : {&network.u, &network.k_c, &network.zeta_perp, &network.kT}) column->each();
  const auto site = [&](std::size_t i) { return site_of(particles, i); };
  const auto fill = [&](PairNetwork<D>& n, std::size_t begin, std::size_t end) {
    fill_terms(terms, site, begin, end, n);
  };
  network.densities.resize(0, 0);
  write_edge_geometry<D>(list, cutoff, box, positions, particles, fill, network, reaches);
  network.transverse = false;
  for (const double z : network.zeta_perp.each()) network.transverse |= z != 0.0;
}

}  // namespace odpd
