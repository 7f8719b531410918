#pragma once
// Bodies where no run may begin: in each other, in a wall, outside the box.
//
// Bodies touch softly, so that they are near is no fault. Two lie in each other when
//
//   a constituent of one is as near to one of the other as neighbours within one of them are, and
//   the centre of one is nearer to that of the other than its outermost constituent, or a constituent of one lies deeper
//   inside the other's outermost constituents than neighbours in it are apart.
//
// The first lets a body start inside a wide ring of others. A free body lies in a wall when a constituent is behind its
// surface, a fixed one or one of given motion (a bump on a wall) when all are.
#include "odpd/scene/scene_settings.h"

namespace odpd {

/// Of the `positions` that the [[body]] entries give. Throws ConfigError at that key.
template <int D>
void check_body_positions(const Config& config, const SceneSettings<D>& scene);

/// Of bodies as a start file has them, where a run may have pressed them into each other: refused is only what no run leaves,
/// two with one centre and a body with all constituents behind a wall's surface. Throws ConfigError, naming the file.
template <int D>
void check_start_bodies(const SceneSettings<D>& scene, const std::vector<std::size_t>& kind,
                        const Particles<D>& particles);

}  // namespace odpd
