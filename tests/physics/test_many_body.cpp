// Many-body DPD with free surfaces: motion with mass samples what Monte Carlo does; surfaces have a tension and bulk has none.
#include <gtest/gtest.h>

#include <cmath>

#include "odpd/app/simulation.h"

namespace odpd {
namespace {

// A liquid of density 4.14 at zero pressure, its surface tension 3.57 (2D); `scene` ends with the table of the integrator.
Results many_body_run(const std::string& scene, const std::string& run) {
  const Config config = Config::from_text(
      "dimension = 2\nseed = 3\n[fluid]\nmodel = \"mdpd\"\ndensity = 4.142\nmass = 0.05\nA = "
      "-40.0\n"
      "B = 25.0\nr_d = 0.75\ngamma = 4.5\nkT = 1.0\n[solver]\ntolerance = 1e-4\n" +
          scene + "\n[run]\n" + run,
      "case.toml");
  Simulation<2> simulation(config, read_case(config, "liquid"));
  simulation.run([] { return false; }, [] {});
  return simulation.results();
}

const std::string drop_of_80 =
    "[box]\nsize = [8.0, 8.0]\nperiodic = [true, true]\n"
    "[start]\nregion = { centre = [4.0, 4.0], radius = 2.48 }\n[[observe]]\nkind = \"thermo\"\n"
    "every = 4\n[[observe]]\nkind = \"drop\"\ncore = 1.0\n[integrator]\n";

const std::string slab_of_150 =
    "[box]\nsize = [6.0, 12.0]\nperiodic = [true, true]\n"
    "[start]\nregion = { from = [0.0, 3.0], to = [6.0, 9.0] }\n[[observe]]\n"
    "kind = \"surface-tension\"\nstrain = 2e-3\n[integrator]\nname = \"monte-carlo\"\n";

// The rule sqrt(kT/m) dt <= 0.03 r_c allows dt = 0.0067.
TEST(ManyBody, ADropWithMassSamplesWhatMonteCarloDoes) {
  const Results exact =
      many_body_run(drop_of_80 + "name = \"monte-carlo\"", "equilibrate = 300\nduration = 4000");
  const Results moved = many_body_run(drop_of_80 + "dt = 0.005", "equilibrate = 2\nduration = 20");
  for (const char* name : {"energy_per_particle", "drop.core_density"}) {
    const Scalar &a = *exact.find(name), &b = *moved.find(name);
    const double error = std::hypot(a.standard_error, b.standard_error);
    EXPECT_LT(error, 0.02 * std::abs(a.mean)) << name;
    EXPECT_NEAR(a.mean, b.mean, 5.0 * error + 0.003 * std::abs(a.mean)) << name;
  }
  const Scalar& kinetic = *moved.find("kinetic_temperature");
  EXPECT_LT(kinetic.standard_error, 0.01);
  EXPECT_NEAR(kinetic.mean, 1.0, 5.0 * kinetic.standard_error);
}

// Of the same configurations, so that the routes differ by far less than either does from the mean of a long run.
TEST(ManyBody, ASlabHasATensionByBothRoutes) {
  const Results slab = many_body_run(slab_of_150, "equilibrate = 300\nduration = 3000");
  const Scalar &stress = *slab.find("surface-tension.stress"),
               &area = *slab.find("surface-tension.test_area");
  EXPECT_LT(stress.standard_error, 0.5);
  EXPECT_LT(area.standard_error, 0.5);
  EXPECT_NEAR(stress.mean, 3.57, 5.0 * stress.standard_error);
  EXPECT_NEAR(area.mean, stress.mean, 0.1);
  const Scalar& vapour = *slab.find("surface-tension.normal_pressure");
  EXPECT_NEAR(vapour.mean, 0.0, 5.0 * vapour.standard_error);
}

TEST(ManyBody, ALiquidWithoutSurfacesHasNone) {
  const std::string filled =
      "[box]\nsize = [4.0, 5.0]\nperiodic = [true, true]\n[[observe]]\n"
      "kind = \"surface-tension\"\nstrain = 2e-3\n[integrator]\nname = \"monte-carlo\"\n";
  const Results bulk = many_body_run(filled, "equilibrate = 300\nduration = 2500");
  for (const char* name : {"surface-tension.stress", "surface-tension.test_area"}) {
    const Scalar& gamma = *bulk.find(name);
    EXPECT_LT(gamma.standard_error, 0.5);
    EXPECT_NEAR(gamma.mean, 0.0, 5.0 * gamma.standard_error) << name;
  }
}

}  // namespace
}  // namespace odpd
