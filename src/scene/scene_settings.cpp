#include "odpd/scene/scene_settings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "odpd/core/index.h"
#include "odpd/scene/body_places.h"
#include "odpd/scene/drive_keys.h"
#include "odpd/scene/spin_keys.h"
#include "odpd/scene/vector_key.h"
#include "odpd/scene/wall_keys.h"

namespace odpd {

namespace {

template <int D>
Box<D> read_box(const Config& config) {
  Box<D> box;
  box.size = read_vector<D>(config, "size");
  for (int c = 0; c < D; ++c)
    if (!(box.size[c] > 0.0)) config.fail("size", "every edge of the box must be positive");
  const std::vector<bool> periodic = config.booleans("periodic");
  if (periodic.size() != D)
    config.fail("periodic", fmt::format("{} flags are needed, there are {}", D, periodic.size()));
  for (std::size_t c = 0; c < D; ++c) box.periodic[c] = periodic[c];
  return box;
}

std::vector<SpeciesSettings> read_species(const Config& config) {
  std::vector<SpeciesSettings> species;
  for (const Config& entry : config.tables("species")) {
    SpeciesSettings s;
    s.name = entry.text("name");
    if (!is_plain_name(s.name))
      entry.fail("name", "use letters, digits, _ and -: it goes into file columns");
    for (const SpeciesSettings& other : species)
      if (other.name == s.name)
        entry.fail("name", fmt::format("species '{}' stands here twice", s.name));
    if (entry.has("count") && entry.has("fraction"))
      entry.fail("count", "give count or fraction, never both");
    if (entry.has("count")) {
      s.count = entry.integer("count");
      if (s.count < 0) entry.fail("count", "must be zero or positive");
      s.fraction = 0.0;
    } else {
      s.fraction = entry.non_negative("fraction", 1.0);
    }
    species.push_back(s);
  }
  if (species.empty()) species.emplace_back();
  double total = 0.0;
  bool by_fraction = false;
  for (const SpeciesSettings& s : species) {
    total += s.fraction;
    by_fraction = by_fraction || s.count < 0;
  }
  if (by_fraction && std::abs(total - 1.0) > 1e-9)
    config.fail("species", fmt::format("the fractions add up to {}: they must add up to 1", total));
  return species;
}

// rho = n m gives the density where mass is given, and the mass where the density n is.
double density_of_rho(const Config& fluid) {
  if (!fluid.has("mass"))
    fluid.fail("rho", "is density times mass: give two of rho, density (or count) and mass");
  const double mass = fluid.non_negative("mass");
  if (mass == 0.0)
    fluid.fail("rho", "is density times mass, so 0 at mass = 0: give density (or count) instead");
  return fluid.positive("rho") / mass;
}

double mass_of_rho(const Config& fluid, double density) {
  if (fluid.has("mass"))
    fluid.fail("rho",
               "is density times mass: give two of rho, density (or count) and mass, never three");
  return fluid.positive("rho") / density;
}

template <int D>
void read_amount(const Config& fluid, SceneSettings<D>& scene) {
  if (fluid.has("density") && fluid.has("count"))
    fluid.fail("count", "give density or count, never both");
  if (fluid.has("count")) {
    scene.count = fluid.integer("count");
    if (scene.count < 0) fluid.fail("count", "must be zero or positive");
    if (scene.count == 0 && scene.molecule_beads() == 0)
      fluid.fail("count",
                 "is 0, so no particle moves freely: give some, or a [[molecule]] to have a melt "
                 "(a scene of bodies alone is not one: densities are those of free particles)");
    return;
  }
  // What the start file must hold, or how many particles to place.
  const bool from_file = scene.start == StartKind::file;
  double& density = from_file ? scene.start_density : scene.density;
  if (fluid.has("rho") && !fluid.has("density")) {
    density = density_of_rho(fluid);
  } else if (!from_file || fluid.has("density")) {
    density = fluid.positive("density");
  }
}

std::vector<FluidKeys::Pair> read_pairs(const Config& config,
                                        const std::vector<SpeciesSettings>& species) {
  std::vector<FluidKeys::Pair> pairs;
  for (const Config& entry : config.tables("pair")) {
    const std::vector<std::string> names = entry.texts("species");
    if (names.size() != 2) entry.fail("species", "two names are needed");
    const auto numbered = [&](const std::string& name) {
      return index(species_index(species, entry, "species", name));
    };
    pairs.push_back({entry, numbered(names[0]), numbered(names[1])});
  }
  return pairs;
}

// Needs the walls and the start, as the volume of the fluid turns a count into a density.
template <int D>
void read_fluid(const Config& config, const std::optional<Calibration>& calibration,
                SceneSettings<D>& scene) {
  const Config fluid = config.table("fluid");
  read_amount(fluid, scene);
  // Without a solvent the beads are the fluid.
  const std::int64_t counted = scene.count == 0 ? scene.molecule_beads() : scene.count;
  const double density = counted > 0 ? static_cast<double>(counted) / scene.start_volume()
                         : scene.start == StartKind::file ? scene.start_density
                                                          : scene.density;
  const bool amount = fluid.has("density") || fluid.has("count");
  scene.mass =
      fluid.has("rho") && amount ? mass_of_rho(fluid, density) : fluid.non_negative("mass", 0.0);
  std::int64_t others = 0;
  if (counted > 0) others = scene.body_particles() + (scene.count > 0 ? scene.molecule_beads() : 0);
  scene.model = read_pair_model<D>({.fluid = fluid,
                                    .pairs = read_pairs(config, scene.species),
                                    .species = scene.species.size(),
                                    .density = density,
                                    .others = static_cast<double>(others) / scene.start_volume(),
                                    .mass = scene.mass,
                                    .calibration = calibration});
  const double reach = scene.model->cutoff();
  for (int c = 0; c < D; ++c)
    if (scene.box.is_periodic(c) && scene.box.size[c] < 2.0 * reach)
      config.table("box").fail(
          "size",
          fmt::format("is {} in direction {}, which is periodic: it must be at least two "
                      "cutoffs ({:.6g}), or a particle would see a neighbour twice; enlarge "
                      "it, or shorten {}",
                      scene.box.size[c], "xyz"[c], 2.0 * reach,
                      scene.model->name() == "sdpd" ? "fluid.support, which is in spacings"
                                                    : "what reaches so far"));
}

// Particles that fill space take their room from the fluid's.
template <int D>
void make_room(const Config& fluid, SceneSettings<D>& scene) {
  const auto reference = scene.model->reference_state(scene.mass);
  const std::int64_t others = scene.body_particles() + scene.molecule_beads();
  const double density = scene.start == StartKind::file ? scene.start_density : scene.density;
  if (!reference || reference->spacing == 0.0 || scene.count >= 0 || others == 0 || density == 0.0)
    return;
  scene.count = std::llround(density * scene.start_volume()) - others;
  if (scene.count < 1)
    fluid.fail("density",
               fmt::format("leaves no room for the fluid: bodies and molecules have {} particles, "
                           "the space where it starts has room for {}: use a larger box",
                           others, scene.count + others));
}

// A drag relative to the frame at rest screens flow beyond sqrt(eta/(n zeta_0)) and takes momentum away.
template <int D>
void read_drag(const Config& fluid, SceneSettings<D>& scene) {
  scene.zeta_0 = fluid.non_negative("zeta_0", 0.0);
  if (scene.zeta_0 == 0.0) return;
  const bool forced = fluid.boolean("zeta_0_under_flow", false);
  if (scene.driven() && !forced)
    fluid.fail(
        "zeta_0",
        "a uniform drag breaks momentum conservation and screens flow beyond "
        "sqrt(eta/(n zeta_0)), so it is refused where a wall or body moves or a force drives: "
        "use fluid.rattler_friction against rattlers, or insist with "
        "fluid.zeta_0_under_flow = true");
}

template <int D>
void read_start(const Config& config, SceneSettings<D>& scene) {
  const Config start = config.table("start");
  const std::string from = start.choice("from", {"random", "lattice", "file"}, "random");
  scene.start = from == "random"    ? StartKind::random
                : from == "lattice" ? StartKind::lattice
                                    : StartKind::file;
  if (scene.start == StartKind::file) {
    scene.start_file = start.file("file").string();
    if (start.has("first_species")) scene.first_species = start.integer("first_species");
  }
  // Molecules lie on top of a lattice.
  const bool overlaps = scene.start == StartKind::random ||
                        (scene.start == StartKind::lattice && !config.tables("molecule").empty());
  scene.relax_sweeps = start.integer("relax_sweeps", overlaps ? 100 : 0);
  if (scene.relax_sweeps < 0) start.fail("relax_sweeps", "must be zero or positive");
}

template <int D>
void read_place(const Config& start, SceneSettings<D>& scene) {
  if (!start.has("region")) return;
  const Config region = start.table("region");
  scene.start_region = read_start_region<D>(region);
  if (scene.start == StartKind::lattice && scene.start_region->radius > 0.0)
    region.fail("radius", "a lattice fills blocks: give from and to, or start.from = \"random\"");
}

}  // namespace

std::int32_t species_index(const std::vector<SpeciesSettings>& species, const Config& where,
                           const std::string& key, const std::string& name) {
  std::vector<std::string> names;
  for (const SpeciesSettings& s : species) names.push_back(s.name);
  for (std::size_t k = 0; k < names.size(); ++k)
    if (names[k] == name) return static_cast<std::int32_t>(k);
  where.fail(
      key, fmt::format("there is no species '{}': the scene has {}", name, fmt::join(names, ", ")));
}

template <int D>
bool SceneSettings<D>::driven() const {
  const auto moves = [](const WallSettings<D>& w) { return dot(w.velocity, w.velocity) > 0.0; };
  const auto pushed = [](const BodySettings<D>& b) {
    return b.velocity.velocity != Vec<D>{} || b.velocity.angular != Vec<D>{} ||
           b.load.force != Vec<D>{} || b.load.torque != Vec<D>{};
  };
  return (box.shear && box.shear->rate != 0.0) || largest_force() > 0.0 || start_wave.number > 0 ||
         std::any_of(walls.begin(), walls.end(), moves) ||
         std::any_of(bodies.begin(), bodies.end(), pushed);
}

template <int D>
bool SceneSettings<D>::held() const {
  return !walls.empty() || std::any_of(bodies.begin(), bodies.end(),
                                       [](const auto& b) { return b.motion != BodyMotion::free; });
}

template <int D>
bool SceneSettings<D>::loaded() const {
  return std::any_of(bodies.begin(), bodies.end(), [](const auto& b) {
    return norm(b.load.force) > 0.0 || norm(b.load.torque) > 0.0;
  });
}

template <int D>
Vec<D> SceneSettings<D>::force_at(const Vec<D>& r) const {
  Vec<D> force = force_wave.number > 0 ? force_wave.at(r, box, body_force) : body_force;
  for (const auto& region : force_regions)
    if (r[region.axis] >= region.from && r[region.axis] < region.to) force += region.force;
  return force;
}

template <int D>
bool SceneSettings<D>::forces_along(int component) const {
  const auto along = [&](const FlowWave& wave, const Vec<D>& amplitude) {
    return amplitude[component] != 0.0 ||
           (wave.shape == FlowWave::Shape::taylor_green && wave.along == component);
  };
  return along(force_wave, body_force) || along(start_wave, start_velocity) ||
         std::any_of(force_regions.begin(), force_regions.end(),
                     [&](const ForceRegion<D>& region) { return region.force[component] != 0.0; });
}

template <int D>
double SceneSettings<D>::largest_force() const {
  double force = force_wave.largest(box, body_force);
  for (const auto& region : force_regions) force += norm(region.force);
  return force;
}

template <int D>
std::int64_t SceneSettings<D>::molecule_beads() const {
  std::int64_t beads = 0;
  for (const auto& m : molecules) beads += m.molecules() * m.beads();
  return beads;
}

template <int D>
std::int64_t SceneSettings<D>::body_particles() const {
  std::int64_t particles = 0;
  for (const auto& b : bodies) particles += b.particles();
  return particles;
}

template <int D>
int SceneSettings<D>::wall_at(int axis, bool high) const {
  for (std::size_t w = 0; w < walls.size(); ++w)
    if (walls[w].axis == axis && walls[w].high == high) return static_cast<int>(w);
  return -1;
}

template <int D>
Vec<D> SceneSettings<D>::fluid_low() const {
  Vec<D> low{};
  for (const auto& wall : walls)
    if (!wall.high) low[wall.axis] = wall.thickness;
  return low;
}

template <int D>
Vec<D> SceneSettings<D>::fluid_high() const {
  Vec<D> high = box.size;
  for (const auto& wall : walls)
    if (wall.high) high[wall.axis] -= wall.thickness;
  return high;
}

template <int D>
double SceneSettings<D>::fluid_volume() const {
  return Box<D>{fluid_high() - fluid_low(), {}}.volume();
}

template <int D>
double SceneSettings<D>::start_volume() const {
  return start_region ? start_region->volume() : fluid_volume();
}

template <int D>
SceneSettings<D> read_scene_settings(const Config& config,
                                     const std::optional<Calibration>& calibration) {
  SceneSettings<D> scene;
  const std::int64_t seed = config.integer("seed", 1);
  if (seed < 0) config.fail("seed", "must be zero or positive");
  scene.seed = static_cast<std::uint64_t>(seed);
  scene.box = read_box<D>(config.table("box"));
  scene.species = read_species(config);
  read_start(config, scene);
  read_walls(config, scene);
  read_place(config.table("start"), scene);
  for (const Config& entry : config.tables("body")) {
    scene.bodies.push_back(read_body<D>(entry, scene));
    const std::string& name = scene.bodies.back().name;
    for (std::size_t k = 0; k + 1 < scene.bodies.size(); ++k)
      if (scene.bodies[k].name == name)
        entry.fail("name", fmt::format("two [[body]] are named '{}': give each a name", name));
    scene.bodies.back().species = species_index(scene.species, entry, "species",
                                                entry.text("species", scene.species[0].name));
  }
  read_molecules(config, scene);
  read_fluid(config, calibration, scene);
  read_spins(config, scene);
  complete_walls(config, scene);
  if (scene.start_region)
    check_start_region(config.table("start").table("region"), *scene.start_region,
                       scene.fluid_low(), scene.fluid_high());
  make_room(config.table("fluid"), scene);
  read_drive(config, scene);
  read_start_flow(config, scene);
  read_shear(config, scene);
  read_drag(config.table("fluid"), scene);
  check_body_positions(config, scene);
  return scene;
}

template struct SceneSettings<2>;
template struct SceneSettings<3>;
template SceneSettings<2> read_scene_settings<2>(const Config&, const std::optional<Calibration>&);
template SceneSettings<3> read_scene_settings<3>(const Config&, const std::optional<Calibration>&);

}  // namespace odpd
