#include "odpd/scene/fill.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "odpd/core/error.h"
#include "odpd/core/index.h"
#include "odpd/core/random.h"
#include "odpd/operator/edge_sums.h"
#include "odpd/scene/body_room.h"

namespace odpd {

namespace {

// Points of a regular grid over [low, high), counts per direction.
template <int D>
std::vector<Vec<D>> grid_points(const Vec<D>& low, const Vec<D>& high,
                                const std::array<std::int64_t, D>& count) {
  std::vector<Vec<D>> points(1, low);
  for (int c = 0; c < D; ++c) {
    const std::int64_t n = count[index(c)];
    std::vector<Vec<D>> next;
    next.reserve(points.size() * index(n));
    for (std::int64_t k = 0; k < n; ++k)
      for (Vec<D> point : points) {
        point[c] =
            low[c] + (high[c] - low[c]) * (static_cast<double>(k) + 0.5) / static_cast<double>(n);
        next.push_back(point);
      }
    points.swap(next);
  }
  return points;
}

// The closest to a square or cubic lattice with at least `count` points, thinned evenly to `count`.
template <int D>
std::vector<Vec<D>> lattice(const Vec<D>& low, const Vec<D>& high, std::int64_t count) {
  if (count == 0) return {};
  double spacing = std::pow(Box<D>{high - low, {}}.volume() / static_cast<double>(count), 1.0 / D);
  std::array<std::int64_t, D> n{};
  std::int64_t points = 0;
  for (; points < count; spacing *= 0.999) {
    points = 1;
    for (int c = 0; c < D; ++c) {
      n[index(c)] = std::max<std::int64_t>(
          1, static_cast<std::int64_t>(std::floor((high[c] - low[c]) / spacing + 1e-9)));
      points *= n[index(c)];
    }
  }
  const std::vector<Vec<D>> all = grid_points<D>(low, high, n);
  std::vector<Vec<D>> chosen;
  for (std::int64_t k = 0; k < count; ++k) chosen.push_back(all[index(k * points / count)]);
  return chosen;
}

template <int D>
std::vector<Vec<D>> random_points(std::uint64_t seed, const Box<D>& box,
                                  const StartRegion<D>& region, std::int64_t count,
                                  const Particles<D>& particles) {
  constexpr std::uint64_t most_attempts = 1000;
  const CounterRandom random(seed, Stream::start_positions);
  const BodyRoom<D> bodies(box, particles);
  std::vector<Vec<D>> points(index(count));
  for (std::int64_t k = 0; k < count; ++k) {
    Vec<D>& point = points[index(k)];
    for (std::uint64_t attempt = 0; attempt < most_attempts; ++attempt) {
      const auto u = random.uniforms(0, attempt, static_cast<std::uint64_t>(k), 0);
      for (int c = 0; c < D; ++c)
        point[c] = region.from[c] + (region.to[c] - region.from[c]) * u[index(c)];
      if (region.holds(point) && !bodies.holds(point)) break;
      if (attempt + 1 == most_attempts)
        throw ConfigError(
            "no room was found for the fluid: the bodies fill the space where it starts");
    }
  }
  return points;
}

// Species of `count` particles, mixed at random: exact counts first, the rest by fractions.
std::vector<std::int32_t> assign_species(const std::vector<SpeciesSettings>& species,
                                         std::uint64_t seed, std::int64_t count) {
  std::int64_t fixed = 0;
  for (const SpeciesSettings& s : species) fixed += std::max<std::int64_t>(s.count, 0);
  if (fixed > count)
    throw ConfigError(fmt::format(
        "[[species]]: the counts add up to {}, but the fluid has {} particles; lower them or "
        "raise fluid.count or fluid.density",
        fixed, count));
  const bool by_fraction =
      std::any_of(species.begin(), species.end(), [](const auto& s) { return s.count < 0; });
  if (!by_fraction && fixed != count)
    throw ConfigError(fmt::format(
        "[[species]]: the counts add up to {}, but the fluid has {} particles; make them equal "
        "or give one species a fraction",
        fixed, count));
  std::vector<std::int32_t> list;
  double share = 0.0;
  std::int64_t given = 0;
  for (std::size_t k = 0; k < species.size(); ++k) {
    std::int64_t n = species[k].count;
    if (n < 0) {
      share += species[k].fraction;
      n = std::llround(share * static_cast<double>(count - fixed)) - given;
      given += n;
    }
    list.insert(list.end(), index(n), static_cast<std::int32_t>(k));
  }
  const CounterRandom random(seed, Stream::start_species);
  for (std::size_t k = list.size(); k > 1; --k) {  // Fisher-Yates
    const double u = random.uniforms(0, 0, k, 0)[0];
    std::swap(list[k - 1], list[static_cast<std::size_t>(u * static_cast<double>(k))]);
  }
  return list;
}

// Behind a wall's surface is allowed: the wall's potential is soft, and a trajectory holds such
// positions.
template <int D>
void check_start_positions(const SceneSettings<D>& settings) {
  const Box<D>& box = settings.box;
  for (std::size_t k = 0; k < settings.start_positions.size(); ++k)
    for (int c = 0; c < D; ++c) {
      const double x = settings.start_positions[k][c];
      if (!std::isfinite(x) || (!box.is_periodic(c) && (x < 0.0 || x > box.size[c])))
        throw ConfigError(
            fmt::format("{}: particle {} lies at {} = {}, but the box reaches from 0 to {}",
                        settings.start_file, k, "xyz"[c], x, box.size[c]));
    }
}

// Of a start file, whose last particles are those of the molecules; where it gives species, they must be theirs.
template <int D>
void append_molecule_species(const SceneSettings<D>& settings, bool given,
                             std::vector<std::int32_t>& species) {
  auto next = species.size() - (given ? index(settings.molecule_beads()) : 0);
  for (const MoleculeSettings<D>& m : settings.molecules)
    for (std::int64_t n = 0; n < m.molecules(); ++n)
      for (const std::int32_t wanted : m.species) {
        if (!given) {
          species.push_back(wanted);
        } else if (species[next] != wanted) {
          throw ConfigError(fmt::format(
              "{}: particle {} has the species '{}', but it belongs to a [[molecule]] '{}', where "
              "that is '{}': the last particles of a start file are those of the molecules, in "
              "order",
              settings.start_file, next, settings.species[index(species[next])].name, m.name,
              settings.species[index(wanted)].name));
        }
        ++next;
      }
}

// With the variance kT/I, where there is a moment of inertia.
template <int D>
void draw_spins(double kT, const CounterRandom& random, Particles<D>& particles) {
  if (particles.spin_of_species.empty()) return;
  particles.carry_spins(true);
  for (std::size_t i = 0; i < particles.position.size(); ++i) {
    const double moment = particles.spin_of_species[index(particles.species[i])].moment;
    if (!particles.spins(i) || moment == 0.0) continue;
    const auto w = random.normals(0, 1, static_cast<std::uint64_t>(particles.id[i]), 0);
    for (std::size_t c = 0; c < index(rotation_components<D>); ++c)
      particles.end_spin[i].x[c] = std::sqrt(kT / moment) * w[c];
  }
}

}  // namespace

template <int D>
void place_walls(const SceneSettings<D>& settings, Particles<D>& particles) {
  for (std::size_t w = 0; w < settings.walls.size(); ++w) {
    const WallSettings<D>& wall = settings.walls[w];
    for (const WallLayer& layer : wall.layers) {
      std::array<std::int64_t, D> count{};
      for (int c = 0; c < D; ++c)
        count[index(c)] =
            c == wall.axis ? 1
            : layer.count > 0
                ? layer.count
                : std::max<std::int64_t>(1, std::llround(settings.box.size[c] / layer.spacing));
      for (Vec<D> point : grid_points<D>(Vec<D>{}, settings.box.size, count)) {
        const double from_end = wall.thickness - layer.depth;
        point[wall.axis] = wall.high ? settings.box.size[wall.axis] - from_end : from_end;
        const auto behind = [&](const WallSettings<D>& other) {
          const double x = point[other.axis];
          return other.axis != wall.axis &&
                 (other.high ? settings.box.size[other.axis] - x : x) < other.thickness;
        };
        if (wall.lattice &&
            std::any_of(settings.walls.begin(),
                        settings.walls.begin() + static_cast<std::ptrdiff_t>(w), behind))
          continue;
        particles.add(point, wall.species, Group::wall(static_cast<std::int32_t>(w)));
      }
    }
  }
}

template <int D>
void place_fluid(const SceneSettings<D>& settings, const Vec<D>& low, const Vec<D>& high,
                 Particles<D>& particles) {
  std::vector<Vec<D>> points;
  std::vector<std::int32_t> species = settings.start_species;
  const StartRegion<D> region = settings.start_region.value_or(StartRegion<D>{low, high});
  const double volume = region.volume();
  std::int64_t fluid = 0;
  if (settings.start == StartKind::file) {
    check_start_positions(settings);
    points = settings.start_positions;
    fluid = static_cast<std::int64_t>(points.size()) - settings.molecule_beads();
    const bool says = settings.count >= 0 || settings.start_density > 0.0;
    const std::int64_t said =
        settings.count >= 0 ? settings.count : std::llround(settings.start_density * volume);
    if (fluid < 0)
      throw ConfigError(
          fmt::format("{}: the start file holds {} particles, fewer than the {} of the molecules, "
                      "which must be "
                      "its last ones",
                      settings.start_file, points.size(), settings.molecule_beads()));
    if (says && said != fluid)
      throw ConfigError(fmt::format(
          "{}: the start file holds {} fluid particles, but fluid.{} asks for {}: make them agree, "
          "or leave that key out",
          settings.start_file, fluid, settings.count >= 0 ? "count" : "density", said));
  } else {
    const std::int64_t count =
        settings.count >= 0 ? settings.count : std::llround(settings.density * volume);
    if (count < 1 && settings.count < 0)
      throw ConfigError("the fluid has no particles: raise fluid.density or the box");
    if (settings.start == StartKind::lattice && !settings.bodies.empty())
      throw ConfigError(
          "start.from = \"lattice\" would put fluid inside the bodies of the scene: use "
          "\"random\", "
          "which keeps out of them, or \"file\"");
    points = settings.start == StartKind::lattice
                 ? lattice(region.from, region.to, count)
                 : random_points(settings.seed, settings.box, region, count, particles);
  }
  if (settings.start != StartKind::file) fluid = static_cast<std::int64_t>(points.size());
  const bool given = !species.empty();
  if (!given) species = assign_species(settings.species, settings.seed, fluid);
  if (settings.start == StartKind::file) append_molecule_species(settings, given, species);
  for (std::size_t k = 0; k < points.size(); ++k) {
    particles.add(points[k], species[k]);
    settings.box.wrap(particles.position.back());
  }
}

template <int D>
void relax(const Box<D>& box, const PairModel<D>& model, const Surroundings<D>& surroundings,
           std::int64_t sweeps, Particles<D>& particles) {
  if (!model.conservative()) return;
  // Random points lie in memory at random: beyond what a cache holds, every neighbour would be far away.
  constexpr std::int64_t in_cache = 20000;
  if (particles.size() > in_cache)
    particles.reorder(spatial_order<D>(box, model.cutoff(), particles.position, particles.id));
  PairList<D> list(box, model.cutoff());
  PairNetwork<D> network;
  const double longest = 0.05 * model.cutoff();
  for (std::int64_t sweep = 0; sweep < sweeps; ++sweep) {
    list.update(particles.position, particles.owned());
    model.write_edges(list, box, particles.position, particles, network);
    std::vector<Vec<D>> force(particles.position.size());
    std::vector<double> stiffness(particles.position.size(), 0.0);
    add_conservative_forces(network, force);
    surroundings.add_potential_forces(particles, particles.position, force);
    surroundings.potential_energy(particles, particles.position, stiffness);
    add_density_curvature(network, stiffness);
    for (std::size_t i = 0; i < force.size(); ++i) {
      for (const std::int32_t edge : network.edges_of(static_cast<std::int64_t>(i)))
        // Both ends of a bond move, with few other neighbours to damp it.
        stiffness[i] += (edge < network.pairs() ? 1.0 : 2.0) * network.k_c[index(edge)];
      const double size = norm(force[i]);
      if (!particles.is_free(i) || size == 0.0) continue;
      const double path = stiffness[i] > 0.0 ? std::min(size / stiffness[i], longest) : longest;
      particles.position[i] += path / size * force[i];
      box.wrap(particles.position[i]);
      surroundings.confine(particles.position[i]);
    }
  }
}

template <int D>
void draw_velocities(std::uint64_t seed, double kT, double mass, bool conserved,
                     const std::function<Vec<D>(const Vec<D>&)>& flow, Particles<D>& particles) {
  if (mass == 0.0) return;
  particles.carry_inertia();
  const CounterRandom random(seed, Stream::start_velocities);
  const Share own = particles.owned();
  std::int64_t movers = 0;
  for (std::size_t i = 0; i < particles.position.size(); ++i)
    movers += particles.is_known(i) || !own.owns(i) ? 0 : 1;
  const double share = 1.0 / static_cast<double>(own.ranks->sum(movers));
  Vec<D> mean{};
  for (std::size_t i = 0; i < particles.position.size(); ++i) {
    if (particles.is_known(i)) continue;
    const auto w = random.normals(0, 0, static_cast<std::uint64_t>(particles.id[i]), 0);
    for (std::size_t c = 0; c < D; ++c)
      particles.end_velocity[i].x[c] = std::sqrt(kT / mass) * w[c];
    if (flow) particles.end_velocity[i] += flow(particles.position[i]);
    if (own.owns(i)) mean += share * particles.end_velocity[i];
  }
  own.ranks->sum(std::span(mean.x));
  for (std::size_t i = 0; i < particles.position.size() && conserved; ++i)
    if (!particles.is_known(i)) particles.end_velocity[i] -= mean;
  draw_spins(kT, random, particles);
  // The rigid part of independent velocities has the right variance.
  std::vector<Vec<D>> arms, velocities;
  const std::vector<std::int32_t> index_of = particles.index_of_id();
  const auto end_velocity = [&](std::int64_t id) -> Vec<D>& {
    return particles.end_velocity[index(index_of[index(id)])];
  };
  for (const RigidBody<D>& body : particles.bodies) {
    if (body.known) continue;
    arms.clear();
    velocities.clear();
    for (std::size_t k = 0; k < body.members.size(); ++k) {
      arms.push_back(body.pose.orientation.turn(body.frame[k]));
      velocities.push_back(end_velocity(body.members[k]));
    }
    const RigidMotion<D> motion = rigid_motion<D>(arms, velocities);
    for (std::size_t k = 0; k < body.members.size(); ++k)
      end_velocity(body.members[k]) = motion.velocity + swing(motion.angular, arms[k]);
  }
}

template void draw_velocities<2>(std::uint64_t, double, double, bool,
                                 const std::function<Vec<2>(const Vec<2>&)>&, Particles<2>&);
template void draw_velocities<3>(std::uint64_t, double, double, bool,
                                 const std::function<Vec<3>(const Vec<3>&)>&, Particles<3>&);
template void place_walls<2>(const SceneSettings<2>&, Particles<2>&);
template void place_walls<3>(const SceneSettings<3>&, Particles<3>&);
template void place_fluid<2>(const SceneSettings<2>&, const Vec<2>&, const Vec<2>&, Particles<2>&);
template void place_fluid<3>(const SceneSettings<3>&, const Vec<3>&, const Vec<3>&, Particles<3>&);
template void relax<2>(const Box<2>&, const PairModel<2>&, const Surroundings<2>&, std::int64_t,
                       Particles<2>&);
template void relax<3>(const Box<3>&, const PairModel<3>&, const Surroundings<3>&, std::int64_t,
                       Particles<3>&);

}  // namespace odpd
