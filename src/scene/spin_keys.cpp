#include "odpd/scene/spin_keys.h"

#include <fmt/format.h>

#include <algorithm>

namespace odpd {

namespace {

bool spins(const SpeciesSettings& s) { return s.lever_radius > 0.0; }

// The keys of [fluid] or of one [[species]].
template <int D>
Spin read_spin(const Config& keys, double mass) {
  const bool has_moment = keys.has("moment");
  Spin spin;
  if (keys.has("lever_radius")) spin.lever_radius = keys.non_negative("lever_radius");
  if (spin.lever_radius == 0.0) {
    if (has_moment)
      keys.fail("moment", "belongs to particles that spin: give lever_radius > 0 beside it");
    return spin;
  }
  const double solid = (D == 3 ? 0.4 : 0.5) * mass * spin.lever_radius * spin.lever_radius;
  spin.moment = keys.non_negative("moment", solid);
  if (mass == 0.0 && spin.moment > 0.0)
    keys.fail("moment",
              "particles without mass have no moment of inertia: give fluid.mass, or leave the "
              "moment out");
  return spin;
}

}  // namespace

template <int D>
void read_spins(const Config& config, SceneSettings<D>& scene) {
  const Spin fluid = read_spin<D>(config.table("fluid"), scene.mass);
  const std::vector<Config> entries = config.tables("species");
  for (std::size_t k = 0; k < scene.species.size(); ++k) {
    const bool own =
        k < entries.size() && (entries[k].has("lever_radius") || entries[k].has("moment"));
    const Spin spin = own ? read_spin<D>(entries[k], scene.mass) : fluid;
    scene.species[k].lever_radius = spin.lever_radius;
    scene.species[k].moment = spin.moment;
  }
}

std::vector<Spin> spins_of(const std::vector<SpeciesSettings>& species) {
  std::vector<Spin> all;
  if (std::none_of(species.begin(), species.end(), spins)) return all;
  for (const SpeciesSettings& s : species) all.push_back({s.lever_radius, s.moment});
  return all;
}

std::string spins_text(const std::vector<SpeciesSettings>& species) {
  std::string text;
  for (const SpeciesSettings& s : species)
    if (spins(s))
      text += fmt::format("{}'{}' (lever radius {:.6g}, moment of inertia {:.6g})",
                          text.empty() ? "species " : ", ", s.name, s.lever_radius, s.moment);
  return text;
}

template void read_spins<2>(const Config&, SceneSettings<2>&);
template void read_spins<3>(const Config&, SceneSettings<3>&);

}  // namespace odpd
