#pragma once
// The resistance operator with rigid bodies, P^T (R + shift) P: R on the mobile particles (free ones and constituents,
// operator/resistance.h), P the map of operator/dof_map.h. With inertia as the shift, P^T shift P holds the mass and the
// tensor of inertia of each body, from its constituents. The unused component of an angular velocity in 2D gets a one on
// the diagonal.
#include <vector>

#include "odpd/operator/resistance.h"

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

  int block_size() const override { return D; }
  std::int64_t nodes() const override { return dofs_->nodes(); }
  Translations translations() const override { return dofs_->translations(); }
  void apply(std::span<const double> x, std::span<double> y) const override;
  void block_diagonal(std::span<double> blocks) const override;
  const BlockCsr& matrix() const override;
  /// None: the angular velocities have no place.
  std::span<const double> positions() const override { return {}; }
  int space_dimension() const override { return D; }
  int periodic_directions() const override { return mobile_.periodic_directions(); }
  bool translations_are_null() const override { return mobile_.translations_are_null(); }
  bool holds_centre_of_mass() const override { return mobile_.holds_centre_of_mass(); }
  std::span<const std::vector<double>> null_motions() const override {
    return mobile_.null_motions();
  }
  std::uint64_t generation() const override { return mobile_.generation(); }
  Share share() const override { return dofs_->share(); }

 private:
  /// Unit responses of one mobile particle, a row of R, to the nodes that move it: its velocity is the sum of column * unknown.
  struct Mover {
    std::size_t node;
    typename Resistance<D>::Block map;  // row-major, D velocity components by D unknowns
  };
  std::vector<Mover> movers(std::size_t row) const;
  void add_unused(std::size_t node, double* block) const;

  Resistance<D> mobile_;
  const DofMap<D>* dofs_ = nullptr;
  std::vector<Vec<D>> arms_;
  std::vector<std::int32_t> node_;  // per mobile particle: its node, or -(body + 1)
  mutable BlockCsr matrix_;
  mutable std::uint64_t matrix_generation_ = 0;
};

}  // namespace odpd
