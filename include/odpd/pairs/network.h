#pragma once
// The pair network: one edge per interacting pair. Everything else follows from it,
//
//   R = sum_edges J^T Z J,  Z = zeta_par e e^T + zeta_perp (I - e e^T),  F_B = sum_edges J^T sqrt(2 kT Z/dt) w,
//
// with J the map from the two velocities to the slip v_i - v_j. The whole slip of an edge is v_i - v_j + slip_0, and where particles
// spin (particles/spin.h)
//
//   v_i - v_j + e x (l_i w_i + l_j w_j) + slip_0
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "odpd/core/communicator.h"
#include "odpd/core/rotation.h"
#include "odpd/core/vec.h"
#include "odpd/pairs/column.h"

namespace odpd {

/// What a pair model says of two particles a distance r apart.
struct PairTerms {
  double u = 0.0;          ///< pair energy
  double f_c = 0.0;        ///< conservative force on i along e (positive: repulsion)
  double k_c = 0.0;        ///< stiffness -df_c/dr (force/length)
  double zeta_par = 0.0;   ///< friction along e (mass/time)
  double zeta_perp = 0.0;  ///< friction across e (mass/time)
  double kT = 0.0;         ///< temperature of the pair (energy)
};

/// What a model with densities (pairs/densities.h) knows of each particle and of each edge of a pair. Empty for others.
struct DensityColumns {
  std::vector<double> d, psi, psi_1, psi_2;  ///< of each particle: d, psi(d), psi'(d), psi''(d)
  std::vector<double> W, W_1;                ///< of each edge: W(r), W'(r)

  bool empty() const { return d.empty(); }
  void resize(std::size_t particles, std::size_t pairs);
  std::int64_t bytes() const;
};

/// Edges as structure of arrays, ordered by (i, j) with i < j in memory. Edges between two particles of known
/// velocity, or of one rigid body, are left out. Bonds follow, in an order of their own.
template <int D>
struct PairNetwork {
  std::int64_t particles = 0;
  std::vector<std::int32_t> i, j;
  std::vector<Vec<D>> e;  ///< unit vector from j to i
  std::vector<double> r;  ///< distance
  std::vector<double> f_c, zeta_par;
  Column u, k_c, zeta_perp, kT;
  bool transverse = false;  ///< some zeta_perp is not zero
  /// What the energy of more than two particles adds to a bond (pairs/site_frame.h).
  struct Beyond {
    Vec<D> force{};  ///< on i, besides f_c e
    double curvature =
        0.0;  ///< to the Laplacian of U in either particle, besides k_c - (D - 1) f_c/r
  };
  std::vector<Beyond> beyond;  ///< of each bond; empty where all are of two particles
  DensityColumns densities;
  /// Relative velocity of the images that interact: the sliding ones of Lees-Edwards (length/time). Empty without shear;
  /// written by Dynamics::evaluate for all edges, bonds too.
  std::vector<Vec<D>> slip_0;
  /// l_i and l_j of each edge (length). Empty where nobody spins; written by Dynamics::evaluate for all edges (pairs/levers.h).
  std::vector<double> lever_i, lever_j;

  // The edges of each particle, in fixed order: edge[start[p]] .. edge[start[p+1]-1].
  std::vector<std::int64_t> start;
  std::vector<std::int32_t> edge;
  // Those of pairs that have it as i: first[p] .. first[p+1]-1. Empty when the edges are not ordered by i.
  std::vector<std::int64_t> first;
  std::int64_t bonds = 0;  ///< edges at the end that are bonds
  Share owned;  ///< the particles of this rank; all, unless whoever had the edges written says so

  std::int64_t size() const { return static_cast<std::int64_t>(i.size()); }
  std::int64_t pairs() const { return size() - bonds; }
  std::span<const std::int32_t> edges_of(std::int64_t particle) const {
    const auto b = index(start[index(particle)]);
    const auto n = index(start[index(particle) + 1]) - b;
    return std::span<const std::int32_t>(edge).subspan(b, n);
  }
  /// Sums over edges take those that count, and add up the ranks' sums: an edge counts where its particle i is at home.
  bool counts(std::size_t k) const { return owned.owns(std::int64_t{i[k]}); }
  /// Energy of all edges and of all densities, on all ranks.
  double energy() const;
  /// Conservative force on i of edge k.
  Vec<D> push(std::size_t k) const {
    const auto first_bond = index(pairs());
    const Vec<D> along = f_c[k] * e[k];
    return beyond.empty() || k < first_bond ? along : along + beyond[k - first_bond].force;
  }
  /// What friction sees on edge k where the particles have these velocities and spins (empty: none).
  Vec<D> slip(std::size_t k, std::span<const Vec<D>> velocity,
              std::span<const Vec<D>> spin = {}) const {
    const Vec<D> v = inner_slip(k, velocity, spin);
    return slip_0.empty() ? v : v + slip_0[k];
  }
  /// The same without slip_0.
  Vec<D> inner_slip(std::size_t k, std::span<const Vec<D>> velocity,
                    std::span<const Vec<D>> spin = {}) const {
    const Vec<D> v = velocity[index(i[k])] - velocity[index(j[k])];
    return spin.empty() ? v : v + spin_slip(k, spin);
  }
  /// e x (l_i w_i + l_j w_j); 0 where nobody spins.
  Vec<D> spin_slip(std::size_t k, std::span<const Vec<D>> spin) const {
    if (spin.empty() || lever_i.empty()) return {};
    return -1.0 * swing(lever_i[k] * spin[index(i[k])] + lever_j[k] * spin[index(j[k])], e[k]);
  }
  /// None of them is a bond at first.
  void resize(std::int64_t edges);
  /// Fills start and edge from i and j, whatever the order of the edges; `first` becomes empty.
  void index_edges();
  /// The same for edges ordered by (i, j), from i, j and `first`, on all threads.
  void index_rows();
  /// The last `count` edges are bonds and not in the index yet: adds each behind the other edges of its two particles.
  void index_bonds(std::int64_t count);
  /// Bytes held, for reports.
  std::int64_t bytes() const;

  std::vector<std::int32_t> scratch, next;  ///< of whoever writes the edges, and of the index
};

}  // namespace odpd
