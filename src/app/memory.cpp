#include "odpd/app/memory.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <numbers>

#include "odpd/core/error.h"

namespace odpd {

namespace {

constexpr std::array<double, 2> bytes_per_particle{1350.0, 2400.0}, bytes_per_edge{190.0, 205.0};
constexpr std::array<double, 2> unit_ball{std::numbers::pi, 4.0 * std::numbers::pi / 3.0};

// As place_walls makes them.
template <int D>
double wall_particles(const SceneSettings<D>& scene) {
  double sum = 0.0;
  for (const WallSettings<D>& wall : scene.walls)
    for (const WallLayer& layer : wall.layers) {
      double particles = 1.0;
      for (int c = 0; c < D; ++c)
        if (c != wall.axis)
          particles *= layer.count > 0
                           ? static_cast<double>(layer.count)
                           : std::max(1.0, std::round(scene.box.size[c] / layer.spacing));
      sum += particles;
    }
  return sum;
}

std::string in_units(double bytes) {
  constexpr std::array<const char*, 5> units{"MiB", "GiB", "TiB", "PiB", "EiB"};
  double value = bytes / (1024.0 * 1024.0);
  std::size_t unit = 0;
  for (; value >= 1024.0 && unit + 1 < units.size(); ++unit) value /= 1024.0;
  return fmt::format("{:.3g} {}", value, units[unit]);
}

// The limit of this process and the machine's own; infinite where it has none.
double process_limit() {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY)
    return std::numeric_limits<double>::infinity();
  return static_cast<double>(limit.rlim_cur);
}

double machine_limit() {
  std::ifstream file("/proc/meminfo");
  double bytes = 0.0, kibibytes = 0.0;
  for (std::string name, unit; file >> name >> kibibytes; std::getline(file, unit))
    if (name == "MemTotal:" || name == "SwapTotal:") bytes += 1024.0 * kibibytes;
  return bytes > 0.0 ? bytes : std::numeric_limits<double>::infinity();
}

}  // namespace

template <int D>
MemoryNeed memory_need(const SceneSettings<D>& scene) {
  constexpr std::size_t d = D - 2;
  struct Part {
    double particles;
    std::string keys;
  };
  const bool file = scene.start == StartKind::file;
  double in_bodies = 0.0;
  for (const BodySettings<D>& body : scene.bodies)
    in_bodies += static_cast<double>(body.bodies()) * static_cast<double>(body.shape.size());
  double in_molecules = 0.0;
  for (const MoleculeSettings<D>& m : scene.molecules)
    in_molecules += static_cast<double>(m.molecules()) * static_cast<double>(m.beads());
  const double volume = scene.fluid_volume();
  const std::array<Part, 4> shares{
      {{file               ? static_cast<double>(scene.start_positions.size())
        : scene.count >= 0 ? static_cast<double>(scene.count)
                           : scene.density * volume,
        file               ? "take fewer particles into start.file"
        : scene.count >= 0 ? "lower fluid.count"
                           : "lower fluid.density or box.size"},
       {wall_particles(scene), "raise the spacing or lower the count of wall.layers"},
       {in_bodies, "lower body.count, or the particles of its shape"},
       {file ? 0.0 : in_molecules, "lower molecule.count or the beads of it"}}};
  MemoryNeed need;
  for (const Part& share : shares) need.particles += share.particles;
  need.keys = std::max_element(shares.begin(), shares.end(), [](const Part& a, const Part& b) {
                return a.particles < b.particles;
              })->keys;
  const double r_c = scene.model->cutoff();
  need.edges = 0.5 * need.particles * need.particles / volume * unit_ball[d] * std::pow(r_c, D);
  // Position and velocity, image, identity, species and group.
  need.least = need.particles * (2.0 * sizeof(Vec<D>) + D * sizeof(std::int32_t) + 16.0);
  need.bytes = bytes_per_particle[d] * need.particles + bytes_per_edge[d] * need.edges;
  return need;
}

double memory_limit() { return std::min(process_limit(), machine_limit()); }

std::string memory_text(const MemoryNeed& need) {
  return fmt::format(
      "not enough memory: {:.6g} particles with about {:.2g} edges between them need about {}, and "
      "there is {} ({}): {}",
      need.particles, need.edges, in_units(need.bytes), in_units(memory_limit()),
      process_limit() < machine_limit() ? "ulimit -v" : "of the machine, with swap", need.keys);
}

template <int D>
void check_memory(const SceneSettings<D>& scene) {
  const MemoryNeed need = memory_need(scene);
  if (need.least > memory_limit()) throw Error(memory_text(need), 2);
}

template MemoryNeed memory_need<2>(const SceneSettings<2>&);
template MemoryNeed memory_need<3>(const SceneSettings<3>&);
template void check_memory<2>(const SceneSettings<2>&);
template void check_memory<3>(const SceneSettings<3>&);

}  // namespace odpd
