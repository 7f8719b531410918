#pragma once
// [[wall]] of a case file.
#include "odpd/core/config.h"
#include "odpd/scene/scene_settings.h"

namespace odpd {

/// Appends the walls; needs box and species. Throws ConfigError for values out of range, and for ends of the box without a wall.
template <int D>
void read_walls(const Config& config, SceneSettings<D>& scene);

/// What a wall leaves out, by the model; needs that. Particles that fill space (ReferenceState::spacing) make walls of a lattice of their
/// density, as deep as they reach. Throws ConfigError for a wall without layers of a model that has no such default, and for layers
/// outside of the wall.
template <int D>
void complete_walls(const Config& config, SceneSettings<D>& scene);

}  // namespace odpd
