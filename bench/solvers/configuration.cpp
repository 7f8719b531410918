#include "configuration.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "odpd/core/error.h"
#include "odpd/core/random.h"
#include "odpd/core/timer.h"
#include "odpd/dynamics/integrator.h"
#include "odpd/pairs/dpd.h"

namespace bench {

using odpd::Vec;

namespace {

/// An obstacle that moves along x.
template <int D>
class Obstacle : public odpd::NoSurroundings<D> {
 public:
  Vec<D> known_velocity(odpd::Group, double) const override {
    Vec<D> v;
    v[0] = 1.0;
    return v;
  }
};

template <int D>
void add_walls(odpd::SceneSettings<D>& s) {
  s.box.size[D - 1] += 2.0;
  s.box.periodic[D - 1] = false;
  for (const bool high : {false, true}) {
    odpd::WallSettings<D> wall;
    wall.axis = D - 1;
    wall.high = high;
    wall.velocity[0] = high ? 1.0 : 0.0;
    for (const double depth : {0.0, 0.5})
      wall.layers.push_back({.depth = depth, .count = 0, .spacing = D == 2 ? 0.25 : 0.5});
    s.walls.push_back(wall);
  }
}

std::int64_t copies(std::int64_t parts, int directions) {
  std::int64_t n = 1;
  for (int c = 0; c < directions; ++c) n *= parts;
  return n;
}

/// Into how many parts each periodic direction is cut, so that the base box is small.
template <int D>
std::int64_t parts_of(const FluidSpec& spec) {
  const int directions = spec.walls ? D - 1 : D;
  for (std::int64_t parts = 1; parts <= 200; ++parts) {
    const std::int64_t n = copies(parts, directions);
    if (spec.particles % n == 0 && spec.particles / n <= largest_base) return parts;
  }
  throw odpd::ConfigError(fmt::format(
      "--sizes {}: no box of at most {} particles makes this number by copies in {} directions: "
      "take a power of ten",
      spec.particles, largest_base, directions));
}

/// The free particles' positions after `steps` steps in the base box.
template <int D>
std::vector<Vec<D>> stepped(odpd::SceneSettings<D> settings, std::int64_t steps) {
  settings.zeta_0 = 1.0;
  odpd::Scene<D> scene(std::move(settings));
  odpd::Dynamics<D> dynamics(scene.box(), scene.particles(), scene.model(), scene,
                             odpd::make_solver({.name = "pcg", .tolerance = 1e-3}), {.seed = seed});
  const auto integrator = odpd::make_integrator<D>("trapezoidal");
  odpd::Clock clock{.dt = time_step, .total_steps = steps};
  for (; !clock.finished(); clock.advance()) integrator->step(dynamics, clock);
  std::vector<Vec<D>> positions;
  for (std::size_t i = 0; i < scene.particles().position.size(); ++i)
    if (scene.particles().is_free(i)) positions.push_back(scene.particles().position[i]);
  return positions;
}

/// Copies along the periodic directions, jittered.
template <int D>
std::vector<Vec<D>> replicated(const std::vector<Vec<D>>& base, const odpd::Box<D>& box,
                               const odpd::Box<D>& whole, std::int64_t parts) {
  const odpd::CounterRandom random(seed, odpd::Stream::probe);
  std::vector<Vec<D>> positions;
  const std::int64_t n = copies(parts, box.periodic_directions());
  for (std::int64_t copy = 0; copy < n; ++copy)
    for (Vec<D> r : base) {
      const auto u = random.uniforms(0, 0, positions.size(), 0);
      std::int64_t rest = copy;
      for (int c = 0; c < D; ++c) {
        r[c] += 0.06 * (u[static_cast<std::size_t>(c)] - 0.5);
        if (!box.is_periodic(c)) continue;
        r[c] += static_cast<double>(rest % parts) * box.size[c];
        rest /= parts;
      }
      whole.wrap(r);
      positions.push_back(r);
    }
  return positions;
}

/// The free particles next to the middle of the fluid get a known velocity.
template <int D>
void hold_middle(std::int64_t count, odpd::Scene<D>& scene) {
  odpd::Particles<D>& particles = scene.particles();
  std::vector<std::size_t> order(particles.position.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const Vec<D> middle = 0.5 * scene.box().size;
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return norm(particles.position[a] - middle) < norm(particles.position[b] - middle);
  });
  for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k)
    particles.group[order[k]] = odpd::Group::wall(0);
}

}  // namespace

