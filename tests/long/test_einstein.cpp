// Einstein's relation of rigid bodies, D = kT mu with kT = 1, for translation and rotation, within 3 %.
//
// Small rigid bodies that do not feel each other in a periodic box of frozen particles of friction only. Their
// equilibrium is known, evenly spread, so that they can start there anew for every window of time: Einstein's relation
// then holds over a window of any length t,
//
//   <|r(t)|^2>/(2 d t) = kT <r(t)>_F . F/(F^2 t)
//
// (Kubo 1966, fluctuation-dissipation theorem, in time), although both sides fall with t as long as a body has not seen
// much of the box. The same noise drives a window with +F and with -F.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <numbers>
#include <vector>

#include "odpd/dynamics/integrator.h"
#include "odpd/pairs/dpd.h"
#include "support/points.h"

namespace odpd {
namespace {

struct Transport {
  double value = 0.0, standard_error = 0.0;
};

constexpr std::size_t body_count = 400;

/// A force and a torque that turns every second body the other way, so that force and rotation do not mix.
class PushedBodies : public NoSurroundings<2> {
 public:
  PushedBodies(const Vec<2>& force, double torque) : force_(force), torque_(torque) {}
  static double turn(std::size_t body) { return body % 2 == 0 ? 1.0 : -1.0; }
  RigidLoad<2> body_load(std::size_t body, double) const override {
    return {force_, {{turn(body) * torque_}}};
  }

 private:
  Vec<2> force_;
  double torque_;
};

/// Displacement and rotation of each body over a window.
struct Paths {
  std::vector<Vec<2>> way = std::vector<Vec<2>>(body_count);
  std::vector<double> angle = std::vector<double>(body_count);

  void add(const Box<2>& box, const std::vector<RigidBody<2>>& from,
           const std::vector<RigidBody<2>>& to) {
    for (std::size_t b = 0; b < body_count; ++b) {
      way[b] += box.separation(to[b].pose.centre, from[b].pose.centre);
      const Vec<2> x{{1.0, 0.0}};
      const Vec<2> u = from[b].pose.orientation.turn(x), v = to[b].pose.orientation.turn(x);
      angle[b] += std::atan2(u[0] * v[1] - u[1] * v[0], dot(u, v));
    }
  }
};

/// Bodies of three particles, elsewhere in each window, among the same 1600 frozen ones in a box of 20 x 20.
Paths follow(std::uint64_t window, const Vec<2>& force, double torque, double dt, double time) {
  const Box<2> box{{{20.0, 20.0}}, {true, true}};
  Particles<2> particles;
  RigidBody<2> body;
  for (int k = 0; k < 3; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / 3.0;
    body.frame.push_back({{0.3 * std::cos(angle), 0.3 * std::sin(angle)}});
  }
  for (const Vec<2>& r : support::random_points<2>(Vec<2>{}, box.size, body_count, 1000 + window)) {
    body.pose.centre = r;
    body.pose.orientation.advance({{r[0] * 1e3, 0.0}});  // as good as random
    particles.add_body(body, box, 1);
  }
  for (const Vec<2>& r : support::random_points<2>(Vec<2>{}, box.size, 1600, 2))
    particles.add(r, 0, odpd::Group::wall(0));
  particles.walls = 1;
  const DpdParameters felt{.a = 0.0, .gamma = 4.5, .s = 0.5};
  const DpdModel<2> model(2, {felt, felt, felt, DpdParameters{.a = 0.0, .gamma = 0.0}});
  const PushedBodies surroundings(force, torque);
  DynamicsSettings settings;
  settings.seed = window;
  Dynamics<2> dynamics(box, particles, model, surroundings,
                       make_solver({.name = "pcg", .tolerance = 1e-5}), settings);
  const auto integrator = make_integrator<2>("trapezoidal");
  Paths paths;
  for (Clock clock{.dt = dt, .total_steps = static_cast<std::int64_t>(std::lround(time / dt))};
       !clock.finished();) {
    const std::vector<RigidBody<2>> before = particles.bodies;
    integrator->step(dynamics, clock);
    clock.advance();
    paths.add(box, before, particles.bodies);
  }
  return paths;
}

Transport mean_of(const std::vector<double>& windows) {
  const auto count = static_cast<double>(windows.size());
  Transport result;
  for (const double w : windows) result.value += w / count;
  double square = 0.0;
  for (const double w : windows) square += (w - result.value) * (w - result.value);
  result.standard_error = std::sqrt(square / (count * (count - 1.0)));
  return result;
}

/// Of translation and of rotation. The error of the ratio is that of D - ratio kT mu, window by window: they share their noise.
struct EinsteinSides {
  std::array<Transport, 2> diffusion, mobility, ratio;
};

EinsteinSides einstein_sides(std::uint64_t windows, double force, double torque, double dt,
                             double time) {
  std::array<std::vector<double>, 2> diffusion, mobility;
  for (std::uint64_t w = 0; w < windows; ++w) {
    const int along = static_cast<int>(w % 2);  // the frozen particles need not be isotropic
    Vec<2> push;
    push[along] = force;
    const Paths free = follow(w, {}, 0.0, dt, time);
    const Paths there = follow(w, push, torque, dt, time);
    const Paths back = follow(w, -1.0 * push, -torque, dt, time);
    double way = 0.0, angle = 0.0, drift = 0.0, spin = 0.0;
    for (std::size_t b = 0; b < body_count; ++b) {
      way += dot(free.way[b], free.way[b]);
      angle += free.angle[b] * free.angle[b];
      drift += there.way[b][along] - back.way[b][along];
      spin += PushedBodies::turn(b) * (there.angle[b] - back.angle[b]);
    }
    constexpr auto bodies = static_cast<double>(body_count);
    diffusion[0].push_back(way / (4.0 * time * bodies));
    diffusion[1].push_back(angle / (2.0 * time * bodies));
    mobility[0].push_back(drift / (2.0 * force * time * bodies));
    mobility[1].push_back(spin / (2.0 * torque * time * bodies));
  }
  EinsteinSides sides;
  for (std::size_t k = 0; k < 2; ++k) {
    sides.diffusion[k] = mean_of(diffusion[k]);
    sides.mobility[k] = mean_of(mobility[k]);
    sides.ratio[k].value = sides.diffusion[k].value / sides.mobility[k].value;
    std::vector<double> excess = diffusion[k];
    for (std::size_t w = 0; w < excess.size(); ++w)
      excess[w] -= sides.ratio[k].value * mobility[k][w];
    sides.ratio[k].standard_error = mean_of(excess).standard_error / sides.mobility[k].value;
  }
  return sides;
}

TEST(LongEinstein, DiffusionIsMobility) {
  const auto sides = einstein_sides(200, 1.0, 1.0, 0.02, 4.0);
  for (const std::size_t k : {0, 1}) {
    const auto &d = sides.diffusion[k], &mu = sides.mobility[k], &ratio = sides.ratio[k];
    std::printf("%s: D %.5f(%.5f), mu %.5f(%.5f), ratio %.4f(%.4f)\n",
                k == 0 ? "translation" : "rotation", d.value, d.standard_error, mu.value,
                mu.standard_error, ratio.value, ratio.standard_error);
    EXPECT_LT(ratio.standard_error, 0.01);
    EXPECT_NEAR(ratio.value, 1.0, 0.03) << "standard error " << ratio.standard_error;
  }
}

}  // namespace
}  // namespace odpd
