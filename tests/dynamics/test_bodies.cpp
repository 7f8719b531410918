// Rigid bodies in motion: order of the step, mechanics without friction, temperature, threads.
#include <gtest/gtest.h>

#include <cmath>

#include "odpd/core/parallel.h"
#include "odpd/dynamics/integrator.h"
#include "odpd/pairs/dpd.h"
#include "support/dimensions.h"
#include "support/points.h"

namespace odpd {
namespace {

template <int D>
struct Swarm {
  // Fluid on a lattice 0.7 apart with two bodies in it, in a periodic box.
  Swarm(const DpdParameters& fluid, double mass, int side, double tolerance = 1e-12)
      : model(1, {fluid}) {
    box.size = support::uniform_vec<D>(0.7 * side);
    box.periodic.fill(true);
    for (const double where : {0.25, 0.7}) {
      RigidBody<D> body;
      for (int k = 0; k < D + 1; ++k) {
        Vec<D> b{};
        if (k > 0) b[k - 1] = k == 1 ? 0.5 : 0.4;
        body.frame.push_back(b);
      }
      Vec<D> mean{};
      for (const Vec<D>& b : body.frame) mean += (1.0 / (D + 1)) * b;
      for (Vec<D>& b : body.frame) b -= mean;
      body.pose.centre = where * box.size;
      particles.add_body(body, box, 0);
    }
    std::int64_t sites = 1;
    for (int c = 0; c < D; ++c) sites *= side;
    const auto shake = support::random_vectors<D>(static_cast<std::size_t>(sites), 3);
    for (std::int64_t n = 0; n < sites; ++n) {
      Vec<D> r = 0.1 * shake[static_cast<std::size_t>(n)];
      std::int64_t rest = n;
      for (int c = 0; c < D; ++c, rest /= side) r[c] += 0.7 * static_cast<double>(rest % side);
      box.wrap(r);
      particles.add(r, 0, 0);
    }
    DynamicsSettings settings;
    settings.mass = mass;
    settings.kT = fluid.kT;
    settings.reorder_every = 7;
    dynamics = std::make_unique<Dynamics<D>>(box, particles, model, nothing,
                                             make_solver({.name = "pcg", .tolerance = tolerance}),
                                             settings);
  }
  void run(const std::string& scheme, double dt, std::int64_t steps) {
    const auto integrator = make_integrator<D>(scheme);
    for (Clock clock{.dt = dt, .total_steps = steps}; !clock.finished(); clock.advance())
      integrator->step(*dynamics, clock);
  }
  // Positions by identity.
  std::vector<Vec<D>> positions() const {
    std::vector<Vec<D>> r;
    for (const std::int32_t i : particles.index_of_id())
      r.push_back(particles.position[static_cast<std::size_t>(i)]);
    return r;
  }
  double distance(const Swarm& other) const {
    double sum = 0.0;
    const auto a = positions(), b = other.positions();
    for (std::size_t k = 0; k < a.size(); ++k) {
      const Vec<D> d = box.separation(a[k], b[k]);
      sum += dot(d, d);
    }
    return std::sqrt(sum);
  }

