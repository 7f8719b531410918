#pragma once
// The particles of a scene as files need them.
#include <cstdint>
#include <vector>

#include "odpd/dynamics/clock.h"
#include "odpd/io/frame.h"
#include "odpd/scene/scene.h"

namespace odpd {

/// The particles at this step.
template <int D>
Frame scene_frame(const Scene<D>& scene, const Clock& clock);

/// Identities i, j of each bond, one after the other.
std::vector<std::int64_t> bond_ends(const std::vector<Bond>& bonds);

}  // namespace odpd
