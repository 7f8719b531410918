#pragma once
// What a start file gives as the first lengths of bonds, and as positions of particles tied to sites.
#include <vector>

#include "odpd/scene/scene_settings.h"

namespace odpd {

/// Throws ConfigError, naming the file and its particles, for a bond that no step could begin with (half the box long, out
/// of the reach of fene), and for particles tied to sites that lie on a line or as the mirror image of their shape: where
/// that image fits them ten times better (in the mean square), at an energy of more than 20 kT.
template <int D>
void check_start_bonds(const SceneSettings<D>& settings, double kT,
                       const std::vector<Molecule>& molecules, const std::vector<Bond>& bonds,
                       const Particles<D>& particles);

}  // namespace odpd