  Box<D> box;
  Particles<D> particles;
  DpdModel<D> model;
  NoSurroundings<D> nothing;
  std::unique_ptr<Dynamics<D>> dynamics;
};

template <class Dimension>
class MovingBodies : public ::testing::Test {};
TYPED_TEST_SUITE(MovingBodies, support::Dimensions);

// Without noise the distance to a run of half the step falls by 4 for second order, 2 for first.
TYPED_TEST(MovingBodies, KeepTheOrderOfTheStep) {
  constexpr int D = TypeParam::D;
  // Smooth weights: with the usual ones a pair that crosses the cutoff costs some of the order.
  const DpdParameters calm{
      .a = 18.5, .s_bar = 3.0, .gamma = 4.5, .s = 2.0, .cutoff = 1.5, .kT = 0.0};
  for (const auto& [scheme, mass, order] : {std::tuple{"trapezoidal", 0.0, 2.0},
                                            {"trapezoidal", 0.5, 2.0},
                                            {"midpoint", 0.0, 2.0},
                                            {"extrapolated", 0.0, 2.0},
                                            {"euler", 0.0, 1.0}}) {
    std::vector<std::unique_ptr<Swarm<D>>> runs;
    for (const std::int64_t steps : {10, 20, 40}) {
      runs.push_back(std::make_unique<Swarm<D>>(calm, mass, D == 2 ? 6 : 5));
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

// With no friction a body spins freely: its angular momentum stays, whichever way it turns.
TYPED_TEST(MovingBodies, SpinFreelyWithoutFriction) {
  constexpr int D = TypeParam::D;
  Box<D> box{support::uniform_vec<D>(10.0), {}};
  box.periodic.fill(true);
  Particles<D> particles;
  RigidBody<D> body;
  body.frame = support::random_vectors<D>(5, 11);
  Vec<D> mean{};
  for (const Vec<D>& b : body.frame) mean += 0.2 * b;
  for (Vec<D>& b : body.frame) b -= mean;
  particles.add_body(body, box, 0);
  const DpdModel<D> model(1, {DpdParameters{.kT = 0.0}});
  const NoSurroundings<D> nothing;
  DynamicsSettings settings;
  settings.mass = 2.0;
  settings.kT = 0.0;
  settings.reorder_every = 0;
  Dynamics<D> dynamics(box, particles, model, nothing,
                       make_solver({.name = "cholmod", .tolerance = 1e-12}), settings);
  Vec<D> spin{};
  for (int c = 0; c < rotation_components<D>; ++c) spin[c] = 1.0 + 0.7 * c;
  const auto angular_momentum = [&] {
    Vec<D> l{};
    for (std::size_t k = 0; k < 5; ++k)
      l += 2.0 * torque(particles.bodies[0].pose.orientation.turn(body.frame[k]),
                        particles.end_velocity[k]);
    return l;
  };
  for (std::size_t k = 0; k < 5; ++k) particles.end_velocity[k] = swing(spin, body.frame[k]);
  const Vec<D> before = angular_momentum();
  const auto integrator = make_integrator<D>("trapezoidal");
  for (Clock clock{.dt = 0.01, .total_steps = 500}; !clock.finished(); clock.advance())
    integrator->step(dynamics, clock);
  EXPECT_LT(norm(angular_momentum() - before), 1e-10 * norm(before));
  // It did turn.
  EXPECT_GT(norm(particles.bodies[0].pose.orientation.turn(body.frame[0]) - body.frame[0]), 0.01);
}

// <P^2> = d M kT (1 - M/M_all) of a body of mass M where all momenta add up to zero, and <L w> = kT; 2 bodies over 20000
// steps, decorrelating within about 10: standard error about 2.2 %.
TEST(MovingBodies, HaveTheTemperatureOfTheFluid) {
  constexpr int D = 2;
  const double mass = 1.0;
  Swarm<D> swarm(DpdParameters{}, mass, 6, 1e-6);
  const auto integrator = make_integrator<D>("trapezoidal");
  double linear = 0.0, angular = 0.0, samples = 0.0;
  for (Clock clock{.dt = 0.02, .total_steps = 21000}; !clock.finished(); clock.advance()) {
    integrator->step(*swarm.dynamics, clock);
    if (clock.step < 1000) continue;
    const auto index = swarm.particles.index_of_id();
    for (const RigidBody<D>& body : swarm.particles.bodies) {
      Vec<D> p{};
      double l = 0.0, inertia = 0.0;
      for (std::size_t k = 0; k < body.members.size(); ++k) {
        const Vec<D> a = body.pose.orientation.turn(body.frame[k]);
        const Vec<D>& v = swarm.particles.end_velocity[static_cast<std::size_t>(
            index[static_cast<std::size_t>(body.members[k])])];
        p += mass * v;
        l += mass * torque(a, v)[0];
        inertia += mass * dot(a, a);
      }
      linear += dot(p, p) / (mass * static_cast<double>(body.members.size())) / D;
      angular += l * l / inertia;
      samples += 1.0;
    }
  }
  EXPECT_NEAR(linear / samples, 1.0 - 3.0 / 42.0, 0.08);
  EXPECT_NEAR(angular / samples, 1.0, 0.08);
}

}  // namespace
}  // namespace odpd
