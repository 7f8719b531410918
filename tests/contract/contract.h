#pragma once
// Real DPD configurations for the contract tests: three models, three geometries, two dimensions.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "odpd/core/error.h"
#include "odpd/core/parallel.h"
#include "odpd/dynamics/dynamics.h"
#include "odpd/operator/edge_sums.h"
#include "odpd/pairs/dpd.h"
#include "odpd/pairs/noise.h"
#include "odpd/scene/scene.h"
#include "support/network.h"
#include "support/simplex.h"

namespace contract {

/// spinning_fluid: spinning, but walls and bodies have no lever radius.
enum class Model { central, transverse, far_friction, spinning, spinning_fluid };
enum class Geometry { walls, periodic, open, obstacles, suspension, rods, sheared };

inline std::string name(Model model) {
  return model == Model::central          ? "central"
         : model == Model::transverse     ? "transverse"
         : model == Model::spinning       ? "spinning"
         : model == Model::spinning_fluid ? "spinning_fluid"
                                          : "far";
}
inline std::string name(Geometry geometry) {
  return geometry == Geometry::walls       ? "walls"
         : geometry == Geometry::periodic  ? "periodic"
         : geometry == Geometry::open      ? "open"
         : geometry == Geometry::obstacles ? "obstacles"
         : geometry == Geometry::sheared   ? "sheared"
         : geometry == Geometry::rods      ? "rods"
                                           : "suspension";
}

/// Two rigid bodies, rods or others, one of them pushed and turned; with walls also a fixed and a moving obstacle, and under
/// shear the first one lies across the sliding faces.
template <int D>
void add_bodies(odpd::SceneSettings<D>& s, bool walls, bool rods) {
  odpd::BodySettings<D> body;
  if (rods) body.shape = support::rod_body<D>().frame;
  for (int c = 0; c < D && !rods; ++c)
    for (const double side : {-0.3, 0.35}) {
      odpd::Vec<D> point = support::uniform_vec<D>(0.05 * c);
      point[c] += side;
      body.shape.push_back(point);
    }
  odpd::Vec<D> mean{};
  for (const auto& point : body.shape)
    mean += (1.0 / static_cast<double>(body.shape.size())) * point;
  for (auto& point : body.shape) point -= mean;
  const auto place = [&](double x, double last) {
    odpd::Vec<D> r = support::uniform_vec<D>(x);
    r[D - 1] = last;
    return r;
  };
  const double low = walls ? 1.0 : 0.0;
  body.positions = {place(0.2, s.box.shear ? 0.1 : low + 0.9)};
  s.bodies.push_back(body);
  body.positions = {place(1.7, low + 1.6)};
  body.load.force[0] = 3.0;
  body.load.torque[0] = -2.0;
  s.bodies.push_back(body);
  if (!walls) return;
  body.load = {};
  body.motion = odpd::BodyMotion::fixed;
  body.positions = {place(1.0, low + 2.4)};
  s.bodies.push_back(body);
  body.motion = odpd::BodyMotion::given;
  body.velocity.velocity[0] = 0.5;
  body.velocity.angular[0] = -1.0;
  body.positions = {place(2.6, low + 0.8)};
  s.bodies.push_back(body);
}

/// Fluid of density 4 in a cube of edge `length`; walls, one of them moving, lie outside it. An
/// open box ends in the void: nothing but the operator can be asked there.
template <int D>
odpd::SceneSettings<D> settings(Model model, Geometry geometry, double length) {
  odpd::SceneSettings<D> s;
  s.seed = 5;
  s.box.size = support::uniform_vec<D>(length);
  s.box.periodic.fill(geometry != Geometry::open);
  odpd::DpdParameters p{.kT = 0.7};
  if (model == Model::transverse) p.gamma_perp = 1.5;
  if (model == Model::far_friction) {
    p.gamma_far = 0.1;
    p.cutoff_far = 1.5;
  }
  if (model == Model::spinning || model == Model::spinning_fluid) {
    // A third of the fluid does not spin. Walls and bodies are of the first species.
    s.species = {{.name = "a", .fraction = 0.4, .lever_radius = 0.3},
                 {.name = "b", .fraction = 0.3, .lever_radius = 0.7},
                 {.name = "c", .fraction = 0.3}};
    if (model == Model::spinning_fluid)
      std::swap(s.species[0].lever_radius, s.species[2].lever_radius);
    p.gamma_perp = 1.5;
  }
  s.model = odpd::make_dpd<D>(p, static_cast<int>(s.species.size()));
  if (geometry == Geometry::sheared) {
    s.box.shear = odpd::Shear{.flow = 0, .gradient = D - 1, .rate = 2.0, .start = 0.37 * length};
    s.box = s.box.at(0.0);
  }
  if (geometry == Geometry::obstacles || geometry == Geometry::suspension ||
      geometry == Geometry::rods || geometry == Geometry::sheared)
    add_bodies(s, geometry == Geometry::obstacles, geometry == Geometry::rods);
  if (geometry != Geometry::walls && geometry != Geometry::obstacles) return s;
  s.box.size[D - 1] += 2.0;
  s.box.periodic[D - 1] = false;
  s.body_force[0] = 0.2;
  for (const bool high : {false, true}) {
    odpd::WallSettings<D> wall;
    wall.axis = D - 1;
    wall.high = high;
    wall.velocity[0] = high ? 1.0 : 0.0;
    for (const double depth : {0.0, 0.5}) {
      wall.layers.push_back({.depth = depth, .count = 0, .spacing = D == 2 ? 0.25 : 0.5});
    }
    s.walls.push_back(wall);
  }
  return s;
}

/// One instant of a run: edges, R and the right-hand side with noise, wall motion and body force.
template <int D>
class Instant {
 public:
  Instant(Model kind, Geometry geometry, double length, bool hold = false,
          const odpd::Communicator& ranks = odpd::Communicator::alone())
      : model(kind),
        scene(settings<D>(kind, geometry, length), ranks),
        dynamics(scene.box(), scene.particles(), scene.model(), scene, odpd::make_solver({}),
                 {.hold_centre_of_mass = hold}) {
    // One thread, or the threads of several test programs at once wait for each other.
    odpd::set_threads(1, 0);
    dynamics.evaluate(scene.particles().position, 0.0, stage);
    std::vector<odpd::Vec<D>> edge_noise;
    const auto xi = dynamics.draw_noise(stage, 3, 0.01, edge_noise);
    system = &dynamics.assemble(stage, {});
    load = dynamics.force(stage);
    for (std::size_t k = 0; k < load.size(); ++k) load[k] += xi[k];
    spins().scale_load(load);
  }

