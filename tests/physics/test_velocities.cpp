// Equipartition as a run shows it: particles, molecules' centres and bodies' centres, at rest and under shear.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "odpd/app/simulation.h"

namespace odpd {
namespace {

const std::string mixture_with_mass = R"(
dimension = 2
seed = 3
[box]
size = [6.0, 6.0]
periodic = [true, true]
[fluid]
density = 4.0
mass = 0.5
kT = 1.5
a = 18.5
gamma = 4.5
[[species]]
name = "fluid"
[[species]]
name = "bead"
count = 0
[[molecule]]
name = "triangle"
shape = "simplex"
spacing = 0.25
species = "bead"
H = 200.0
count = 6
[[body]]
name = "ring"
shape = "ring"
radius = 0.2
points_on_ring = 4
positions = [{ at = [1.0, 0.05] }, { at = [3.0, 5.95] }, { at = [2.0, 3.0] }, { at = [5.0, 3.0] }]  # two across the face
[solver]
tolerance = 1e-6
[[observe]]
kind = "velocities"
every = 4
)";

Results velocities_of(const std::string& text) {
  const Config config = Config::from_text(mixture_with_mass + text, "velocities");
  Simulation<2> simulation(config, read_case(config, "velocities"));
  simulation.run([] { return false; }, [] {});
  return simulation.results();
}

const char* const groups_of_velocities[] = {"fluid", "bead", "molecule.triangle", "body.ring"};

// kT/(p m)(1 - p/N) in a fluid that interacts: within five standard errors, and these below what 4000 steps must give.
TEST(VelocityStatistics, HaveTheVarianceOfEquipartition) {
  const Results results =
      velocities_of("[integrator]\ndt = 0.01\n[run]\nequilibrate = 2.0\nduration = 40.0\n");
  const double largest_error[] = {0.01, 0.03, 0.05, 0.08};
  for (int k = 0; k < 4; ++k) {
    const Scalar ratio =
        *results.find(std::string("velocities.") + groups_of_velocities[k] + ".ratio");
    EXPECT_LT(ratio.standard_error, largest_error[k]) << ratio.name;
    EXPECT_NEAR(ratio.mean, 1.0, 5.0 * ratio.standard_error) << ratio.name;
  }
  // The histogram is Maxwell's: 144 particles, 1000 samples, so 3 % of each bin near the middle.
  for (const auto& [name, table] : results.tables) {
    if (name != "velocities") continue;
    for (const auto& row : table.rows) {
      if (std::abs(row[0]) > 1.5) continue;
      EXPECT_NEAR(row[2], row[1], 0.1 * row[1]) << row[0];
    }
  }
}

// Images slide by 6 per time: a body across the face, or a bead beyond it, that kept the velocity of another image would
// have 15 and more times this variance.
TEST(VelocityStatistics, AreThoseRelativeToTheFlow) {
  const Results results = velocities_of(
      "directions = [\"x\"]\n[shear]\nrate = 1.0\n[integrator]\ndt = 0.01\n[run]\nequilibrate = "
      "1.0\nduration = 10.0\n");
  for (const char* const group : groups_of_velocities)
    EXPECT_NEAR(results.find(std::string("velocities.") + group + ".ratio")->mean, 1.0, 0.4)
        << group;
}

}  // namespace
}  // namespace odpd
