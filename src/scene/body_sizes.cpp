// How large bodies are to a flow and to the fluid's particles, as a calibration found it.
#include <fmt/format.h>

#include <cmath>

#include "odpd/scene/scene_settings.h"

namespace odpd {

namespace {

// Of `count` bodies, or molecules, and of those before them.
template <int D, class Body, class Volume>
void check_room(const Config& entry, const char* key, const SceneSettings<D>& scene,
                std::int64_t count, const Body& body, const Volume& volume) {
  double total = static_cast<double>(count) * volume(body);
  for (const BodySettings<D>& b : scene.bodies)
    total += static_cast<double>(b.bodies()) * volume(b);
  for (const MoleculeSettings<D>& m : scene.molecules)
    total += static_cast<double>(m.molecules()) * volume(m);
  const double space = scene.fluid_volume();
  if (total >= space)
    entry.fail(key, fmt::format("with it bodies would take {:.6g} of the {:.6g} of space between "
                                "the walls, here {} times {:.6g}: it is of one body; take the "
                                "line that odpd calibrate --radius prints",
                                total, space, count, volume(body)));
}

template <int D, class Body>
void read_sizes(const Config& entry, const SceneSettings<D>& scene, std::int64_t count,
                Body& body) {
  if (entry.has("hydrodynamic_radius")) {
    body.hydrodynamic_radius = entry.positive("hydrodynamic_radius");
    check_room(entry, "hydrodynamic_radius", scene, count, body, [](const auto& b) {
      return unit_ball_volume<D> * std::pow(b.hydrodynamic_radius, D);
    });
  }
  if (entry.has("excluded_volume")) {
    body.excluded_volume = entry.positive("excluded_volume");
    check_room(entry, "excluded_volume", scene, count, body,
               [](const auto& b) { return b.excluded_volume; });
  }
}

}  // namespace

template <int D>
void read_body_sizes(const Config& entry, const SceneSettings<D>& scene, BodySettings<D>& body) {
  for (const char* key : {"hydrodynamic_radius", "excluded_volume"})
    if (entry.has(key) && !body.shapes.empty())
      entry.fail(key, "bodies of several sizes have several: give each size its own [[body]]");
  read_sizes(entry, scene, body.bodies(), body);
}

template <int D>
void read_molecule_sizes(const Config& entry, const SceneSettings<D>& scene,
                         MoleculeSettings<D>& molecule) {
  read_sizes(entry, scene, molecule.molecules(), molecule);
}

template void read_body_sizes<2>(const Config&, const SceneSettings<2>&, BodySettings<2>&);
template void read_body_sizes<3>(const Config&, const SceneSettings<3>&, BodySettings<3>&);
template void read_molecule_sizes<2>(const Config&, const SceneSettings<2>&, MoleculeSettings<2>&);
template void read_molecule_sizes<3>(const Config&, const SceneSettings<3>&, MoleculeSettings<3>&);

}  // namespace odpd
