#pragma once
// The resistance operator seen from a grid: P^T R P with multilinear P, where each half of an edge sees the gradient at its end,
//
//   v_i - v_j  ->  sum over the corners n of the particle's cell  (d . grad N_n) v_n,   d = r_i - r_j
//
// which is exact for velocities linear in space and keeps the stencil at 3^D points; all edges of a particle share one
// gradient, so that they are added up before the cell sees them. Friction with particles of known velocity and the shift act
// at the particle's own position.
//
// A rigid body does not strain, which the edges at its constituents do not say. So each constituent adds the dissipation of a
// stiffer fluid there, which a rotation does not feel:
//
//   c tau (2 E : E + (tr E)^2),   E the strain rate there,   tau = sum zeta r^2 / (2 D (D + 2)) of a free particle
//
// with c twice the body's radius in units of the grid's spacing.
//
// Spins follow the grid, w = 1/2 curl v. The slip of an edge with levers is then E d: what its friction along e sees stays, and
// friction across e, taken as isotropic, becomes
//
//   zeta_perp |E d - e (e . E d)|^2  ->  zeta_perp r^2 / (D (D + 2)) (D E : E - (tr E)^2)
//
// Its E : E = 1/2 (|grad v|^2 + d_a v_b d_b v_a) makes blocks that are not symmetric, d_a v_b d_b v_a, of which the mean of it
// and (div v)^2 is taken: where friction is the same everywhere their integrals are.
#include "odpd/core/index.h"
#include "odpd/operator/spin_resistance.h"
#include "odpd/solvers/multigrid.h"

namespace odpd {

/// Where a position of the box lies in a grid: the cell's lowest corner and the position in the cell, 0 to 1.
template <int D>
struct GridPosition {
  typename GridShape<D>::Index cell;
  std::array<float, index(D)> in_cell;
};

/// A node's position as the grid sees it: along the edges of the cell that a shear has tilted, so that the grid is tilted
/// with it and stays periodic.
template <int D>
Vec<D> grid_position(const Resistance<D>& resistance, std::size_t node);

template <int D>
GridPosition<D> locate(const GridShape<D>& shape, const double* position);

/// Row c: the derivative along axis c of space from those along the axes of the grid, per cell.
template <int D>
std::array<Vec<D>, D> grid_slopes(const Box<D>& box, const GridShape<D>& shape);

/// How friction is spread, by the edges of a sample of the free particles, or of all where few are free, with zeta the trace
/// of an edge's friction.
struct FrictionSpread {
  double range = 0.0;  ///< sqrt(sum zeta r^2 / sum zeta) (length); 0 without any
  /// (sum zeta)^2 / sum zeta^2 over the edges of a particle, on average: neighbours that share in its friction; 0 without any
  double ties = 0.0;
  /// Geometric mean over particles of sum zeta r^2 (force length time), so that a few stiff bonds do not count for much.
  double moment = 0.0;
};
// `rigid`: the operator around `resistance` where there are rigid bodies, else null.
template <int D>
FrictionSpread friction_spread(const Resistance<D>& resistance,
                               const RigidResistance<D>* rigid = nullptr);

/// `moment`: that of FrictionSpread, asked for with bodies only. `spins`: the operator around both, null where nobody spins.
template <int D>
GridOperator<D> galerkin(const Resistance<D>& resistance, const GridShape<D>& shape,
                         const RigidResistance<D>* rigid = nullptr, double moment = 0.0,
                         const SpinResistance<D>* spins = nullptr);

}  // namespace odpd
