#include "odpd/scene/spin_keys.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

namespace odpd {

namespace {

bool spins(const SpeciesSettings& s) { return s.lever_radius > 0.0; }

// The keys of [fluid] or of one [[species]]; `usual`: the lever radius where it is not given.
template <int D>
Spin read_spin(const Config& keys, double mass, double usual) {
  const bool has_moment = keys.has("moment");
  Spin spin;
  if (keys.has("lever_radius") || usual > 0.0)
    spin.lever_radius = keys.non_negative("lever_radius", usual);
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

// Some friction across lines of centres between these species.
template <int D>
bool turns(const PairModel<D>& model, std::size_t a, std::size_t b) {
  const Site site_a{static_cast<std::int32_t>(a)}, site_b{static_cast<std::int32_t>(b)};
  double from = 0.0;
  for (const double to : model.kinks(site_a, site_b)) {
    if (model.pair(0.5 * (from + to), site_a, site_b).zeta_perp > 0.0) return true;
    from = to;
  }
  return false;
}

// Where the case gives `key` of this pair of species.
Config place_of(const Config& config, const std::string& key, const std::string& a,
                const std::string& b) {
  for (const Config& entry : config.tables("pair")) {
    const std::vector<std::string> names = entry.texts("species");
    if (entry.has(key) && (names == std::vector{a, b} || names == std::vector{b, a})) return entry;
  }
  return config.table("fluid");
}

template <int D>
void check_spins(const Config& config, const SceneSettings<D>& scene) {
  const Config fluid = config.table("fluid");
  const std::vector<Config> entries = config.tables("species");
  const std::vector<SpeciesSettings>& species = scene.species;
  const bool sdpd = scene.model->name() == "sdpd";
  const bool insists = fluid.has("antisymmetric_stress") && fluid.boolean("antisymmetric_stress");
  for (std::size_t a = 0; a < species.size(); ++a) {
    const auto fail_radius = [&](const std::string& why) {
      const bool own = a < entries.size() && entries[a].has("lever_radius");
      (own ? entries[a] : fluid).fail("lever_radius", why);
    };
    bool turned = false;
    for (std::size_t b = 0; b < species.size(); ++b) {
      if (!turns(*scene.model, a, b)) continue;
      turned = true;
      if (!sdpd && !insists && !spins(species[a]) && !spins(species[b]))
        place_of(config, "gamma_perp", species[a].name, species[b].name)
            .fail("gamma_perp",
                  "friction across lines of centres turns pairs, and where particles do not spin "
                  "nothing takes that up: angular momentum is lost and the stress is not "
                  "symmetric (docs/spin.md). Let them spin with "
                  "fluid.lever_radius, as 0.5, or insist with fluid.antisymmetric_stress = true");
    }
    // Of particles alone: those of walls and bodies have no edges among themselves.
    const bool of_fluid = species[a].count != 0 && species[a].fraction > 0.0;
    if (scene.model->lever_radius() > 0.0 && of_fluid && !spins(species[a]) &&
        turns(*scene.model, a, a))
      fail_radius("is 0, but fluid.spin = true wants all of the fluid to spin: leave it out");
    if (!spins(species[a])) continue;
    if (!turned)
      fail_radius(fmt::format(
          "particles of species '{}' meet no friction across lines of centres, so nothing turns "
          "them: {}, or leave the lever radius out",
          species[a].name,
          sdpd ? "give fluid.form = \"classical\" and fluid.spin = true"
               : "give gamma_perp, of [fluid] or of a [[pair]] of the species"));
    // What spin leaves of the viscosity must be known before friction is set by it.
    if (sdpd && scene.model->lever_radius() == 0.0 && turns(*scene.model, a, a))
      fail_radius(
          "particles that spin have another viscosity by the same friction: give fluid.spin = "
          "true, which takes that into account");
  }
}

}  // namespace

template <int D>
void read_spins(const Config& config, SceneSettings<D>& scene) {
  const double usual = scene.model->lever_radius();
  const Config keys = config.table("fluid");
  const Spin fluid = read_spin<D>(keys, scene.mass, usual);
  if (usual > 0.0 && fluid.lever_radius == 0.0)
    keys.fail("lever_radius", "is 0, but fluid.spin = true wants it positive: leave one out");
  const std::vector<Config> entries = config.tables("species");
  for (std::size_t k = 0; k < scene.species.size(); ++k) {
    const bool own =
        k < entries.size() && (entries[k].has("lever_radius") || entries[k].has("moment"));
    const Spin spin = own ? read_spin<D>(entries[k], scene.mass, 0.0) : fluid;
    scene.species[k].lever_radius = spin.lever_radius;
    scene.species[k].moment = spin.moment;
  }
  check_spins(config, scene);
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
