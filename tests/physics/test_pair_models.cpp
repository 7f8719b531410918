// Every pair model of the table: motion under its forces must sample what Monte Carlo does, which takes its energy alone.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "odpd/app/simulation.h"
#include "support/model_examples.h"

namespace odpd {
namespace {

Results example_results(const support::ModelExample& example, const std::string& integrator,
                        const std::string& run) {
  const Config config = support::example_config(
      example, 2, 4.0,
      "[integrator]\n" + integrator + "\n[run]\n" + run +
          "\n[solver]\ntolerance = 1e-4\n[[observe]]\nkind = \"thermo\"\nevery = 4\n");
  Simulation<2> simulation(config, read_case(config, example.name));
  simulation.run([] { return false; }, [] {});
  return simulation.results();
}

// 64 particles at density 4. Standard errors of the difference: below 0.5 %, which is asserted, and 0.1 to 0.42 % as measured. The bound is
// five of them wide and 0.2 % for the error of the step. A force 15 % too large for its energy gives U lower by 1 to 2.5 %. Energies near 0
// are held to the like share of kT.
TEST(PairModels, TrapezoidalSamplesWhatMonteCarloDoes) {
  for (const support::ModelExample& example : support::model_examples()) {
    SCOPED_TRACE(example.name);
    const Results exact =
        example_results(example, "name = \"monte-carlo\"", "equilibrate = 300\nduration = 8000");
    const Results moved = example_results(example, "name = \"trapezoidal\"\ndt = 0.01",
                                          "equilibrate = 2.0\nduration = 60.0");
    for (const char* name : {"energy_per_particle", "pressure"}) {
      const Scalar &a = *exact.find(name), &b = *moved.find(name);
      const double error = std::hypot(a.standard_error, b.standard_error);
      const double scale = std::max(1.0, std::abs(a.mean));
      EXPECT_LT(error, 0.005 * scale) << name;
      EXPECT_NEAR(a.mean, b.mean, 5.0 * error + 0.002 * scale) << name;
    }
  }
}

}  // namespace
}  // namespace odpd
