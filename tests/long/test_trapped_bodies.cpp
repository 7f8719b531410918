// Two rigid bodies held by springs to one post in a repulsive fluid: `trapezoidal` samples what `monte-carlo` does.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "odpd/analysis/block_average.h"
#include "odpd/dynamics/integrator.h"
#include "odpd/pairs/bonds.h"
#include "odpd/pairs/dpd.h"
#include "support/points.h"

namespace odpd {
namespace {

constexpr double edge = 5.0;
const Vec<2> middle{{0.5 * edge, 0.5 * edge}};

// Square distance from the post, distance of the two, cosine of three times the angle between them.
BlockAverage sample(const std::string& scheme, double dt, std::int64_t steps) {
  const Box<2> box{{{edge, edge}}, {true, true}};
  Particles<2> particles;
  RigidBody<2> body;
  for (int k = 0; k < 3; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / 3.0;
    body.frame.push_back({{0.3 * std::cos(angle), 0.3 * std::sin(angle)}});
  }
  for (const double x : {1.5, 3.5}) {
    body.pose.centre = {{x, 2.5}};
    particles.add_body(body, box, 0);
  }
  const auto post = static_cast<std::int64_t>(particles.size());
  particles.add(middle, 0, odpd::Group::wall(0));
  particles.walls = 1;
  std::vector<Bond> bonds;
  for (std::int64_t id = 0; id < post; ++id)
    bonds.push_back({id, post, {.H = 8.0, .r_0 = 0.0, .exclude = BondExclusion::all}});
  for (const Vec<2>& r : support::random_points<2>(Vec<2>{}, box.size, 100, 3)) particles.add(r, 0);
  const BondedModel<2> model(std::make_unique<DpdModel<2>>(
                                 1, std::vector{DpdParameters{.a = 18.5, .gamma = 4.5, .s = 0.5}}),
                             bonds);
  const NoSurroundings<2> nothing;
  Dynamics<2> dynamics(box, particles, model, nothing,
                       make_solver({.name = "pcg", .tolerance = 1e-5}), DynamicsSettings{});
  const auto integrator = make_integrator<2>(scheme);
  BlockAverage sampled(3);
  Clock clock{.dt = dt, .equilibration_steps = steps / 20, .total_steps = steps};
  while (!clock.finished()) {
    integrator->step(dynamics, clock);
    clock.advance();
    if (!clock.measuring()) continue;
    const RigidPose<2>& a = particles.bodies[0].pose;
    const RigidPose<2>& b = particles.bodies[1].pose;
    const Vec<2> p = box.separation(a.centre, middle), q = box.separation(b.centre, middle);
    const Vec<2> x{{1.0, 0.0}}, u = a.orientation.turn(x), v = b.orientation.turn(x);
    const double between = std::atan2(u[0] * v[1] - u[1] * v[0], dot(u, v));
    sampled.add(std::array{0.5 * (dot(p, p) + dot(q, q)), norm(p - q), std::cos(3.0 * between)});
  }
  return sampled;
}

TEST(LongTrappedBodies, SampleWhatMonteCarloDoes) {
  const BlockAverage exact = sample("monte-carlo", 1.0, 200000);
  const BlockAverage measured = sample("trapezoidal", 0.005, 150000);
  const char* names[] = {"square distance from the post", "distance", "cos of three angles"};
  for (std::size_t k = 0; k < 3; ++k) {
    const double error = std::hypot(exact.standard_error(k), measured.standard_error(k));
    std::printf("%s: %.4f(%.4f), monte-carlo %.4f(%.4f)\n", names[k], measured.mean(k),
                measured.standard_error(k), exact.mean(k), exact.standard_error(k));
    EXPECT_NEAR(measured.mean(k), exact.mean(k), 3.0 * error);
    EXPECT_LT(error, 0.02);
  }
}

}  // namespace
}  // namespace odpd
