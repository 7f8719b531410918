#pragma once
// Species that spin, in a case file: `lever_radius` and `moment` of [[species]], and of [fluid] for those that give none.
#include "odpd/core/config.h"
#include "odpd/scene/scene_settings.h"

namespace odpd {

/// Sets Spin of the species; needs them, the mass and the model. The moment is that of a solid sphere (3D) or disk (2D) of the particle's
/// mass and the lever radius, unless given. Throws ConfigError
///   for negative numbers, a moment without a lever radius or without mass;
///   where nothing turns a species that spins, as none of its pairs has friction across lines of centres;
///   for such friction between species of which neither spins, unless fluid.antisymmetric_stress is true (or the model is "sdpd", which
///   warns of it). Not for library users, who make such fluids on purpose.
template <int D>
void read_spins(const Config& config, SceneSettings<D>& scene);

/// As particles have them: empty where nobody spins.
std::vector<Spin> spins_of(const std::vector<SpeciesSettings>& species);

/// Which species spin, by lever radius and moment; empty where none does.
std::string spins_text(const std::vector<SpeciesSettings>& species);

}  // namespace odpd