template <int D>
odpd::SceneSettings<D> scene_settings(const FluidSpec& spec, std::int64_t parts) {
  odpd::SceneSettings<D> s;
  s.seed = seed;
  odpd::DpdParameters p{.s = spec.s};
  if (spec.far_friction) {
    p.gamma_far = 0.1;
    p.cutoff_far = 1.5;
  }
  s.model = odpd::make_dpd<D>(p);
  const double volume = static_cast<double>(spec.particles) / spec.density;
  const double edge =
      spec.thin > 0.0 ? std::pow(volume / spec.thin, 1.0 / (D - 1)) : std::pow(volume, 1.0 / D);
  for (int c = 0; c < D; ++c) s.box.size[c] = c == 0 && spec.thin > 0.0 ? spec.thin : edge;
  for (int c = 0; c < (spec.walls ? D - 1 : D); ++c) s.box.size[c] /= static_cast<double>(parts);
  if (spec.gap) s.box.size[spec.walls ? D - 1 : 0] *= 1.5;
  s.box.periodic.fill(true);
  s.count = spec.particles / copies(parts, spec.walls ? D - 1 : D);
  if (spec.walls) add_walls(s);
  return s;
}

template <int D>
std::vector<Vec<D>> equilibrated(const FluidSpec& spec, std::int64_t steps) {
  const std::int64_t parts = parts_of<D>(spec);
  const odpd::SceneSettings<D> base = scene_settings<D>(spec, parts);
  const std::vector<Vec<D>> positions = stepped(base, steps);
  if (parts == 1) return positions;
  return replicated(positions, base.box, scene_settings<D>(spec).box, parts);
}

template <int D>
std::unique_ptr<odpd::Scene<D>> scene_at(const FluidSpec& spec,
                                         const std::vector<Vec<D>>& positions) {
  odpd::SceneSettings<D> settings = scene_settings<D>(spec);
  settings.start = odpd::StartKind::file;
  settings.start_positions = positions;
  settings.relax_sweeps = 0;
  return std::make_unique<odpd::Scene<D>>(std::move(settings));
}

template <int D>
Problem<D>::Problem(const FluidSpec& fluid, const std::vector<Vec<D>>& positions)
    : spec(fluid), scene(scene_at<D>(fluid, positions)), resistance(scene->box()) {
  if (spec.obstacle > 0) {
    hold_middle(spec.obstacle, *scene);
    surroundings = std::make_unique<Obstacle<D>>();
  }
  const odpd::Surroundings<D>& around = surroundings ? *surroundings : *scene;
  dynamics = std::make_unique<odpd::Dynamics<D>>(scene->box(), scene->particles(), scene->model(),
                                                 around, odpd::make_solver({}),
                                                 odpd::DynamicsSettings{.seed = seed});
  dynamics->reorder_if_due(0);
  dynamics->evaluate(scene->particles().position, 0.0, stage);
  std::vector<Vec<D>> edge_noise;
  load = dynamics->draw_noise(stage, 0, time_step, edge_noise);
  const std::vector<double> force = dynamics->force(stage);
  for (std::size_t k = 0; k < load.size(); ++k) load[k] += force[k];
}

template <int D>
double Problem<D>::rebuild() {
  const odpd::Stopwatch watch;
  resistance.rebuild(stage.network, dynamics->dofs(), scene->particles(), stage.position,
                     spec.shift, stiffness_time);
  return watch.seconds();
}

template <int D>
double Problem<D>::neighbours() {
  const odpd::DofMap<D>& dofs = dynamics->dofs();
  std::int64_t ends = 0;
  for (std::size_t k = 0; k < stage.network.i.size(); ++k) {
    const bool free = dofs.mobile_of(static_cast<std::size_t>(stage.network.i[k])) >= 0 &&
                      dofs.mobile_of(static_cast<std::size_t>(stage.network.j[k])) >= 0;
    ends += free ? 2 : 0;
  }
  return static_cast<double>(ends) / static_cast<double>(dofs.nodes());
}

#define ODPD_INSTANTIATE(D)                                                          \
  template odpd::SceneSettings<D> scene_settings<D>(const FluidSpec&, std::int64_t); \
  template std::vector<Vec<D>> equilibrated<D>(const FluidSpec&, std::int64_t);      \
  template std::unique_ptr<odpd::Scene<D>> scene_at<D>(const FluidSpec&,             \
                                                       const std::vector<Vec<D>>&);  \
  template class Problem<D>;
ODPD_INSTANTIATE(2)
ODPD_INSTANTIATE(3)
#undef ODPD_INSTANTIATE

}  // namespace bench
