// The drift kT div R^-1: the stochastic trapezoidal rule has it, the paper's Euler step does not. Energy and pressure of
// cases/04_equilibrium against Metropolis Monte Carlo of the same system.
#include <gtest/gtest.h>

#include <cstdlib>

#include "odpd/app/simulation.h"

namespace odpd {
namespace {

// Metropolis Monte Carlo, 1.2 million sweeps (energy 6.66804(8), pressure 39.9509(4)).
constexpr double exact_energy = 6.66804;
constexpr double exact_pressure = 39.9509;

Results run_equilibrium(const std::string& integrator, double duration) {
  const std::string file = std::string(ODPD_SOURCE_DIR) + "/cases/04_equilibrium/case.toml";
  const Config config = open_case(
      file, {"integrator.name=" + integrator, "run.duration=" + std::to_string(duration)});
  Simulation<2> simulation(config, read_case(config, "04_equilibrium"));
  simulation.run([] { return false; }, [] {});
  return simulation.results();
}

double relative_miss(const Results& results, const std::string& name, double exact) {
  return (results.find(name)->mean - exact) / exact;
}

// Estimated: means over t = 60. Standard errors: about 0.04 % in energy, 0.02 % in pressure (block averaging). The
// scheme's own error at dt = 0.005 is below 0.05 %; Euler's is -0.86 % and +0.9 %, about three times the bounds and ten standard errors beyond them.
TEST(Equilibrium, TrapezoidalSamplesTheRightDistribution) {
  const Results results = run_equilibrium("trapezoidal", 60.0);
  EXPECT_LT(std::abs(relative_miss(results, "energy_per_particle", exact_energy)), 0.0025);
  EXPECT_LT(std::abs(relative_miss(results, "pressure", exact_pressure)), 0.003);
  EXPECT_LT(results.find("energy_per_particle")->standard_error / exact_energy, 0.0007);
  // Configurational temperature of the trapezoidal rule at this dt: about 0.99 +- 0.006.
  EXPECT_NEAR(results.find("config_temperature")->mean, 1.0, 0.04);
}

TEST(Equilibrium, EulerMissesItAndTheTestSeesThat) {
  const Results results = run_equilibrium("euler", 60.0);
  EXPECT_LT(relative_miss(results, "energy_per_particle", exact_energy), -0.005);
  EXPECT_GT(relative_miss(results, "pressure", exact_pressure), 0.005);
  EXPECT_LT(results.find("config_temperature")->mean, 0.92);
}

}  // namespace
}  // namespace odpd
