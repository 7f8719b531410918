#pragma once
// Small rigid bodies that do not feel each other in a periodic box of frozen particles of friction only: their
// diffusion coefficients, and their mobilities under a small force and torque, from as many independent copies.
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "odpd/dynamics/integrator.h"
#include "odpd/pairs/dpd.h"
#include "support/points.h"

namespace support {

using namespace odpd;  // of the library under test

struct Transport {
  double value = 0.0, standard_error = 0.0;
};

class PushedBodies : public NoSurroundings<2> {
 public:
  explicit PushedBodies(const RigidLoad<2>& load) : load_(load) {}
  RigidLoad<2> body_load(std::size_t, double) const override { return load_; }

 private:
  RigidLoad<2> load_;
};

/// {D, D_r} without a load, {V/force, w/torque} under one; standard errors from ten blocks of bodies.
inline std::array<Transport, 2> transport(const std::string& scheme, const RigidLoad<2>& load,
                                          double time) {
  constexpr double edge = 20.0, dt = 0.02, lag = 1.0;
  constexpr std::size_t bodies = 400, blocks = 10;
  const Box<2> box{{{edge, edge}}, {true, true}};
  Particles<2> particles;
  RigidBody<2> body;
  for (int k = 0; k < 3; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / 3.0;
    body.frame.push_back({{0.3 * std::cos(angle), 0.3 * std::sin(angle)}});
  }
  for (const Vec<2>& r : random_points<2>(Vec<2>{}, box.size, bodies, 1)) {
    body.pose.centre = r;
    particles.add_body(body, box, 1);
  }
  for (const Vec<2>& r : random_points<2>(Vec<2>{}, box.size, 1600, 2)) particles.add(r, 0, 1);
  particles.walls = 1;
  const DpdParameters felt{.a = 0.0, .gamma = 4.5, .s = 0.5};
  const DpdModel<2> model(2, {felt, felt, felt, DpdParameters{.a = 0.0, .gamma = 0.0}});
  const PushedBodies surroundings(load);
  Dynamics<2> dynamics(box, particles, model, surroundings,
                       make_solver({.name = "pcg", .tolerance = 1e-5}), DynamicsSettings{});
  const auto integrator = make_integrator<2>(scheme);
  const bool pushed = norm(load.force) > 0.0;
  std::vector<Vec<2>> way(bodies);    // so far
  std::vector<double> angle(bodies);  // so far
  std::vector<std::vector<Vec<2>>> ways;
  std::vector<std::vector<double>> angles;
  const auto steps = static_cast<std::int64_t>(std::lround(time / dt));
  const auto every = static_cast<std::int64_t>(std::lround(lag / dt));
  for (Clock clock{.dt = dt, .total_steps = steps}; !clock.finished();) {
    const std::vector<RigidBody<2>> before = particles.bodies;
    integrator->step(dynamics, clock);
    clock.advance();
    for (std::size_t b = 0; b < bodies; ++b) {
      const RigidPose<2>& from = before[b].pose;
      const RigidPose<2>& to = particles.bodies[b].pose;
      way[b] += box.separation(to.centre, from.centre);
      const Vec<2> x{{1.0, 0.0}}, u = from.orientation.turn(x), v = to.orientation.turn(x);
      angle[b] += std::atan2(u[0] * v[1] - u[1] * v[0], dot(u, v));
    }
    if (clock.step % every != 0 || clock.step < 2 * every) continue;  // the start is left out
    ways.push_back(way);
    angles.push_back(angle);
  }
  std::array<std::array<double, blocks>, 2> sums{};
  const double measured = lag * static_cast<double>(ways.size() - 1);
  for (std::size_t b = 0; b < bodies; ++b) {
    double& translation = sums[0][b * blocks / bodies];
    double& rotation = sums[1][b * blocks / bodies];
    constexpr double share = static_cast<double>(blocks) / bodies;
    if (pushed) {
      translation += share * (ways.back()[b] - ways[0][b])[0] / measured / load.force[0];
      rotation += share * (angles.back()[b] - angles[0][b]) / measured / load.torque[0];
      continue;
    }
    // Slope of the mean-square displacement between one lag and two.
    const auto pairs = static_cast<double>(ways.size() - 2);
    for (std::size_t t = 0; t + 2 < ways.size(); ++t) {
      const Vec<2> once = ways[t + 1][b] - ways[t][b], twice = ways[t + 2][b] - ways[t][b];
      translation += share * (dot(twice, twice) - dot(once, once)) / (4.0 * lag) / pairs;
      const double one = angles[t + 1][b] - angles[t][b], two = angles[t + 2][b] - angles[t][b];
      rotation += share * (two * two - one * one) / (2.0 * lag) / pairs;
    }
  }
  std::array<Transport, 2> result;
  for (std::size_t k = 0; k < 2; ++k) {
    for (const double s : sums[k]) result[k].value += s / blocks;
    for (const double s : sums[k])
      result[k].standard_error += (s - result[k].value) * (s - result[k].value);
    result[k].standard_error = std::sqrt(result[k].standard_error / (blocks * (blocks - 1.0)));
  }
  return result;
}

}  // namespace support
