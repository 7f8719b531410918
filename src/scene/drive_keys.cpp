#include "odpd/scene/drive_keys.h"

#include <fmt/format.h>

#include <cmath>

#include "odpd/scene/vector_key.h"

namespace odpd {

namespace {

template <int D>
int read_direction(const Config& config, const std::string& key) {
  std::vector<std::string> names;
  for (int c = 0; c < D; ++c) names.emplace_back(1, "xyz"[c]);
  return config.choice(key, names)[0] - 'x';
}

template <int D>
void read_wave(const Config& body_force, SceneSettings<D>& scene) {
  if (!body_force.has("wave")) return;
  const Config wave = body_force.table("wave");
  const int along = read_direction<D>(wave, "along");
  scene.force_wave = {along, wave.positive_integer("number", 1)};
  if (!scene.box.is_periodic(along))
    wave.fail("along", fmt::format("direction {} is bounded: a sine must close on itself, along a "
                                   "periodic direction",
                                   "xyz"[along]));
  if (dot(scene.body_force, scene.body_force) == 0.0)
    body_force.fail("wave", "needs an amplitude: give body_force.force");
  if (scene.body_force[along] != 0.0)
    body_force.fail("force",
                    fmt::format("component {} points along the wave, where it drives no flow but "
                                "compresses: it must be 0",
                                "xyz"[along]));
}

template <int D>
ForceRegion<D> read_region(const Config& entry, const Box<D>& box) {
  ForceRegion<D> region;
  region.axis = read_direction<D>(entry, "axis");
  region.from = entry.non_negative("from");
  region.to = entry.positive("to");
  region.force = read_vector<D>(entry, "force");
  if (region.to <= region.from) entry.fail("to", "must be larger than from");
  if (region.to > box.size[region.axis])
    entry.fail("to", fmt::format("lies outside the box, whose edge is {}", box.size[region.axis]));
  return region;
}

/// Mean force per particle of an even fluid.
template <int D>
Vec<D> net_force(const SceneSettings<D>& scene) {
  Vec<D> net = scene.force_wave.number > 0 ? Vec<D>{} : scene.body_force;
  for (const auto& region : scene.force_regions)
    net += ((region.to - region.from) / scene.box.size[region.axis]) * region.force;
  return net;
}

}  // namespace

template <int D>
void read_drive(const Config& config, SceneSettings<D>& scene) {
  const Config body_force = config.table("body_force");
  scene.body_force = read_optional_vector<D>(body_force, "force");
  read_wave(body_force, scene);
  for (const Config& entry : body_force.tables("region"))
    scene.force_regions.push_back(read_region(entry, scene.box));
  if (scene.held() || norm(net_force(scene)) <= 1e-9 * scene.largest_force()) return;
  body_force.fail(
      scene.force_regions.empty() ? "force" : "region",
      "in a fully periodic box nothing balances a net force, so a massless fluid has no answer "
      "and one with mass accelerates for ever: add walls, or remove the force, or let it add up to "
      "nothing (body_force.wave, or two regions that oppose each other)");
}

template void read_drive<2>(const Config&, SceneSettings<2>&);
template void read_drive<3>(const Config&, SceneSettings<3>&);

}  // namespace odpd
