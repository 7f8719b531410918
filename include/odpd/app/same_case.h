#pragma once
// What a checkpoint tells of the case that it belongs to, and whether that is the case of now.
#include "odpd/core/archive.h"
#include "odpd/core/config.h"
#include "odpd/scene/scene.h"

namespace odpd {

/// The case, and what its other files gave.
template <int D>
void save_case(const Config& config, const Scene<D>& scene, StateWriter& run);

/// Throws ConfigError naming the first value that is another one now. Free to change are title, run.duration,
/// run.until, run.blow_up, [solver] (but not solver.hold_centre_of_mass), [output], [[check]] and the names of other
/// files, whose contents count.
template <int D>
void require_same_case(const StateReader& run, const Config& config, const Scene<D>& scene);

}  // namespace odpd
