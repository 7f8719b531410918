#pragma once
// The resistance operator of particles that spin. With the slip of an edge
//
//   g = v_i - v_j + s,   s = e x (l_i w_i + l_j w_j),   Z s = zeta_perp s, as s lies across e
//
// it is that of the velocities, R_vv (operator/rigid_resistance.h), and what the spins add to it:
//
//   force on i   zeta_perp s           torque on i   -l_i e x zeta_perp (v_i - v_j + s)
//
// Unknowns are y = R w of each free particle that spins, R its lever radius, so that loads are T/R: blocks of D in front of those of
// the velocities (in 2D the second component is unused and has a one on the diagonal). A constituent spins as its body does. The null
// space has translations, and rotations u = W x x with all w = W where R_vv without zeta_perp of these edges has u.
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "odpd/operator/rigid_resistance.h"

namespace odpd {

/// What a step adds on the diagonal.
struct Shifts {
  double inertia =
      0.0;  ///< on the velocity of each particle that moves, and I/m of it on a spin (mass/time)
  double drag = 0.0;  ///< on the velocity alone (mass/time)
};

template <int D>
class SpinResistance : public System {
 public:
  using Block = typename Resistance<D>::Block;  ///< row-major
  /// An edge across which friction sees a spin, as one of its two particles sees it.
  struct Link {
    std::int32_t other = 0;  ///< the other end among the mobile particles, -1: of known motion
    double zeta_perp = 0.0;  ///< mass/time
    double own = 0.0, theirs = 0.0;  ///< lever arms (length)
    Vec<D> e{};                      ///< from the other end to this one
  };

  explicit SpinResistance(const Box<D>& box, bool hold_centre_of_mass = false)
      : velocities_(box, hold_centre_of_mass) {}

  /// As Resistance::slide.
  void slide(const Box<D>& box) { velocities_.slide(box); }
  /// As RigidResistance::rebuild. Throws SolverError also for a particle that can spin, or roll along its neighbours, without friction.
  void rebuild(const PairNetwork<D>& network, const DofMap<D>& dofs, const Particles<D>& particles,
               std::span<const Vec<D>> positions, std::span<const Vec<D>> arms,
               const Shifts& shifts, double stiffness_time = 0.0, double bond_time = 0.0);

  /// What is to be solved: this system, or where nobody spins that of the velocities.
  const System& system() const {
    if (dofs_ == nullptr) return velocities_.system();
    return *this;
  }
  /// R_vv.
  const RigidResistance<D>& velocities() const { return velocities_; }
  /// Spins of free particles: the first nodes.
  std::int64_t spins() const { return std::ssize(length_); }
  /// R of a spin's y = R w.
  double length(std::size_t spin) const { return length_[spin]; }
  /// What inertia adds to the diagonal of a spin, in y.
  double spin_shift(std::size_t spin) const { return spin_shift_[spin]; }
  /// Node of the spin of a mobile particle, -1 when it has none of its own.
  std::int32_t spin_of(std::size_t row) const { return spin_of_[row]; }
  /// Of a mobile particle; none where no edge of it sees a spin. In the order of its edges.
  std::span<const Link> links(std::size_t row) const {
    const auto begin = index(start_[row]);
    return std::span<const Link>(links_).subspan(begin, index(start_[row + 1]) - begin);
  }
  /// Diagonal block of each spin, in y.
  std::span<const Block> spin_diagonal() const { return diagonal_; }

  /// 2D x 2D, row-major, velocity before spin (in y).
  using ParticleBlock = std::array<double, index(4 * D * D)>;
  /// Diagonal block of all unknowns of a mobile particle that spins by itself.
  ParticleBlock particle_block(std::size_t row) const;

  // In place, size() numbers; as those of RigidResistance.

  void scale_load(std::span<double> load) const;
  void scale_velocity(std::span<double> q) const;
  void unscale_velocity(std::span<double> y) const;

  int block_size() const override { return D; }
  std::int64_t nodes() const override { return spins() + velocities_.system().nodes(); }
  Translations translations() const override { return velocities_.system().translations(); }
  void apply(std::span<const double> x, std::span<double> y) const override;
  void block_diagonal(std::span<double> blocks) const override;
  const BlockCsr& matrix() const override;
  /// None: the spins have no place.
  std::span<const double> positions() const override { return {}; }
  int space_dimension() const override { return D; }
  int periodic_directions() const override { return velocities_.periodic_directions(); }
  bool translations_are_null() const override { return velocities_.translations_are_null(); }
  bool holds_centre_of_mass() const override { return velocities_.holds_centre_of_mass(); }
  std::span<const std::vector<double>> null_motions() const override { return null_motions_; }
  std::uint64_t generation() const override { return velocities_.generation(); }
  Share share() const override { return dofs_->share(); }

 private:
  /// Components of an angular velocity that mean something.
  static constexpr std::size_t turns = index(rotation_components<D>);

  void collect_links(const PairNetwork<D>& network, const DofMap<D>& dofs);
  void sum_diagonal(const DofMap<D>& dofs, double inertia);
  void check_spins(const DofMap<D>& dofs, const Particles<D>& particles) const;
  Vec<D> turning_of(std::span<const double> u) const;
  void refuse_resisted(const std::vector<double>& motion) const;
  void find_null_motions();
  std::span<const double> of_velocities(std::span<const double> x) const {
    return x.subspan(index(spins()) * D);
  }
  std::span<double> of_velocities(std::span<double> x) const {
    return x.subspan(index(spins()) * D);
  }
  bool is_constituent(std::size_t row) const {
    return with_bodies_ && velocities_.is_constituent(row);
  }
  /// w of all mobile particles from the unknowns.
  void spins_of(std::span<const double> x, std::vector<Vec<D>>& w) const;
  /// The matrix as blocks of the unknowns that a mobile particle's v, or its w, stands for.
  using Parts = std::vector<std::pair<std::int32_t, Block>>;
  void velocity_parts(std::size_t row, Parts& parts) const;
  void spin_parts(std::size_t row, Parts& parts) const;

  RigidResistance<D> velocities_;
  const DofMap<D>* dofs_ = nullptr;  // null where nobody spins
  bool with_bodies_ = false;
  std::vector<std::int64_t> start_;  // rows of links_
  std::vector<Link> links_;
  std::vector<std::int32_t> spin_of_;
  std::vector<std::int64_t>
      member_of_;  // with bodies: per mobile particle its number in RigidMap, -1 for free ones
  std::vector<double> length_, spin_shift_;
  std::vector<Block> diagonal_;
  std::vector<std::vector<double>> null_motions_;
  mutable std::vector<double> velocity_, force_, load_;  // in apply
  mutable std::vector<Vec<D>> spin_, torque_;
  mutable BlockCsr matrix_;
  mutable std::uint64_t matrix_generation_ = 0;
};

}  // namespace odpd
