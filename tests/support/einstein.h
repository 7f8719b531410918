#pragma once
// Small rigid bodies that do not feel each other in a periodic box of frozen particles of friction only: their
// diffusion coefficients, and their mobilities under a small force and torque, from as many independent copies.
#include <array>
#include <cmath>
#include <numbers>
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

constexpr std::size_t einstein_bodies = 400;

/// Bodies of three particles among 1600 frozen ones in a box of 20 x 20.
inline void add_bodies_and_matrix(const Box<2>& box, Particles<2>& particles) {
  RigidBody<2> body;
  for (int k = 0; k < 3; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / 3.0;
    body.frame.push_back({{0.3 * std::cos(angle), 0.3 * std::sin(angle)}});
  }
  for (const Vec<2>& r : random_points<2>(Vec<2>{}, box.size, einstein_bodies, 1)) {
    body.pose.centre = r;
    particles.add_body(body, box, 1);
  }
  for (const Vec<2>& r : random_points<2>(Vec<2>{}, box.size, 1600, 2)) particles.add(r, 0, 1);
  particles.walls = 1;
}

/// Displacement and rotation of each body since the start.
struct Paths {
  std::vector<Vec<2>> way = std::vector<Vec<2>>(einstein_bodies);
  std::vector<double> angle = std::vector<double>(einstein_bodies);

  void add(const Box<2>& box, const std::vector<RigidBody<2>>& from,
           const std::vector<RigidBody<2>>& to) {
    for (std::size_t b = 0; b < einstein_bodies; ++b) {
      way[b] += box.separation(to[b].pose.centre, from[b].pose.centre);
      const Vec<2> x{{1.0, 0.0}};
      const Vec<2> u = from[b].pose.orientation.turn(x), v = to[b].pose.orientation.turn(x);
      angle[b] += std::atan2(u[0] * v[1] - u[1] * v[0], dot(u, v));
    }
  }
};

/// Paths every `lag` from the second on.
inline std::vector<Paths> follow(const RigidLoad<2>& load, double dt, double lag, double time) {
  const Box<2> box{{{20.0, 20.0}}, {true, true}};
  Particles<2> particles;
  add_bodies_and_matrix(box, particles);
  const DpdParameters felt{.a = 0.0, .gamma = 4.5, .s = 0.5};
  const DpdModel<2> model(2, {felt, felt, felt, DpdParameters{.a = 0.0, .gamma = 0.0}});
  const PushedBodies surroundings(load);
  Dynamics<2> dynamics(box, particles, model, surroundings,
                       make_solver({.name = "pcg", .tolerance = 1e-5}), DynamicsSettings{});
  const auto integrator = make_integrator<2>("trapezoidal");
  const auto every = static_cast<std::int64_t>(std::lround(lag / dt));
  Paths paths;
  std::vector<Paths> kept;
  for (Clock clock{.dt = dt, .total_steps = static_cast<std::int64_t>(std::lround(time / dt))};
       !clock.finished();) {
    const std::vector<RigidBody<2>> before = particles.bodies;
    integrator->step(dynamics, clock);
    clock.advance();
    paths.add(box, before, particles.bodies);
    if (clock.step % every == 0 && clock.step >= 2 * every) kept.push_back(paths);
  }
  return kept;
}

/// Mean over the bodies, standard error from ten blocks of them.
template <class OfBody>
Transport mean_over_bodies(const OfBody& of_body) {
  constexpr std::size_t blocks = 10, block = einstein_bodies / blocks;
  std::array<double, blocks> means{};
  for (std::size_t b = 0; b < einstein_bodies; ++b) means[b / block] += of_body(b) / block;
  Transport result;
  for (const double m : means) result.value += m / blocks;
  double square = 0.0;
  for (const double m : means) square += (m - result.value) * (m - result.value);
  result.standard_error = std::sqrt(square / (blocks * (blocks - 1.0)));
  return result;
}

/// {D, D_r}: slopes of the mean-square displacements between one lag and two.
inline std::array<Transport, 2> diffusion(double dt, double lag, double time) {
  const std::vector<Paths> at = follow({}, dt, lag, time);
  const auto mean_over_times = [&](const auto& square) {
    double sum = 0.0;
    for (std::size_t t = 0; t + 2 < at.size(); ++t)
      sum += square(at[t], at[t + 2]) - square(at[t], at[t + 1]);
    return sum / static_cast<double>(at.size() - 2);
  };
  return {mean_over_bodies([&](std::size_t b) {
            return mean_over_times([b](const Paths& from, const Paths& to) {
                     const Vec<2> d = to.way[b] - from.way[b];
                     return dot(d, d);
                   }) /
                   (4.0 * lag);
          }),
          mean_over_bodies([&](std::size_t b) {
            return mean_over_times([b](const Paths& from, const Paths& to) {
                     return std::pow(to.angle[b] - from.angle[b], 2);
                   }) /
                   (2.0 * lag);
          })};
}

/// {V/force, w/torque} under a force along x and a torque.
inline std::array<Transport, 2> mobility(double force, double torque, double dt, double time) {
  const double lag = 0.05 * time;
  const std::vector<Paths> at = follow({{{force, 0.0}}, {{torque, 0.0}}}, dt, lag, time);
  const double measured = lag * static_cast<double>(at.size() - 1);
  return {mean_over_bodies([&](std::size_t b) {
            return (at.back().way[b] - at.front().way[b])[0] / measured / force;
          }),
          mean_over_bodies([&](std::size_t b) {
            return (at.back().angle[b] - at.front().angle[b]) / measured / torque;
          })};
}

}  // namespace support
