// The equilibrium reference of the program, `monte-carlo`, against Metropolis Monte Carlo by another program: the energy
// sum a/2 (1 - r)^2 over pairs, a = 18.5, density 4, kT = r_c = 1, periodic, at the same N and L.
#include <gtest/gtest.h>

#include <cmath>

#include "odpd/app/simulation.h"

namespace odpd {
namespace {

Config periodic_fluid(int dimension, const std::string& box, std::int64_t sweeps) {
  return Config::from_text(
      "dimension = " + std::to_string(dimension) + "\n[box]\n" + box +
          "\n[fluid]\ndensity = 4.0\nkT = 1.0\na = 18.5\ngamma = 4.5\n"
          "[integrator]\nname = \"monte-carlo\"\n[run]\nequilibrate = 500\nduration = " +
          std::to_string(sweeps) + "\n[[observe]]\nkind = \"thermo\"\nevery = 2\n",
      "case.toml");
}

struct Exact {
  double mean, standard_error;
};

// Three standard errors of the difference, and errors small enough to tell.
void expect_agreement(const Results& results, const std::string& name, const Exact& exact,
                      double relative_error) {
  const Scalar* scalar = results.find(name);
  ASSERT_NE(scalar, nullptr) << name;
  EXPECT_LT(scalar->standard_error, relative_error * exact.mean) << name;
  EXPECT_NEAR(scalar->mean, exact.mean,
              3.0 * std::hypot(scalar->standard_error, exact.standard_error))
      << name;
}

template <int D>
Results sample(const Config& config) {
  Simulation<D> simulation(config, read_case(config, "fluid"));
  simulation.run([] { return false; }, [] {});
  EXPECT_EQ(simulation.dynamics().statistics().solves, 0);
  return simulation.results();
}

// The paper's Euler step is 0.9 % off in both, the trapezoidal rule at dt = 0.005 up to 0.05 %.
TEST(MonteCarlo, EnergyAndPressureIn2D) {
  const Results results =
      sample<2>(periodic_fluid(2, "size = [6.0, 6.0]\nperiodic = [true, true]", 20000));
  expect_agreement(results, "energy_per_particle", {6.66804, 8e-5}, 2e-4);
  expect_agreement(results, "pressure", {39.9509, 4e-4}, 2e-4);
  EXPECT_NEAR(results.find("config_temperature")->mean, 1.0, 0.008);  // four standard errors
  // Sweeps are no time: there is no diffusion to tell.
  EXPECT_EQ(results.find("diffusion"), nullptr);
}

TEST(MonteCarlo, EnergyAndPressureIn3D) {
  const Results results =
      sample<3>(periodic_fluid(3, "size = [5.0, 5.0, 5.0]\nperiodic = [true, true, true]", 4000));
  expect_agreement(results, "energy_per_particle", {5.25507, 2.8e-4}, 4e-4);
  expect_agreement(results, "pressure", {32.2501, 1.2e-3}, 4e-4);
  EXPECT_NEAR(results.find("config_temperature")->mean, 1.0, 0.008);
}

}  // namespace
}  // namespace odpd
