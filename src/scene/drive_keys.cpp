#include "odpd/scene/drive_keys.h"

#include <fmt/format.h>

#include <cmath>

#include "odpd/scene/vector_key.h"

namespace odpd {

namespace {

template <int D>
int read_direction(const Config& config, const std::string& key,
                   const std::optional<std::string>& fallback = {}) {
  std::vector<std::string> names;
  for (int c = 0; c < D; ++c) names.emplace_back(1, "xyz"[c]);
  return (fallback ? config.choice(key, names, *fallback) : config.choice(key, names))[0] - 'x';
}

// The wave that makes a force or a flow of `key`, of this amplitude; `does` is what a component along a sine would do.
template <int D>
FlowWave read_wave(const Config& table, const std::string& key, const Vec<D>& amplitude,
                   const Box<D>& box, const char* does) {
  const Config entry = table.table("wave");
  const bool vortices = entry.choice("shape", {"sine", "taylor-green"}, "sine") == "taylor-green";
  FlowWave wave{.along = read_direction<D>(entry, "along"),
                .number = entry.positive_integer("number", 1),
                .shape = vortices ? FlowWave::Shape::taylor_green : FlowWave::Shape::sine};
  const auto require_periodic = [&](int c) {
    if (!box.is_periodic(c))
      entry.fail("along", fmt::format("direction {} is bounded: a sine must close on itself, along "
                                      "a periodic direction",
                                      "xyz"[c]));
  };
  require_periodic(wave.along);
  if (dot(amplitude, amplitude) == 0.0)
    table.fail("wave", fmt::format("needs an amplitude: give {}", key));
  if (amplitude[wave.along] != 0.0)
    table.fail(key.substr(key.find('.') + 1),
               fmt::format("component {} points along the wave, where it {}: it must be 0{}",
                           "xyz"[wave.along], does,
                           vortices ? " (that of the vortices follows from the others)" : ""));
  if (!vortices) return wave;
  const int across = direction_of(amplitude);
  require_periodic(across);
  for (int c = across + 1; c < D; ++c)
    if (amplitude[c] != 0.0)
      table.fail(
          key.substr(key.find('.') + 1),
          "vortices of a plane have one amplitude: give one component and leave the others 0");
  return wave;
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

// Bodies that are held fix the frame in which the images slide.
template <int D>
void check_bodies_under_shear(const Config& config, const SceneSettings<D>& scene,
                              const Shear& shear) {
  for (std::size_t k = 0; k < scene.bodies.size(); ++k) {
    const Config entry = config.tables("body")[k];
    if (scene.bodies[k].velocity.velocity[shear.gradient] != 0.0)
      entry.fail("velocity",
                 fmt::format("a body of given motion along {}, the gradient of [shear], would "
                             "cross the sliding faces, behind which it has another velocity: set "
                             "that component to 0, or let a force move the body",
                             "xyz"[shear.gradient]));
    if (scene.bodies[k].motion != BodyMotion::free && scene.mass > 0.0)
      entry.fail("motion",
                 "a held body under [shear] sets the place where the flow is at rest, and a fluid "
                 "with mass starts with that of mid-box: set fluid.mass = 0.0, or let the body "
                 "move freely");
  }
}

}  // namespace

template <int D>
void read_drive(const Config& config, SceneSettings<D>& scene) {
  const Config body_force = config.table("body_force");
  scene.body_force = read_optional_vector<D>(body_force, "force");
  if (body_force.has("wave"))
    scene.force_wave = read_wave(body_force, "body_force.force", scene.body_force, scene.box,
                                 "drives no flow but compresses");
  for (const Config& entry : body_force.tables("region"))
    scene.force_regions.push_back(read_region(entry, scene.box));
  if (scene.held() || norm(net_force(scene)) <= 1e-9 * scene.largest_force()) return;
  body_force.fail(
      scene.force_regions.empty() ? "force" : "region",
      "in a fully periodic box nothing balances a net force, so a massless fluid has no answer "
      "and one with mass accelerates for ever: add walls, or remove the force, or let it add up to "
      "nothing (body_force.wave, or two regions that oppose each other)");
}

template <int D>
void read_start_flow(const Config& config, SceneSettings<D>& scene) {
  const Config start = config.table("start");
  if (!start.has("velocity") && !start.has("wave")) return;
  const char* key = start.has("velocity") ? "velocity" : "wave";
  if (scene.mass == 0.0)
    start.fail(key,
               "without mass velocities follow from the forces of the moment, and none is left of "
               "those at the start: set fluid.mass, or drive the flow by body_force.wave");
  if (config.has("shear"))
    start.fail(key, "[shear] gives particles with mass its own flow at the start: leave it out");
  scene.start_velocity = read_optional_vector<D>(start, "velocity");
  if (!start.has("wave"))
    start.fail(
        "velocity",
        "is the amplitude of a wave: give start.wave, e.g. { shape = \"taylor-green\", along "
        "= \"y\" }");
  scene.start_wave = read_wave(start, "start.velocity", scene.start_velocity, scene.box,
                               "is no flow but compresses");
}

template <int D>
void read_shear(const Config& config, SceneSettings<D>& scene) {
  if (!config.has("shear")) return;
  const Config entry = config.table("shear");
  Shear shear;
  const auto read_periodic = [&](const std::string& key, const std::string& fallback) {
    const int c = read_direction<D>(entry, key, fallback);
    if (!scene.box.is_periodic(c))
      entry.fail(key, fmt::format("direction {} is bounded: sliding images need it periodic "
                                  "(box.periodic); between walls give a [[wall]] a velocity",
                                  "xyz"[c]));
    return c;
  };
  shear.flow = read_periodic("flow", "x");
  shear.gradient = read_periodic("gradient", "y");
  if (shear.flow == shear.gradient)
    entry.fail("gradient", "the flow varies across another direction than its own");
  shear.rate = entry.number("rate");
  shear.frequency = entry.non_negative("frequency", 0.0);
  if (!scene.walls.empty())
    entry.fail("rate",
               "sliding images would tear a [[wall]] apart: make its direction periodic, or leave "
               "[shear] out and give walls a velocity");
  check_bodies_under_shear(config, scene, shear);
  if (scene.largest_force() > 0.0)
    config.table("body_force")
        .fail("force",
              "a force adds to the flow that [shear] imposes and, where it varies, differs between "
              "sliding images: leave one of the two out");
  if (shear.frequency > 0.0 && scene.mass > 0.0)
    entry.fail("frequency",
               "with mass an oscillation spreads from the sliding faces instead of being uniform: "
               "set fluid.mass = 0.0, or frequency = 0.0");
  if (config.table("fluid").non_negative("zeta_0", 0.0) > 0.0)
    config.table("fluid").fail(
        "zeta_0",
        "a drag relative to the frame at rest differs between the sliding images of a particle: "
        "leave it out under [shear] (against rattlers use fluid.rattler_friction)");
  scene.box.shear = shear;
  scene.box = scene.box.at(0.0);
}

template void read_drive<2>(const Config&, SceneSettings<2>&);
template void read_drive<3>(const Config&, SceneSettings<3>&);
template void read_start_flow<2>(const Config&, SceneSettings<2>&);
template void read_start_flow<3>(const Config&, SceneSettings<3>&);
template void read_shear<2>(const Config&, SceneSettings<2>&);
template void read_shear<3>(const Config&, SceneSettings<3>&);

}  // namespace odpd