  const Model model;
  odpd::Scene<D> scene;
  odpd::Dynamics<D> dynamics;
  odpd::Stage<D> stage;
  std::vector<double> load;
  const odpd::System* system =
      nullptr;  ///< what the solvers get: `resistance` unless there are bodies

  const odpd::Resistance<D>& resistance() const { return dynamics.resistance(); }
  const odpd::RigidResistance<D>& rigid() const { return dynamics.rigid_resistance(); }
  const odpd::SpinResistance<D>& spins() const { return dynamics.spin_resistance(); }
};

/// The instant of these arguments, made once in a program: filling and relaxing a box takes longer
/// than the checks of it.
template <int D>
const Instant<D>& instant_of(Model model, Geometry geometry, double length, bool hold = false) {
  static std::map<std::tuple<Model, Geometry, double, bool>, Instant<D>> made;
  return made.try_emplace({model, geometry, length, hold}, model, geometry, length, hold)
      .first->second;
}

inline std::vector<double> product(const odpd::System& system, const std::vector<double>& x) {
  std::vector<double> y(x.size());
  system.apply(x, y);
  return y;
}

/// |Pi (b - A x)| / |Pi b|, worked out here, not by the solver.
inline double true_residual(const odpd::System& system, std::vector<double> b,
                            const std::vector<double>& x) {
  std::vector<double> r = product(system, x);
  for (std::size_t k = 0; k < r.size(); ++k) r[k] = b[k] - r[k];
  system.project(r);
  system.project(b);
  return support::norm(r) / support::norm(b);
}

// Random vectors orthonormal in the inner product of A: the noise along them, in units of sqrt(2 kT/dt), must be independent
// standard normal numbers.
// `map`: of bodies, whose turns that move nobody have no noise; `spins`: nodes of as many spins in front.
template <int D>
std::vector<std::vector<double>> probes(const odpd::System& system, std::size_t count,
                                        const odpd::RigidMap<D>& map, std::int64_t spins) {
  std::vector<std::vector<double>> found;
  for (std::size_t k = 0; k < count; ++k) {
    std::vector<double> a =
        support::random_numbers(static_cast<std::size_t>(system.size()), 100 + k);
    const auto front = static_cast<std::size_t>(spins);
    for (std::size_t s = 0; s < front; ++s)
      for (std::size_t c = odpd::rotation_components<D>; c < D; ++c) a[s * D + c] = 0.0;
    for (std::size_t b = front; b < front + static_cast<std::size_t>(map.bodies()); ++b) {
      const auto& unused = map.unused(b - front);
      const std::vector<double> w(&a[b * D], &a[(b + 1) * D]);
      for (std::size_t i = 0; i < D * D; ++i) a[b * D + i / D] -= unused[i] * w[i % D];
    }
    for (const auto& b : found) {
      const double overlap = support::dot(a, product(system, b));
      for (std::size_t n = 0; n < a.size(); ++n) a[n] -= overlap * b[n];
    }
    const double scale = 1.0 / std::sqrt(support::dot(a, product(system, a)));
    for (double& value : a) value *= scale;
    found.push_back(std::move(a));
  }
  return found;
}

// Estimators over n draws of z = a . xi / sqrt(2 kT/dt) along K probes, with their standard errors: mean square of one probe
// (1, sqrt(2/n)), of all (1, sqrt(2/(n K))), product of two (0, sqrt(1/n)). Every bound is 5 standard errors; a covariance
// wrong by a factor 1.1 lies 10 of them away.
template <int D>
void expect_noise_covariance(const Instant<D>& instant, const odpd::System& system) {
  constexpr std::size_t n = 1250, K = 16;
  constexpr double dt = 0.013, kT = 0.7;
  const odpd::DofMap<D> dofs(instant.scene.particles());
  const auto a = probes(system, K, instant.rigid().map(), instant.spins().spins());
  std::array<std::array<double, K>, K> mean{};
  std::vector<odpd::Vec<D>> on_edges;
  std::vector<double> xi;
  for (std::uint64_t step = 0; step < n; ++step) {
    odpd::draw_edge_noise(instant.stage.network, instant.scene.particles(), 1, step, dt, on_edges);
    std::vector<odpd::Vec<D>> force(instant.stage.position.size());
    odpd::add_edge_forces<D>(instant.stage.network, on_edges, force);
    std::vector<odpd::Vec<D>> torque(instant.stage.spin.size());
    odpd::add_edge_torques<D>(instant.stage.network, on_edges, torque);
    dofs.gather(instant.stage.arms, force, torque, xi);
    instant.spins().scale_load(xi);
    std::array<double, K> z{};
    for (std::size_t k = 0; k < K; ++k) z[k] = support::dot(a[k], xi) / std::sqrt(2.0 * kT / dt);
    for (std::size_t k = 0; k < K; ++k) {
      for (std::size_t l = 0; l <= k; ++l) mean[k][l] += z[k] * z[l] / n;
    }
  }
  double pooled = 0.0;
  for (std::size_t k = 0; k < K; ++k) {
    EXPECT_NEAR(mean[k][k], 1.0, 5.0 * std::sqrt(2.0 / n)) << "probe " << k;
    for (std::size_t l = 0; l < k; ++l) EXPECT_NEAR(mean[k][l], 0.0, 5.0 * std::sqrt(1.0 / n));
    pooled += mean[k][k] / K;
  }
  const double bound = 5.0 * std::sqrt(2.0 / (n * K));
  EXPECT_NEAR(pooled, 1.0, bound);
  EXPECT_GT(std::abs(1.1 * pooled - 1.0), bound) << "the test would not notice a factor of 1.1";
  EXPECT_GT(std::abs(pooled / 1.1 - 1.0), bound) << "the test would not notice a factor of 1/1.1";
}

/// |a - b|/|b|.
inline double distance(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> difference = a;
  for (std::size_t k = 0; k < a.size(); ++k) difference[k] -= b[k];
  return support::norm(difference) / support::norm(b);
}

}  // namespace contract
