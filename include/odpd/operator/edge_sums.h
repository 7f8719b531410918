#pragma once
// Forces on particles from their edges. Each particle adds up its own edges in fixed order: the same bits on any
// thread count.
#include <array>
#include <span>
#include <vector>

#include "odpd/core/index.h"
#include "odpd/pairs/network.h"

namespace odpd {

/// Friction on i of edge k, -Z slip, with the physical zeta. Everything that needs the friction of one pair (forces, stress,
/// heat) takes it from here.
template <int D>
inline Vec<D> friction_of(const PairNetwork<D>& network, std::size_t k, const Vec<D>& slip) {
  const double along = dot(slip, network.e[k]);
  Vec<D> force = (network.zeta_perp[k] - network.zeta_par[k]) * along * network.e[k];
  if (network.transverse) force -= network.zeta_perp[k] * slip;
  return force;
}

/// force[p] += sum over edges of p of (+-) edge_force, with + where p is i; edge_force: on i, one per edge.
template <int D>
void add_edge_forces(const PairNetwork<D>& network, std::span<const Vec<D>> edge_force,
                     std::vector<Vec<D>>& force);

/// force[p] += conservative forces, f_c e and what bonds have beyond.
template <int D>
void add_conservative_forces(const PairNetwork<D>& network, std::vector<Vec<D>>& force);

/// force[p] -= (R v)_p, friction with the physical zeta for the velocities and spins (empty: none) of all particles, without that of
/// slip_0.
template <int D>
void add_friction_forces(const PairNetwork<D>& network, std::span<const Vec<D>> velocity,
                         std::vector<Vec<D>>& force, std::span<const Vec<D>> spin = {});

/// force[p] -= friction by the network's slip_0 alone (nothing where there is none).
template <int D>
void add_sliding_friction(const PairNetwork<D>& network, std::vector<Vec<D>>& force);

// Torques about the particles' centres, where the network has lever arms; nothing where it has none.

/// torque[p] -= sum over edges of p of l_p e x edge_force; edge_force: on i, one per edge.
template <int D>
void add_edge_torques(const PairNetwork<D>& network, std::span<const Vec<D>> edge_force,
                      std::vector<Vec<D>>& torque);

/// Those of add_friction_forces.
template <int D>
void add_friction_torques(const PairNetwork<D>& network, std::span<const Vec<D>> velocity,
                          std::span<const Vec<D>> spin, std::vector<Vec<D>>& torque);

/// Those of add_sliding_friction.
template <int D>
void add_sliding_torques(const PairNetwork<D>& network, std::vector<Vec<D>>& torque);

/// The same on the partners of the particles `known` (indices in memory, ascending), by the motion of those alone: all others are
/// at rest, whatever `velocity` says of them. Costs as much as they have edges.
template <int D>
void add_known_friction(const PairNetwork<D>& network, std::span<const std::int32_t> known,
                        std::span<const Vec<D>> velocity, std::vector<Vec<D>>& force);

/// The same where particles spin, with the torques.
template <int D>
void add_known_friction(const PairNetwork<D>& network, std::span<const std::int32_t> known,
                        std::span<const Vec<D>> velocity, std::span<const Vec<D>> spin,
                        std::vector<Vec<D>>& force, std::vector<Vec<D>>& torque);

/// force[p] -= (K v)_p with K = sum over edges of max(k_c, 0) e e^T, the linearised conservative force along the line of
/// centres. With that of slip_0.
template <int D>
void add_spring_forces(const PairNetwork<D>& network, std::span<const Vec<D>> velocity,
                       std::vector<Vec<D>>& force);

/// The same for bonds alone.
template <int D>
void add_bond_springs(const PairNetwork<D>& network, std::span<const Vec<D>> velocity,
                      std::vector<Vec<D>>& force);

/// blocks[p] += sum over edges of p of Z = zeta_par e e^T + zeta_perp (I - e e^T), row-major.
template <int D>
void add_friction_blocks(const PairNetwork<D>& network,
                         std::vector<std::array<double, index(D* D)>>& blocks);

/// laplacian[p] += sum over edges of k_c - (D - 1) f_c / r and what bonds have beyond, and for free particles that of the
/// densities: the Laplacian of U in r_p without that of external potentials.
template <int D>
void add_laplacian(const PairNetwork<D>& network, std::vector<double>& laplacian);

/// laplacian[p] += sum_q psi''(d_q) W'^2 + psi''(d_p) |sum_q W' e|^2, what the densities of p and its partners q add to the Laplacian
/// besides the edges; nothing in models without. Of other than free particles only the part of pairs that are edges.
template <int D>
void add_density_curvature(const PairNetwork<D>& network, std::vector<double>& laplacian);

}  // namespace odpd
