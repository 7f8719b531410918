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

#include "odpd/geometry/box.h"
#include "odpd/operator/dof_map.h"
#include "odpd/operator/system.h"
#include "odpd/pairs/network.h"

namespace odpd {

template <int D>
class Resistance : public System {
 public:
  /// hold_centre_of_mass: solve the constrained problem (operator/system.h) where R is definite.
  explicit Resistance(const Box<D>& box, bool hold_centre_of_mass = false)
      : box_(box), hold_(hold_centre_of_mass) {}

  /// Takes over the edges of `network`; `shift` (mass/time) is added to the diagonal, e.g. 2 m/dt, and
  /// `stiffness_time` max(k_c, 0) to the friction along each edge (time; 0: friction alone).
  /// Throws SolverError for a rattler: a free particle whose friction block is singular at shift = 0, naming it by
  /// identity, its neighbours and the cures; and for a group of particles out of reach of all others. (Inner floppy modes
  /// of such a group, as in a chain with central friction, are left to the solver.)
  void rebuild(const PairNetwork<D>& network, const DofMap<D>& dofs, const Particles<D>& particles,
               std::span<const Vec<D>> positions, double shift, double stiffness_time = 0.0);

  int block_size() const override { return D; }
  std::int64_t nodes() const override { return nodes_; }
  void apply(std::span<const double> x, std::span<double> y) const override;
  void block_diagonal(std::span<double> blocks) const override;
  const BlockCsr& matrix() const override;
  std::span<const double> positions() const override { return positions_; }
  int space_dimension() const override { return D; }
  int periodic_directions() const override { return box_.periodic_directions(); }
  bool translations_are_null() const override { return translations_are_null_; }
  bool holds_centre_of_mass() const override { return hold_ && !translations_are_null_; }
  std::uint64_t generation() const override { return generation_; }

 private:
  // One direction of an edge between two free particles.
  struct Link {
    Vec<D> g;               ///< sqrt(|zeta_par - zeta_perp|) e
    std::int32_t node = 0;  ///< the other one
  };
  // What friction across e adds to a link; kept only where there is any.
  struct Across {
    double zeta_perp = 0.0;
    double sign = 1.0;  ///< of zeta_par - zeta_perp
  };
  using Block = std::array<double, static_cast<std::size_t>(D* D)>;  // row-major

  Vec<D> pull(std::size_t link, const Vec<D>& slip) const;
  template <bool transverse>
  Vec<D> row_product(std::size_t node, std::span<const double> x) const;
  void fill_row(std::size_t node, std::int32_t particle, const PairNetwork<D>& network,
                const DofMap<D>& dofs);
  void check_clusters(const DofMap<D>& dofs, const Particles<D>& particles) const;
  void check_rattlers(const PairNetwork<D>& network, const DofMap<D>& dofs,
                      const Particles<D>& particles) const;

  Box<D> box_;
  bool hold_;
  std::int64_t nodes_ = 0;
  std::vector<std::int64_t> start_;  // rows of links_, both directions of an edge stored
  std::vector<Link> links_;
  std::vector<Across> across_;  // one per link, or empty
  std::vector<Block> anchor_;  // per node: friction with particles of known velocity, and the shift
  double shift_ = 0.0;
  double stiffness_time_ = 0.0;
  bool translations_are_null_ = false;
  std::vector<double> positions_;
  std::uint64_t generation_ = 0;
  mutable BlockCsr matrix_;  // made on demand
  mutable std::uint64_t matrix_generation_ = 0;
};

}  // namespace odpd
