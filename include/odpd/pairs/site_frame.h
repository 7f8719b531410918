#pragma once
// Particles tied by springs to reference sites, the sites being one rigid frame (Nguyen 2021, eq. 2.21-2.27): site k stands at
// X + Q b_k with sum b_k = 0, and pulls its particle with -H (r_k - X - Q b_k). The frame has neither mass nor friction, so at
// every moment its forces and torques balance, which puts it where its energy is least:
//
//   U(r_1, ..., r_n) = min over X, Q of H/2 sum_k |r_k - X - Q b_k|^2,   X = 1/n sum_k r_k,   sum_k Q b_k x r_k = 0
//
// Its pose is a function of the particles, no unknown. U is a sum over the pairs of its particles, and so becomes edges:
//
//   U = sum_{i<j} H/(2n) |d_ij|^2,   force on i  -H/n d_ij,   d_ij = r_i - r_j - Q (b_i - b_j)
//
// An edge has the part of that force along e as f_c, the rest in PairNetwork::beyond, and there a share of the Laplacian of U such
// that `add_laplacian` gives that of each particle,
//
//   L_i = H (d - d/n - tr X(Q b_i) M^-1 X(Q b_i)^T),   M = sum_k X(r_k - X)^T X(Q b_k)
//
// Its k_c, which is what an implicit step takes of it, is H/n: as the sum over all pairs it leaves rigid motion free, has the springs'
// stiffness H against swelling, and less against a change of shape. (More would do for shape, but too much against swelling
// biases the size: by g (g - h)/4/(1 + g - h/2) of the stretch under load, h and g the true and the implicit stiffness times
// dt/zeta.)
#include <cstdint>
#include <span>
#include <vector>

#include "odpd/core/rotation.h"
#include "odpd/pairs/network.h"

namespace odpd {

template <int D>
struct SiteFrame {
  std::int64_t first = 0;  ///< its particles are the identities first, first + 1, ...
  std::size_t bond = 0;    ///< number of its first bond among all: (0, 1), (0, 2), ..., (1, 2), ...
  std::vector<Vec<D>> sites;  ///< b_k (length)
  double H = 0.0;             ///< stiffness of each spring (force/length)

  std::size_t bonds() const { return sites.size() * (sites.size() - 1) / 2; }
};

/// The frame at its balance with particles at `points` (any origin): r_k - X and Q b_k.
template <int D>
struct BalancedFrame {
  std::vector<Vec<D>> arms, sites;
  BalancedFrame(const SiteFrame<D>& frame, std::span<const Vec<D>> points);
  /// sum_k |r_k - X - Q b_k|^2 (length squared).
  double distance_squared() const;
};

/// Completes the edges of a frame's bonds, the network's from `edge` on, whose i, j, e and r are written: u, f_c, k_c, beyond.
/// Throws BlowUpError where the frame may turn freely: for particles on a line (3D), in one point, or the mirror image of a
/// simplex.
template <int D>
void write_frame(const SiteFrame<D>& frame, std::span<const Vec<D>> points, std::size_t edge,
                 PairNetwork<D>& network);

}  // namespace odpd
