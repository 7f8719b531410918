#pragma once
// Rigid motions of a group of linked particles that meet no friction,
//
//   u_i = V + w x x_i,   R u = 0,   x_i found along the links, not wrapped into the box.
//
// Central friction along rigid links has d(d+1)/2 of them; particles of known velocity, friction across the links and links
// that go round a periodic box take some away. Which are left follows from the dissipation of these motions, u^T R u.
#include <cstdint>
#include <span>
#include <vector>

#include "odpd/operator/dof_map.h"

namespace odpd {

template <int D>
class Resistance;

/// A group of particles and how many motions of it are free.
struct FreeGroup {
  std::int64_t particles = 0;
  std::int32_t first = 0;  ///< one of them, as an index in memory
  std::int64_t motions = 0;
};

/// Each motion is a vector over all particles that move, and each projection passes through all of them: more are refused.
inline constexpr std::int64_t most_free_motions = 64;

/// How messages name the drag that resists them.
inline constexpr const char* drag_cure =
    "a drag (fluid.zeta_0; where walls move or forces drive, with fluid.zeta_0_under_flow = true)";

struct FreeMotions {
  /// With at least one free motion, in the order of their first particles.
  std::vector<FreeGroup> groups;
  std::int64_t motions = 0;  ///< of all groups
  /// Orthonormal vectors of D velocity components per mobile particle, group by group; empty with more than
  /// most_free_motions.
  std::vector<std::vector<double>> basis;
};

/// All of them, but for translations where nothing has a known velocity: System::translations has those. `parent`: a forest
/// over the mobile particles whose trees are the groups; without known velocities there is one. `arms`: as for DofMap.
/// A fluid that fills its box, that walls hold, or with friction across the links, is told from some links; else links are
/// looked at until no motion is left.
template <int D>
FreeMotions free_motions(const Resistance<D>& resistance, const DofMap<D>& dofs,
                         std::span<const Vec<D>> arms, std::span<const std::int32_t> parent);

}  // namespace odpd
