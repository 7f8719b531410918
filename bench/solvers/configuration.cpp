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
#include "odpd/pairs/sdpd.h"
#include "odpd/scene/fill.h"

namespace bench {

using odpd::Vec;

namespace {

constexpr std::int64_t sheared_steps = 20;  // to a strain of 0.2 at a rate of 2

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

/// Into how many parts each periodic direction is cut, so that the base box is small, but holds its bodies.
template <int D>
std::int64_t parts_of(const FluidSpec& spec) {
  const int directions = spec.walls ? D - 1 : D;
  std::int64_t parts = 1;
  const auto made_of = [&](std::int64_t k) { return spec.particles % copies(k, directions) == 0; };
  while (parts <= 200 &&
         !(made_of(parts) && spec.particles / copies(parts, directions) <= largest_base))
    ++parts;
  if (parts > 200)
    throw odpd::ConfigError(fmt::format(
        "--sizes {}: no box of at most {} particles makes this number by copies in {} directions: "
        "take a power of ten",
        spec.particles, largest_base, directions));
  if (!spec.bodies) return parts;
  for (; parts > 1; --parts) {
    if (!made_of(parts)) continue;
    try {
      suspend<D>(*spec.bodies, spec.particles / copies(parts, directions), spec.density, spec.thin,
                 seed);
      return parts;
    } catch (const odpd::ConfigError&) {  // in a larger box they may fit
    }
  }
  return 1;
}

/// SDPD with kappa = 100 and K dt/eta = 0.2.
template <int D>
std::shared_ptr<const odpd::PairModel<D>> sdpd_model(const FluidSpec& spec) {
  const double K = 100.0 * spec.density, eta = 5.0 * K * time_step;
  const auto friction =
      spec.classical ? odpd::SdpdFriction::classical(eta, D) : odpd::SdpdFriction::central(eta, D);
  return std::make_shared<const odpd::SdpdModel<D>>(
      odpd::SdpdParameters{.state = {.d_0 = spec.density, .modulus = K, .background = K},
                           .support = spec.support * std::pow(spec.density, -1.0 / D)},
      1, std::vector{friction});
}

/// The scene without particles' positions: the base box, or all copies of it.
template <int D>
odpd::SceneSettings<D> scene_settings(const FluidSpec& spec, bool whole) {
  odpd::SceneSettings<D> s;
  s.seed = seed;
  odpd::DpdParameters p{.s = spec.s};
  if (spec.far_friction) {
    p.gamma_far = 0.1;
    p.cutoff_far = 1.5;
  }
  p.gamma_perp = spec.gamma_perp;
  // Positions do not depend on friction, so a start is made without spins.
  const bool spins = whole && spec.spinning > 0.0;
  s.model = spec.support > 0.0 ? sdpd_model<D>(spec) : odpd::make_dpd<D>(p, spins ? 2 : 1);
  if (spins)
    s.species = {{.name = "plain", .fraction = 1.0 - spec.spinning},
                 {.name = "spinning", .fraction = spec.spinning, .lever_radius = 0.5}};
  s.box.periodic.fill(true);
  const int directions = spec.walls ? D - 1 : D;
  const std::int64_t parts = parts_of<D>(spec), in = whole ? 1 : parts, of = parts / in;
  s.count = spec.particles / copies(in, directions);
  if (spec.bodies) {
    Suspension<D> base = suspend<D>(*spec.bodies, spec.particles / copies(parts, directions),
                                    spec.density, spec.thin, seed);
    s.count = base.free * copies(of, directions);
    s.box.size = base.size;
    for (int c = 0; c < directions; ++c) s.box.size[c] *= static_cast<double>(of);
    s.bodies.push_back(std::move(base.bodies));
    if (spec.bodies->anywhere && !whole) s.start = odpd::StartKind::file;
  } else {
    const double volume = static_cast<double>(spec.particles) / spec.density;
    const double edge =
        spec.thin > 0.0 ? std::pow(volume / spec.thin, 1.0 / (D - 1)) : std::pow(volume, 1.0 / D);
    for (int c = 0; c < D; ++c) s.box.size[c] = c == 0 && spec.thin > 0.0 ? spec.thin : edge;
    for (int c = 0; c < directions; ++c) s.box.size[c] /= static_cast<double>(in);
  }
  if (spec.gap) s.box.size[spec.walls ? D - 1 : 0] *= 1.5;
  if (spec.walls) add_walls(s);
  if (s.start == odpd::StartKind::file) {
    const odpd::CounterRandom random(seed, odpd::Stream::start_positions);
    const Vec<D> low = s.fluid_low(), high = s.fluid_high();
    for (std::int64_t k = 0; k < s.count; ++k) {
      const auto u = random.uniforms(0, 0, static_cast<std::uint64_t>(k), 0);
      Vec<D> r{};
      for (int c = 0; c < D; ++c) r[c] = low[c] + (high[c] - low[c]) * u[odpd::index(c)];
      s.start_positions.push_back(r);
    }
  }
  if (spec.shear > 0.0 && whole) {
    s.box.shear = odpd::Shear{.rate = spec.shear};
  }
  return s;
}

/// After `steps` steps in the base box.
template <int D>
Start<D> stepped(odpd::SceneSettings<D> settings, std::int64_t steps) {
  settings.zeta_0 = 1.0;
  const bool turned = !settings.bodies.empty() && !settings.bodies[0].positions.empty();
  odpd::Scene<D> scene(std::move(settings));
  odpd::Particles<D>& particles = scene.particles();
  if (turned) {
    turn_bodies(seed, scene.box(), particles);
    relax(scene.box(), scene.model(), scene, scene.settings().relax_sweeps, particles);
  }
  odpd::Dynamics<D> dynamics(scene.box(), particles, scene.model(), scene,
                             odpd::make_solver({.name = "pcg", .tolerance = 1e-3}), {.seed = seed});
  const auto integrator = odpd::make_integrator<D>("trapezoidal");
  odpd::Clock clock{.dt = time_step, .total_steps = steps};
  for (; !clock.finished(); clock.advance()) integrator->step(dynamics, clock);
  Start<D> start;
  for (std::size_t i = 0; i < particles.position.size(); ++i)
    if (particles.is_free(i)) start.fluid.push_back(particles.position[i]);
  for (const odpd::RigidBody<D>& body : particles.bodies) start.bodies.push_back(body.pose);
  return start;
}

/// Copies along the periodic directions, jittered.
template <int D>
Start<D> replicated(const Start<D>& base, const odpd::Box<D>& box, const odpd::Box<D>& whole,
                    std::int64_t parts) {
  const odpd::CounterRandom random(seed, odpd::Stream::probe);
  Start<D> all;
  const auto moved = [&](Vec<D> r, std::int64_t copy, std::size_t which, std::uint64_t kind) {
    const auto u = random.uniforms(kind, 0, which, 0);
    for (int c = 0; c < D; ++c) {
      r[c] += 0.06 * (u[static_cast<std::size_t>(c)] - 0.5);
      if (!box.is_periodic(c)) continue;
      r[c] += static_cast<double>(copy % parts) * box.size[c];
      copy /= parts;
    }
    whole.wrap(r);
    return r;
  };
  const std::int64_t n = copies(parts, box.periodic_directions());
  for (std::int64_t copy = 0; copy < n; ++copy) {
    for (const Vec<D>& r : base.fluid) all.fluid.push_back(moved(r, copy, all.fluid.size(), 0));
    for (odpd::RigidPose<D> pose : base.bodies) {
      pose.centre = moved(pose.centre, copy, all.bodies.size(), 1);
      all.bodies.push_back(pose);
    }
  }
  return all;
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
Start<D> equilibrated(const FluidSpec& spec, std::int64_t steps) {
  const std::int64_t parts = parts_of<D>(spec);
  const odpd::SceneSettings<D> base = scene_settings<D>(spec, false);
  const odpd::Box<D> box = base.box;
  Start<D> start = stepped(base, steps);
  if (parts == 1) return start;
  return replicated(start, box, scene_settings<D>(spec, true).box, parts);
}

template <int D>
std::unique_ptr<odpd::Scene<D>> scene_at(const FluidSpec& spec, const Start<D>& start) {
  odpd::SceneSettings<D> settings = scene_settings<D>(spec, true);
  settings.start = odpd::StartKind::file;
  settings.start_positions = start.fluid;
  settings.relax_sweeps = 0;
  for (odpd::BodySettings<D>& bodies : settings.bodies) {
    bodies.positions.clear();
    for (const auto& pose : start.bodies) bodies.positions.push_back(pose.centre);
  }
  auto scene = std::make_unique<odpd::Scene<D>>(std::move(settings));
  const std::vector<std::int32_t> index_of_id = scene->particles().index_of_id();
  for (std::size_t b = 0; b < start.bodies.size(); ++b)
    place_body(b, start.bodies[b], scene->box(), index_of_id, scene->particles());
  return scene;
}

template <int D>
Problem<D>::Problem(const FluidSpec& fluid, const Start<D>& start)
    : spec(fluid), scene(scene_at<D>(fluid, start)), resistance(scene->box(), fluid.held) {
  if (spec.obstacle > 0) {
    hold_middle(spec.obstacle, *scene);
    surroundings = std::make_unique<Obstacle<D>>();
  }
  const odpd::Surroundings<D>& around = surroundings ? *surroundings : *scene;
  dynamics = std::make_unique<odpd::Dynamics<D>>(scene->box(), scene->particles(), scene->model(),
                                                 around, odpd::make_solver({}),
                                                 odpd::DynamicsSettings{.seed = seed});
  odpd::Clock clock{.dt = time_step};
  if (spec.shear > 0.0) {
    const auto integrator = odpd::make_integrator<D>("trapezoidal");
    for (; clock.step < sheared_steps; clock.advance()) integrator->step(*dynamics, clock);
  }
  dynamics->reorder_if_due(0);
  dynamics->evaluate(scene->particles().position, clock.time(), stage);
  std::vector<Vec<D>> edge_noise;
  load = dynamics->draw_noise(stage, clock.step, time_step, edge_noise);
  const std::vector<double> force = dynamics->force(stage);
  for (std::size_t k = 0; k < load.size(); ++k) load[k] += force[k];
}

template <int D>
void Problem<D>::stiffen(double ratio) {
  const odpd::CounterRandom random(1, odpd::Stream::probe);
  auto& network = stage.network;
  const auto k_c = network.k_c.each();
  for (std::size_t k = 0; k < k_c.size(); ++k) {
    const bool bond = random.uniforms(1, 0, k, 0)[0] < 0.1;
    k_c[k] = bond ? ratio * network.zeta_par[k] / time_step : 0.0;
  }
  stiffness_time = time_step;
}

template <int D>
double Problem<D>::rebuild() {
  const odpd::Stopwatch watch;
  resistance.slide(stage.box);
  resistance.rebuild(stage.network, dynamics->dofs(), scene->particles(), stage.position,
                     stage.arms, {.drag = spec.shift}, stiffness_time);
  const double seconds = watch.seconds();
  if (!load_scaled_) resistance.scale_load(load);
  load_scaled_ = true;
  return seconds;
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
  return static_cast<double>(ends) / static_cast<double>(dofs.mobile());
}

#define ODPD_INSTANTIATE(D)                                                                \
  template Start<D> equilibrated<D>(const FluidSpec&, std::int64_t);                       \
  template std::unique_ptr<odpd::Scene<D>> scene_at<D>(const FluidSpec&, const Start<D>&); \
  template class Problem<D>;
ODPD_INSTANTIATE(2)
ODPD_INSTANTIATE(3)
#undef ODPD_INSTANTIATE

}  // namespace bench
