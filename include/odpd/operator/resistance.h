#pragma once
// The resistance operator of the unknowns, P^T R P + shift, from rank-1 edges:
//
//   y_i = shift x_i + sum_edges g (g . (x_i - x_j)),   g = sqrt(zeta_par) e   (x_j = 0 where j has known velocity)
//
// (Phan-Thien et al. 2016, eq. 16). With friction across e, g g^T becomes (zeta_par - zeta_perp) e e^T + zeta_perp I.
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "odpd/core/index.h"
#include "odpd/geometry/box.h"
#include "odpd/operator/dof_map.h"
#include "odpd/operator/free_motions.h"
#include "odpd/operator/system.h"
#include "odpd/pairs/network.h"

namespace odpd {

/// Determinant of a symmetric positive semidefinite D x D block relative to the largest it could have with its trace: 1
/// for an isotropic block, 0 for a singular one.
template <int D>
double relative_determinant(const double* block);

template <int D>
class Resistance : public System {
 public:
  using Block = std::array<double, index(D* D)>;  ///< row-major
  /// An edge as one of its two free particles sees it.
  struct Link {
    std::int32_t edge = 0;  ///< of the network
    std::int32_t node = 0;  ///< the other end
  };
  /// What friction across e adds to an edge; kept only where there is any.
  struct Across {
    double zeta_perp = 0.0;
    double sign = 1.0;  ///< of zeta_par - zeta_perp
  };

  /// hold_centre_of_mass: solve the constrained problem (operator/system.h) where R is definite.
  explicit Resistance(const Box<D>& box, bool hold_centre_of_mass = false)
      : box_(box), hold_(hold_centre_of_mass) {}

  /// Takes over the edges of `network`; `shift` (mass/time) is added to the diagonal, e.g. 2 m/dt, and
  /// `stiffness_time` max(k_c, 0) to the friction along each edge of a pair, `bond_time` times that of a bond (times; 0:
  /// friction alone).
  /// All ranks call it together and throw the same error.
  /// Throws SolverError for a rattler: a free particle whose friction block is singular at shift = 0, naming it by
  /// identity, its neighbours and the cures; and for a group of particles out of reach of all others. What is free to turn,
  /// or to slide along what holds it, has null motions (operator/free_motions.h). (Inner floppy modes of a group, as in a
  /// chain with central friction, are left to the solver.) `arms`: as for DofMap.
  void rebuild(const PairNetwork<D>& network, const DofMap<D>& dofs, const Particles<D>& particles,
               std::span<const Vec<D>> positions, double shift, double stiffness_time = 0.0,
               double bond_time = 0.0, std::span<const Vec<D>> arms = {});

  /// The same box with its sliding images elsewhere.
  void slide(const Box<D>& box) { box_ = box; }

  int block_size() const override { return D; }
  std::int64_t nodes() const override { return nodes_; }
  void apply(std::span<const double> x, std::span<double> y) const override;
  void block_diagonal(std::span<double> blocks) const override;
  const BlockCsr& matrix() const override;
  std::span<const double> positions() const override { return positions_; }
  Vec<D> position(std::size_t node) const {
    Vec<D> r;
    for (std::size_t c = 0; c < D; ++c) r.x[c] = positions_[node * D + c];
    return r;
  }
  int space_dimension() const override { return D; }
  int periodic_directions() const override { return box_.periodic_directions(); }
  bool translations_are_null() const override { return translations_are_null_; }
  bool holds_centre_of_mass() const override { return hold_ && !translations_are_null_; }
  /// With bodies, motions in which these are rigid.
  std::span<const std::vector<double>> null_motions() const override { return free_.basis; }
  std::span<const FreeGroup> free_groups() const { return free_.groups; }
  std::uint64_t generation() const override { return generation_; }
  Share share() const override { return share_; }

  /// The rows: a node's links, in the order of the edges; both ends of an edge have one.
  std::span<const Link> links(std::size_t node) const {
    const auto begin = index(start_[node]);
    return std::span<const Link>(links_).subspan(begin, index(start_[node + 1]) - begin);
  }
  /// g = sqrt(|zeta_par - zeta_perp|) e of an edge.
  const Vec<D>& g(const Link& link) const { return g_[index(link.edge)]; }
  const Across& across(const Link& link) const { return across_[index(link.edge)]; }
  /// Friction across e sees spins, and does not resist where both ends turn as one (operator/spin_resistance.h).
  bool sees_spins(const Link& link) const {
    return !sees_spins_.empty() && sees_spins_[index(link.edge)] != 0;
  }
  /// The link carries friction.
  bool ties(const Link& link) const {
    return dot(g(link), g(link)) > 0.0 || (!across_.empty() && across(link).zeta_perp > 0.0);
  }
  /// Of all edges of the network; friction across e may be empty.
  std::span<const Vec<D>> g() const { return g_; }
  std::span<const Across> across() const { return across_; }
  /// Friction of each node with particles of known velocity, and the shift (empty: none).
  std::span<const Block> anchors() const { return anchor_; }
  std::span<const Block> diagonal() const { return diagonal_; }
  bool transverse() const { return !across_.empty(); }
  const Box<D>& box() const { return box_; }
  double shift() const { return shift_; }
  double stiffness_time() const { return stiffness_time_; }

 private:
  Vec<D> pull(const Link& link, const Vec<D>& slip) const;
  template <bool transverse>
  Vec<D> row_product(std::size_t node, std::span<const double> x) const;
  void weigh_edges(const PairNetwork<D>& network);
  void count_links(const PairNetwork<D>& network, const DofMap<D>& dofs);
  void fill_row(std::size_t node, std::int32_t particle, const PairNetwork<D>& network,
                const DofMap<D>& dofs);
  void check_clusters(const DofMap<D>& dofs, const Particles<D>& particles);
  void check_rattlers(const PairNetwork<D>& network, const DofMap<D>& dofs,
                      const Particles<D>& particles) const;

  Box<D> box_;
  bool hold_;
  std::int64_t nodes_ = 0;
  Share share_;
  std::vector<Vec<D>> g_;            // per edge of the network
  std::vector<Across> across_;       // per edge, or empty
  std::vector<char> sees_spins_;     // per edge; empty where nobody spins
  std::vector<std::int64_t> start_;  // rows of links_
  std::vector<Link> links_;
  std::vector<std::int32_t> parent_;  // per node its lowest neighbour; then of check_clusters
  std::vector<Block> anchor_;  // per node: friction with particles of known velocity, and the shift
  std::vector<Block> diagonal_;  // per node: all of its friction, and the shift
  double shift_ = 0.0;
  double stiffness_time_ = 0.0, bond_time_ = 0.0;
  bool translations_are_null_ = false;
  FreeMotions free_;
  std::vector<double> positions_;
  std::uint64_t generation_ = 0;
  mutable BlockCsr matrix_;  // made on demand
  mutable std::uint64_t matrix_generation_ = 0;
};

}  // namespace odpd
