#pragma once
// The loop every pair model shares: pair list -> edges, in parallel, in an order fixed by the list alone.
#include <numeric>

#include "odpd/core/parallel.h"
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
  for (int c = 0; c < D; ++c) e[c] = normal[static_cast<std::size_t>(c)];
  return (id_i < id_j ? 1.0 : -1.0) / norm(e) * e;
}

/// `terms(r, site_i, site_j)` is the model's inline pair function.
template <int D, class Terms>
void write_pair_edges(const Terms& terms, double cutoff, const PairList<D>& list, const Box<D>& box,
                      std::span<const Vec<D>> positions, const Particles<D>& particles,
                      PairNetwork<D>& network) {
  const std::int64_t rows = list.rows();
  const double reach2 = cutoff * cutoff;
  const auto interacts = [&](std::size_t p, std::size_t q, Vec<D>& d) {
    d = box.separation(positions[p], positions[q]);
    return dot(d, d) < reach2 && (particles.is_free(p) || particles.is_free(q));
  };
  std::vector<std::int64_t> first(static_cast<std::size_t>(rows) + 1, 0);
  parallel_for(rows, [&](std::int64_t row) {
    const auto p = static_cast<std::size_t>(row);
    Vec<D> d;
    for (const std::int32_t q : list.partners(row))
      if (interacts(p, static_cast<std::size_t>(q), d)) ++first[p + 1];
  });
  std::partial_sum(first.begin(), first.end(), first.begin());
  network.particles = rows;
  network.resize(first.back());
  parallel_for(rows, [&](std::int64_t row) {
    const auto p = static_cast<std::size_t>(row);
    auto k = static_cast<std::size_t>(first[p]);
    Vec<D> d;
    for (const std::int32_t partner : list.partners(row)) {
      const auto q = static_cast<std::size_t>(partner);
      if (!interacts(p, q, d)) continue;
      const double r = norm(d);
      network.i[k] = static_cast<std::int32_t>(row);
      network.j[k] = partner;
      network.r[k] = r;
      network.e[k] =
          r > 0.0 ? (1.0 / r) * d : overlap_direction<D>(particles.id[p], particles.id[q]);
      const PairTerms t = terms(r, Site{particles.species[p]}, Site{particles.species[q]});
      network.u[k] = t.u;
      network.f_c[k] = t.f_c;
      network.k_c[k] = t.k_c;
      network.zeta_par[k] = t.zeta_par;
      network.zeta_perp[k] = t.zeta_perp;
      network.kT[k] = t.kT;
      ++k;
    }
  });
  network.transverse = false;
  for (const double z : network.zeta_perp) network.transverse = network.transverse || z != 0.0;
  network.index_edges();
}

}  // namespace odpd
