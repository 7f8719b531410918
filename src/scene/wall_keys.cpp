#include "odpd/scene/wall_keys.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "odpd/core/index.h"
#include "odpd/core/log.h"
#include "odpd/scene/vector_key.h"

namespace odpd {

namespace {

template <int D>
std::vector<WallLayer> read_layers(const Config& wall) {
  std::vector<WallLayer> layers;
  for (const Config& entry : wall.tables("layers")) {
    WallLayer layer;
    layer.depth = entry.non_negative("depth");
    if (entry.has("count") == entry.has("spacing"))
      entry.fail("count", "give count or spacing, one of them");
    if (entry.has("count")) {
      layer.count = entry.integer("count");
      if (layer.count < 1) entry.fail("count", "must be positive");
      constexpr int tangential = D - 1;
      if (tangential > 1)
        entry.fail("count", "a layer of this wall is a grid: give spacing instead");
    } else {
      layer.spacing = entry.positive("spacing");
    }
    layers.push_back(layer);
  }
  return layers;
}

template <int D>
void check_thickness(const Config& entry, const Box<D>& box, const WallSettings<D>& wall) {
  if (wall.thickness >= 0.5 * box.size[wall.axis])
    entry.fail("thickness",
               fmt::format("{:.6g} is half of the box or more: nothing is left for the fluid",
                           wall.thickness));
}

template <int D>
WallSettings<D> read_wall(const Config& entry, const SceneSettings<D>& scene) {
  std::vector<std::string> sides;
  for (int c = 0; c < D; ++c)
    for (const char end : {'-', '+'}) sides.push_back(fmt::format("{}{}", "xyz"[c], end));
  const std::string side = entry.choice("side", sides);
  WallSettings<D> wall;
  wall.axis = side[0] - 'x';
  wall.high = side[1] == '+';
  if (scene.box.is_periodic(wall.axis))
    entry.fail("side", fmt::format("direction {} is periodic (box.periodic): a wall contradicts it",
                                   side[0]));
  if (scene.wall_at(wall.axis, wall.high) >= 0)
    entry.fail("side", fmt::format("there are two walls at {}", side));
  wall.thickness = entry.positive("thickness", wall.thickness);
  if (entry.has("thickness")) check_thickness(entry, scene.box, wall);
  wall.velocity = read_optional_vector<D>(entry, "velocity");
  if (wall.velocity[wall.axis] != 0.0)
    entry.fail("velocity",
               fmt::format("a wall moves along itself: component {} must be 0", side[0]));
  for (int c = 0; c < D; ++c)
    if (wall.velocity[c] != 0.0 && !scene.box.is_periodic(c))
      entry.fail(
          "velocity",
          fmt::format("a wall that moves in direction {} needs that direction periodic", "xyz"[c]));
  wall.layers = read_layers<D>(entry);
  wall.species =
      species_index(scene.species, entry, "species", entry.text("species", scene.species[0].name));
  wall.stiffness = entry.positive("stiffness", wall.stiffness);
  return wall;
}

// Layers of a lattice of the number density `reference` that is even along the wall and fills it from half a layer behind the
// surface on.
template <int D>
void fill_wall(const ReferenceState& reference, double reach, bool thick, const Box<D>& box,
               WallSettings<D>& wall) {
  double across = 1.0 / reference.density;
  for (int c = 0; c < D; ++c)
    if (c != wall.axis)
      across /= box.size[c] / std::max(1.0, std::round(box.size[c] / reference.spacing));
  const double count =
      thick ? std::max(1.0, std::round(wall.thickness / across)) : std::ceil(reach / across - 1e-9);
  if (!thick) wall.thickness = count * across;
  wall.lattice = true;
  for (double k = 0.5; k < count; ++k)
    wall.layers.push_back({.depth = k * wall.thickness / count, .spacing = reference.spacing});
}

// Where the fluid's density has less than the reach of the sum behind the surface, it misses neighbours there.
template <int D>
void warn_of_thin_wall(const WallSettings<D>& wall, const std::string& side, double reach,
                       double spacing) {
  double deepest = 0.0;
  for (const WallLayer& layer : wall.layers) deepest = std::max(deepest, layer.depth);
  // A layer stands for half a spacing to either side.
  if (deepest + 0.51 * spacing < reach)
    log_warning(
        fmt::format("the wall at {} has particles down to {:.3g} behind its surface, and densities "
                    "reach {:.3g}: "
                    "what is near it misses neighbours and crowds there. Leave layers and "
                    "thickness out to have "
                    "a wall that is thick enough (docs/density-fluids.md)",
                    side, deepest, reach));
}

template <int D>
void complete_wall(const Config& entry, const Config& fluid, SceneSettings<D>& scene,
                   WallSettings<D>& wall) {
  const auto reference = scene.model->reference_state(scene.mass);
  const double spacing = reference ? reference->spacing : 0.0, reach = scene.model->cutoff();
  if (wall.layers.empty()) {
    if (spacing == 0.0)
      entry.fail("layers",
                 "a wall needs at least one layer of frozen particles, e.g. layers = [{ depth = "
                 "0.0, spacing = 0.2 }]: "
                 "without their friction nothing holds a massless fluid");
    const bool thick = entry.has("thickness");
    if (!thick && fluid.has("count"))
      entry.fail("thickness",
                 "is needed with fluid.count, as the density follows from both: give it, or "
                 "fluid.density");
    fill_wall(*reference, reach, thick, scene.box, wall);
  }
  check_thickness(entry, scene.box, wall);
  for (const WallLayer& layer : wall.layers)
    if (layer.depth > wall.thickness)
      entry.fail("layers", fmt::format("a layer of depth {} lies outside the box: depth must be at "
                                       "most thickness = {}",
                                       layer.depth, wall.thickness));
  if (spacing == 0.0) return;
  if (!entry.has("stiffness"))
    wall.stiffness = 5.0 * reference->bulk_modulus * std::pow(spacing, D - 2);
  warn_of_thin_wall(wall, entry.text("side"), reach, spacing);
}

}  // namespace

template <int D>
void read_walls(const Config& config, SceneSettings<D>& scene) {
  for (const Config& entry : config.tables("wall")) scene.walls.push_back(read_wall(entry, scene));
  for (int c = 0; c < D; ++c)
    for (const bool high : {false, true})
      if (!scene.box.is_periodic(c) && scene.wall_at(c, high) < 0)
        config.table("box").fail(
            "periodic",
            fmt::format("direction {} is bounded but has no wall at its {} end: add "
                        "[[wall]] with side = \"{}{}\", or make it periodic",
                        "xyz"[c], high ? "upper" : "lower", "xyz"[c], high ? '+' : '-'));
}

template <int D>
void complete_walls(const Config& config, SceneSettings<D>& scene) {
  const std::vector<Config> entries = config.tables("wall");
  for (std::size_t w = 0; w < entries.size(); ++w)
    complete_wall(entries[w], config.table("fluid"), scene, scene.walls[w]);
}

template void read_walls<2>(const Config&, SceneSettings<2>&);
template void read_walls<3>(const Config&, SceneSettings<3>&);
template void complete_walls<2>(const Config&, SceneSettings<2>&);
template void complete_walls<3>(const Config&, SceneSettings<3>&);

}  // namespace odpd
