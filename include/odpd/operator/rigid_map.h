#pragma once
// The constituents of the rigid bodies of unknown motion, and unknowns y = (y_w, y_V) of a body in which its map to their
// velocities is orthonormal:
//
//   v_k = V + w x a_k,   V = m^(-1/2) y_V,   w = S y_w,   S = (sum_k X(a_k)^T X(a_k))^(-1/2),   X(a) w = w x a
//
// with m constituents at arms a_k about their mean. So |y|^2 = sum_k |v_k|^2, whatever the body's size and the unit of length.
// The load of forces f_k is y_V = m^(-1/2) F, y_w = S T, with F their sum and T their torque. Constituents on a line (3D) do not
// turn about it: S is a pseudo-inverse, and what y_w has along the line moves nobody.
#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "odpd/core/rotation.h"
#include "odpd/operator/dof_map.h"
#include "odpd/particles/rigid_body.h"

namespace odpd {

template <int D>
class RigidMap {
 public:
  using Block = std::array<double, index(D* D)>;  ///< row-major

  /// `arms`: as for DofMap, of the bodies' present poses.
  void rebuild(const DofMap<D>& dofs, std::span<const Vec<D>> arms);

  std::int64_t bodies() const { return std::ssize(scale_); }
  std::int64_t constituents() const { return std::ssize(row_); }
  /// Of all bodies one after the other: numbers among the mobile particles (DofMap::mobile_of), and arms.
  std::span<const std::int32_t> rows() const { return row_; }
  std::span<const Vec<D>> arms() const { return arm_; }
  /// Where the constituents of body b begin, and where those of the last one end.
  std::int64_t begin(std::size_t b) const { return begin_[b]; }
  std::int64_t end(std::size_t b) const { return begin_[b + 1]; }
  /// The first body whose constituents begin at this one or later.
  std::size_t first_from(std::int64_t constituent) const {
    return index(std::lower_bound(begin_.begin(), begin_.end(), constituent) - begin_.begin());
  }

  /// V and w of unknowns; of a body's two nodes.
  RigidMotion<D> motion(std::size_t b, const double* y_linear, const double* y_angular) const;
  /// y of V and w: the inverse of `motion`.
  void unknowns(std::size_t b, const RigidMotion<D>& motion, double* y_linear,
                double* y_angular) const;
  /// y of a force and a torque: the transpose of `motion`.
  void load(std::size_t b, const RigidLoad<D>& load, double* y_linear, double* y_angular) const;

  double inverse_root_mass(std::size_t b) const { return scale_[b].inverse_root_mass; }
  const Block& turn(std::size_t b) const { return scale_[b].turn; }
  /// Projector on angular unknowns that move nobody: the second one in 2D, the turn about the line of a rod in 3D.
  const Block& unused(std::size_t b) const { return scale_[b].unused; }

 private:
  struct Scale {
    double inverse_root_mass;  // m^(-1/2)
    Block turn, unturn;        // S, and its (pseudo-)inverse
    Block unused;
  };
  static Scale scale_of(std::span<const Vec<D>> arms);

  std::vector<std::int64_t> begin_{0};
  std::vector<std::int32_t> row_;
  std::vector<Vec<D>> arm_;
  std::vector<Scale> scale_;
};

}  // namespace odpd
