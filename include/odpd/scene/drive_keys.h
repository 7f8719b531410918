#pragma once
// [body_force] of a case file: a uniform force, or that of a wave, and forces of regions. [shear]: sliding images. start.velocity.
#include "odpd/core/config.h"
#include "odpd/scene/scene_settings.h"

namespace odpd {

/// Fills body_force, force_wave and force_regions; needs box and walls. Throws ConfigError for values out of range, and
/// for a net force that nothing takes up.
template <int D>
void read_drive(const Config& config, SceneSettings<D>& scene);

/// Fills start_velocity and start_wave; needs box and fluid. Throws ConfigError for values out of range, without mass and under [shear].
template <int D>
void read_start_flow(const Config& config, SceneSettings<D>& scene);

/// Sets the shear of the box; needs box, walls, bodies, fluid and forces. Throws ConfigError where these contradict it.
template <int D>
void read_shear(const Config& config, SceneSettings<D>& scene);

}  // namespace odpd
