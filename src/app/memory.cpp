#include "odpd/app/memory.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <limits>

#include "odpd/core/error.h"

namespace odpd {

namespace {

// In 2D and 3D. The program and its libraries; then what grows, with free bodies more.
constexpr double bytes_at_first = 45e6, bytes_per_body = 250.0;
constexpr std::array<double, 2> bytes_per_particle{1110.0, 1980.0}, bytes_per_edge{204.0, 230.0};
constexpr std::array<double, 2> more_per_particle{65.0, 110.0}, bytes_per_constituent{150.0, 60.0};
constexpr std::array<double, 2> bytes_per_lever{300.0, 380.0};
// Of larger bodies inner pairs count as edges: to look at all would take longer than a moment.
constexpr std::size_t most_constituents = 4000;

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

// Pairs inside a body that would be edges in a fluid.
template <int D>
double inner_pairs(const std::vector<Vec<D>>& shape, double cutoff) {
  if (shape.size() > most_constituents) return 0.0;
  double pairs = 0.0;
  for (std::size_t i = 0; i < shape.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) pairs += norm(shape[i] - shape[j]) < cutoff ? 1.0 : 0.0;
  return pairs;
}

// Part of the fluid's particles that spins.
double spinning_part(const std::vector<SpeciesSettings>& species, double particles) {
  double part = 0.0;
  for (const SpeciesSettings& s : species)
    if (s.lever_radius > 0.0)
      part += s.count < 0 ? s.fraction : static_cast<double>(s.count) / std::max(particles, 1.0);
  return std::min(part, 1.0);
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
double run_bytes(const RunSize& size) {
  constexpr std::size_t d = D - 2;
  const double per_particle =
      bytes_per_particle[d] + (size.bodies > 0.0 ? more_per_particle[d] : 0.0);
  return bytes_at_first + per_particle * size.particles + bytes_per_edge[d] * size.edges +
         bytes_per_body * size.bodies + bytes_per_constituent[d] * size.constituents +
         bytes_per_lever[d] * size.levers;
}

template <int D>
MemoryNeed memory_need(const SceneSettings<D>& scene) {
  struct Part {
    double particles;
    std::string keys;
  };
  const bool file = scene.start == StartKind::file;
  const double r_c = scene.model->cutoff();
  MemoryNeed need;
  double in_bodies = 0.0, within_bodies = 0.0;
  for (const BodySettings<D>& body : scene.bodies) {
    const double bodies = static_cast<double>(body.bodies());
    const auto constituents = static_cast<double>(body.particles());
    in_bodies += constituents;
    if (body.shapes.empty()) within_bodies += bodies * inner_pairs(body.shape, r_c);
    for (const auto& shape : body.shapes) within_bodies += inner_pairs(shape, r_c);
    if (body.motion != BodyMotion::free) continue;
    need.size.bodies += bodies;
    need.size.constituents += constituents;
  }
  double in_molecules = 0.0;
  for (const MoleculeSettings<D>& m : scene.molecules)
    in_molecules += static_cast<double>(m.molecules()) * static_cast<double>(m.beads());
  const double volume = scene.start_volume();
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
  double& n = need.size.particles;
  for (const Part& share : shares) n += share.particles;
  need.keys = std::max_element(shares.begin(), shares.end(), [](const Part& a, const Part& b) {
                return a.particles < b.particles;
              })->keys;
  const double pairs = 0.5 * n * n / volume * unit_ball_volume<D> * std::pow(r_c, D);
  need.size.edges = std::max(0.0, pairs - within_bodies);
  const double still = 1.0 - spinning_part(scene.species, shares[0].particles);
  need.size.levers = need.size.edges * (1.0 - still * still);
  // Position and velocity, image, identity, species and group.
  need.least = n * (2.0 * sizeof(Vec<D>) + D * sizeof(std::int32_t) + 16.0);
  need.bytes = run_bytes<D>(need.size);
  return need;
}

double memory_limit() { return std::min(process_limit(), machine_limit()); }

std::string memory_text(const MemoryNeed& need) {
  return fmt::format(
      "not enough memory: {:.6g} particles with about {:.2g} edges between them need about {}, and "
      "there is {} ({}): {}",
      need.size.particles, need.size.edges, in_units(need.bytes), in_units(memory_limit()),
      process_limit() < machine_limit() ? "ulimit -v" : "of the machine, with swap", need.keys);
}

template <int D>
void check_memory(const SceneSettings<D>& scene) {
  const MemoryNeed need = memory_need(scene);
  if (need.least > memory_limit()) throw Error(memory_text(need), 2);
}

template double run_bytes<2>(const RunSize&);
template double run_bytes<3>(const RunSize&);
template MemoryNeed memory_need<2>(const SceneSettings<2>&);
template MemoryNeed memory_need<3>(const SceneSettings<3>&);
template void check_memory<2>(const SceneSettings<2>&);
template void check_memory<3>(const SceneSettings<3>&);

}  // namespace odpd
