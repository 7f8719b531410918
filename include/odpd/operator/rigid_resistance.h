#pragma once
// The resistance operator with rigid bodies, P^T (R + shift) P: R on the mobile particles (free ones and constituents,
// operator/resistance.h), P the orthonormal map from the unknowns of operator/rigid_map.h. As P^T P = 1 the norm of a residual
// is that of forces on particles, an inertia as the shift stays one, and a translation moves y_V of m constituents by m^(1/2).
// `scale_load` and its like lead from the (F, T) and (V, w) of operator/dof_map.h to these unknowns and back. What moves nobody,
// as the unused component of an angular velocity in 2D, gets a one on the diagonal.
#include <vector>

#include "odpd/operator/resistance.h"
#include "odpd/operator/rigid_map.h"

namespace odpd {

template <int D>
class RigidResistance : public System {
 public:
  explicit RigidResistance(const Box<D>& box, bool hold_centre_of_mass = false)
      : mobile_(box, hold_centre_of_mass) {}

  /// As Resistance::slide.
  void slide(const Box<D>& box) { mobile_.slide(box); }
  /// As Resistance::rebuild; `arms` as for DofMap, which must outlive the use of this operator.
  void rebuild(const PairNetwork<D>& network, const DofMap<D>& dofs, const Particles<D>& particles,
               std::span<const Vec<D>> positions, std::span<const Vec<D>> arms, double shift,
               double stiffness_time = 0.0, double bond_time = 0.0);

  /// What is to be solved: this system, or without bodies that of the mobile particles.
  const System& system() const {
    if (dofs_ == nullptr) return mobile_;
    return *this;
  }
  /// R on the mobile particles.
  const Resistance<D>& mobile() const { return mobile_; }
  const RigidMap<D>& map() const { return map_; }
  /// The mobile particle belongs to a body.
  bool is_constituent(std::size_t row) const { return node_[row] < 0; }
  /// Of a constituent.
  std::size_t body_of(std::size_t row) const { return index(-node_[row] - 1); }
  /// Node of a free mobile particle; negative for a constituent.
  std::int32_t node_of(std::size_t row) const { return node_[row]; }
  /// Node of V of a body; that of its w is its number.
  std::size_t linear_node(std::size_t body) const { return dofs_->body_node(body); }
  /// Diagonal block of A of all unknowns of each body, w before V: 2D x 2D, row-major.
  void body_blocks(std::vector<double>& blocks) const;

  // With bodies: between unknowns and the mobile particles, of the constituents of all ranks.

  /// v = P y.
  void to_particles(std::span<const double> y, std::span<double> v) const;
  /// y = P^T f.
  void from_particles(std::span<const double> f, std::span<double> y) const;
  /// X(a) S of a constituent, the member-th of all: what y_w adds to its velocity.
  typename Resistance<D>::Block lever(std::size_t b, std::size_t member) const;

  // In place, size() numbers; nothing without bodies.

  /// Unknowns' loads from forces and torques.
  void scale_load(std::span<double> load) const;
  /// Unknowns from velocities and angular velocities.
  void scale_velocity(std::span<double> q) const;
  /// Velocities and angular velocities from unknowns.
  void unscale_velocity(std::span<double> y) const;

  int block_size() const override { return D; }
  std::int64_t nodes() const override { return dofs_->nodes(); }
  Translations translations() const override;
  void apply(std::span<const double> x, std::span<double> y) const override;
  void block_diagonal(std::span<double> blocks) const override;
  const BlockCsr& matrix() const override;
  /// None: the angular velocities have no place.
  std::span<const double> positions() const override { return {}; }
  int space_dimension() const override { return D; }
  int periodic_directions() const override { return mobile_.periodic_directions(); }
  bool translations_are_null() const override { return mobile_.translations_are_null(); }
  bool holds_centre_of_mass() const override { return mobile_.holds_centre_of_mass(); }
  std::span<const std::vector<double>> null_motions() const override { return null_motions_; }
  std::uint64_t generation() const override { return mobile_.generation(); }
  Share share() const override { return dofs_->node_share(); }

 private:
  template <class Change>
  void for_each_body(std::span<double> x, const Change& change) const;
  Resistance<D> mobile_;
  const DofMap<D>* dofs_ = nullptr;
  RigidMap<D> map_;
  std::vector<std::int32_t> node_;  // per mobile particle: its node, or -(body + 1)
  std::vector<double> root_mass_;   // per body
  std::vector<std::vector<double>> null_motions_;
  mutable std::vector<double> velocity_, force_;  // of the mobile particles, in apply
  mutable BlockCsr matrix_;
  mutable std::uint64_t matrix_generation_ = 0;
};

}  // namespace odpd
