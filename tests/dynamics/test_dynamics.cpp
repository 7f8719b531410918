// One step: balance of forces, known velocities, conservation, order of the schemes, and how a step fails.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>

#include "odpd/core/error.h"
#include "odpd/dynamics/dynamics.h"
#include "odpd/dynamics/integrator.h"
#include "odpd/operator/edge_sums.h"
#include "odpd/pairs/dpd.h"
#include "toy.h"

namespace odpd {
namespace {

TEST(Dynamics, ForcesBalanceOnEveryFreeParticle) {
  Toy toy(1.0, true);
  const auto integrator = make_integrator<2>("trapezoidal");
  const StepRecord<2>& record =
      integrator->step(*toy.dynamics, Clock{.dt = 0.005, .total_steps = 1});
  for (const Stage<2>* stage : {&record.start, &record.corrector}) {
    std::vector<Vec<2>> force(stage->position.size());
    // The same noise in both stages: F_B of the step's start.
    add_edge_forces<2>(record.start.network, record.edge_noise, force);
    add_conservative_forces(stage->network, force);
    double scale = 0.0;
    for (const Vec<2>& f : force) scale = std::max(scale, norm(f));
    add_friction_forces<2>(stage->network, stage->velocity, force);
    for (std::size_t i = 0; i < force.size(); ++i) {
      if (toy.particles.is_free(i)) {
        EXPECT_LT(norm(force[i]), 1e-8 * scale) << "particle " << i;
      } else {
        EXPECT_EQ(stage->velocity[i][0], 0.5);
      }
    }
  }
}

TEST(Dynamics, KnownParticlesMoveAsPrescribed) {
  Toy toy(1.0, true);
  const std::vector<Vec<2>> before = toy.particles.position;
  const auto integrator = make_integrator<2>("trapezoidal");
  integrator->step(*toy.dynamics, Clock{.dt = 0.01, .step = 1, .total_steps = 2});
  for (std::size_t i = 100; i < 110; ++i) {
    EXPECT_NEAR(toy.box.separation(toy.particles.position[i], before[i])[0], 0.005, 1e-14);
    EXPECT_EQ(toy.particles.position[i][1], 2.5);
  }
}

TEST(Dynamics, CentreOfMassRestsInAPeriodicBox) {
  Toy toy(1.0);
  toy.run("trapezoidal", 0.005, 20);
  Vec<2> moved{};
  for (std::size_t i = 0; i < toy.particles.position.size(); ++i)
    moved += toy.particles.velocity[i];
  EXPECT_LT(norm(moved), 1e-10);
}

template <class Action>
std::string message_of(const Action& action) {
  try {
    action();
  } catch (const SolverError& e) {
    return e.what();
  }
  return "no SolverError";
}

TEST(Dynamics, PositionThatIsNotANumberIsNamed) {
  Toy toy(1.0);
  toy.particles.position[7][1] = std::numeric_limits<double>::quiet_NaN();
  const std::string message = message_of([&] { toy.run("trapezoidal", 0.005, 1); });
  EXPECT_NE(message.find("particle 7"), std::string::npos) << message;
  EXPECT_NE(message.find("not finite"), std::string::npos) << message;
}

// A step that throws has changed nothing: the next one meets the same particles.
TEST(Dynamics, BlowUpIsNamedAndMovesNothing) {
  for (const char* name : {"trapezoidal", "euler", "extrapolated"}) {
    Toy toy(1.0);
    const auto by_id = [&] {
      std::vector<Vec<2>> positions;
      for (const std::int32_t i : toy.particles.index_of_id())
        positions.push_back(toy.particles.position[static_cast<std::size_t>(i)]);
      return positions;
    };
    const auto before = by_id();
    try {
      toy.run(name, 50.0, 1);
      ADD_FAILURE() << name;
    } catch (const BlowUpError& e) {
      EXPECT_NE(std::string(e.what()).find("half the box"), std::string::npos) << e.what();
      EXPECT_GE(e.particle(), 0);
      EXPECT_TRUE(by_id() == before) << name;
    }
  }
}

TEST(Dynamics, SolverThatDoesNotConvergeStopsTheStep) {
  Toy toy(1.0, true, {.name = "picard", .tolerance = 1e-10, .max_iterations = 3});
  const std::string message = message_of([&] { toy.run("euler", 0.005, 1); });
  EXPECT_NE(message.find("solver 'picard' did not converge"), std::string::npos) << message;
  EXPECT_NE(message.find("max_iterations"), std::string::npos) << message;
}

TEST(Dynamics, HoldingTheCentreOfMass) {
  Toy toy(1.0, true);
  DynamicsSettings settings;
  settings.hold_centre_of_mass = true;
  toy.dynamics =
      std::make_unique<Dynamics<2>>(toy.box, toy.particles, toy.model, toy.row,
                                    make_solver({.name = "pcg", .tolerance = 1e-10}), settings);
  toy.run("euler", 0.005, 1);
  Vec<2> sum{};
  for (std::size_t i = 0; i < toy.particles.position.size(); ++i)
    if (toy.particles.is_free(i)) sum += toy.particles.velocity[i];
  EXPECT_LT(norm(sum), 1e-9);
  EXPECT_EQ(toy.dynamics->statistics().problem, "centre of mass held still");
}

TEST(Dynamics, UnknownIntegratorListsTheNames) {
  try {
    make_integrator<2>("leapfrog");
    FAIL();
  } catch (const ConfigError& e) {
    EXPECT_NE(std::string(e.what()).find("trapezoidal, midpoint"), std::string::npos);
  }
}

}  // namespace
}  // namespace odpd
