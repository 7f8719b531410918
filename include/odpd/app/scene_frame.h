#pragma once
// The particles of a scene as files need them.
#include <cstdint>
#include <span>
#include <vector>

#include "odpd/dynamics/clock.h"
#include "odpd/io/frame.h"
#include "odpd/scene/scene.h"

namespace odpd {

/// The particles at this step. `density`: d of each, in memory order (pairs/densities.h), or nothing.
template <int D>
Frame scene_frame(const Scene<D>& scene, const Clock& clock, std::span<const double> density = {});

/// Identities i, j of each bond, one after the other.
std::vector<std::int64_t> bond_ends(const std::vector<Bond>& bonds);

}  // namespace odpd
