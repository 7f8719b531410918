// Rigid bodies in motion: order of the step, mechanics without friction, threads.
#include <gtest/gtest.h>

#include <cmath>

#include "odpd/core/parallel.h"
#include "odpd/dynamics/integrator.h"
#include "odpd/pairs/dpd.h"
#include "support/dimensions.h"
#include "support/points.h"
#include "support/swarm.h"

namespace odpd {
namespace {

using support::Swarm;

template <class Dimension>
class MovingBodies : public ::testing::Test {};
TYPED_TEST_SUITE(MovingBodies, support::Dimensions);

// Without noise the distance to a run of half the step falls by 4 for second order, 2 for first.
TYPED_TEST(MovingBodies, KeepTheOrderOfTheStep) {
  constexpr int D = TypeParam::D;
  // Smooth weights: with the usual ones a pair that crosses the cutoff costs some of the order.
  const DpdParameters calm{
      .a = 18.5, .s_bar = 3.0, .gamma = 4.5, .s = 2.0, .cutoff = 1.5, .kT = 0.0};
  const RigidBody<D> simplex = support::simplex_body<D>(), rod = support::rod_body<D>();
  for (const auto& [body, scheme, mass, order] : {std::tuple{simplex, "trapezoidal", 0.0, 2.0},
                                                  {simplex, "trapezoidal", 0.5, 2.0},
                                                  {simplex, "midpoint", 0.0, 2.0},
                                                  {simplex, "extrapolated", 0.0, 2.0},
                                                  {simplex, "euler", 0.0, 1.0},
                                                  {rod, "trapezoidal", 0.0, 2.0},
                                                  {rod, "trapezoidal", 0.5, 2.0}}) {
    std::vector<std::unique_ptr<Swarm<D>>> runs;
    for (const std::int64_t steps : {10, 20, 40}) {
      runs.push_back(std::make_unique<Swarm<D>>(calm, mass, D == 2 ? 6 : 5, 1e-12, body));
      runs.back()->run(scheme, 0.1 / static_cast<double>(steps), steps);
    }
    const double coarse = runs[0]->distance(*runs[1]), fine = runs[1]->distance(*runs[2]);
    EXPECT_GT(coarse, 1e-9);
    EXPECT_NEAR(std::log2(coarse / fine), order, 0.35) << scheme << " " << mass;
  }
}

TYPED_TEST(MovingBodies, HaveTheSameBitsOnAnyThreadCount) {
  constexpr int D = TypeParam::D;
  const int before = threads();
  std::vector<std::vector<Vec<D>>> results;
  for (const int count : {1, 2}) {
    set_threads(count, 0);
    Swarm<D> swarm(DpdParameters{}, 0.0, D == 2 ? 12 : 5, 1e-6);
    swarm.run("trapezoidal", 0.005, 20);
    results.push_back(swarm.positions());
  }
  set_threads(before, 0);
  EXPECT_EQ(results[0], results[1]);
}

// Fifty bodies with mass in a sheared fluid, across the faces too.
TYPED_TEST(MovingBodies, OfAnyNumberHaveTheSameBitsOnAnyThreadCount) {
  constexpr int D = TypeParam::D;
  constexpr std::size_t bodies = 50;
  const int before = threads();
  Box<D> box{support::uniform_vec<D>(D == 2 ? 8.0 : 4.5), {}};
  box.periodic.fill(true);
  box.shear = Shear{.rate = 5.0};
  const DpdModel<D> model(1, {DpdParameters{}});
  const NoSurroundings<D> nothing({.mass = 0.5, .kT = DpdParameters{}.kT});
  std::vector<std::vector<Vec<D>>> results;
  for (const int count : {1, 2, 4}) {
    set_threads(count, 0);
    Particles<D> particles;
    for (const Vec<D>& r : support::random_points<D>(Vec<D>{}, box.size, bodies, 1)) {
      RigidBody<D> body = support::simplex_body<D>();
      body.pose.centre = r;
      particles.add_body(body, box, 0);
    }
    for (const Vec<D>& r : support::random_points<D>(Vec<D>{}, box.size, 200, 2))
      particles.add(r, 0);
    Dynamics<D> dynamics(box, particles, model, nothing,
                         make_solver({.name = "pcg", .tolerance = 1e-6}), {.reorder_every = 4});
    const auto integrator = make_integrator<D>("trapezoidal");
    for (Clock clock{.dt = 0.005, .total_steps = 10}; !clock.finished(); clock.advance())
      integrator->step(dynamics, clock);
    results.push_back(particles.position);
    results.back().insert(results.back().end(), particles.end_velocity.begin(),
                          particles.end_velocity.end());
  }
  set_threads(before, 0);
  EXPECT_EQ(results[0], results[1]);
  EXPECT_EQ(results[0], results[2]);
}

// With no friction a body spins freely: its angular momentum stays, whichever way it turns.
template <int D>
void expect_free_spin(const RigidBody<D>& body) {
  Box<D> box{support::uniform_vec<D>(10.0), {}};
  box.periodic.fill(true);
  Particles<D> particles;
  particles.add_body(body, box, 0);
  const std::size_t n = body.frame.size();
  const DpdModel<D> model(1, {DpdParameters{.kT = 0.0}});
  const NoSurroundings<D> nothing({.mass = 2.0, .kT = 0.0});
  Dynamics<D> dynamics(box, particles, model, nothing,
                       make_solver({.name = "cholmod", .tolerance = 1e-12}), {.reorder_every = 0});
  Vec<D> spin{};
  for (int c = 0; c < rotation_components<D>; ++c) spin[c] = 1.0 + 0.7 * c;
  const auto angular_momentum = [&] {
    Vec<D> l{};
    for (std::size_t k = 0; k < n; ++k)
      l += 2.0 * torque(particles.bodies[0].pose.orientation.turn(body.frame[k]),
                        particles.end_velocity[k]);
    return l;
  };
  for (std::size_t k = 0; k < n; ++k) particles.end_velocity[k] = swing(spin, body.frame[k]);
  const Vec<D> before = angular_momentum();
  const auto integrator = make_integrator<D>("trapezoidal");
  for (Clock clock{.dt = 0.01, .total_steps = 500}; !clock.finished(); clock.advance())
    integrator->step(dynamics, clock);
  EXPECT_LT(norm(angular_momentum() - before), 1e-10 * norm(before));
  // It did turn.
  EXPECT_GT(norm(particles.bodies[0].pose.orientation.turn(body.frame[0]) - body.frame[0]), 0.01);
}

TYPED_TEST(MovingBodies, SpinFreelyWithoutFriction) {
  constexpr int D = TypeParam::D;
  RigidBody<D> body;
  body.frame = support::random_vectors<D>(5, 11);
  Vec<D> mean{};
  for (const Vec<D>& b : body.frame) mean += 0.2 * b;
  for (Vec<D>& b : body.frame) b -= mean;
  expect_free_spin(body);
  expect_free_spin(support::rod_body<D>());
}

}  // namespace
}  // namespace odpd
