// Many-body DPD against reference values: pressures of the bulk liquid, and tension of a slab.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "odpd/app/simulation.h"

namespace odpd {
namespace {

template <int D>
Results liquid_run(const std::string& fluid, const std::string& scene) {
  const Config config = Config::from_text(
      "dimension = " + std::to_string(D) +
          "\nseed = 1\n[solver]\ntolerance = 1e-4\n[fluid]\nmodel = \"mdpd\"\nA = -40.0\n"
          "r_d = 0.75\ngamma = 4.5\nkT = 1.0\n" +
          fluid + "\n" + scene,
      "case.toml");
  Simulation<D> simulation(config, read_case(config, "liquid"));
  simulation.run([] { return false; }, [] {});
  return simulation.results();
}

void expect_value(const Results& results, const char* name, double value, double tolerance) {
  const Scalar& x = *results.find(name);
  std::printf("%s %.4f(%.4f)\n", name, x.mean, x.standard_error);
  EXPECT_LT(x.standard_error, tolerance / 3.0);
  EXPECT_NEAR(x.mean, value, tolerance) << name;
}

// The reference values are those of another program (errors 0.05 to 0.08 in 3D; in 2D the density of zero pressure is known to 0.002). Each
// bound is several errors of the difference wide.
TEST(LongManyBody, TheLiquidHasItsPressure) {
  const std::string cube = "[box]\nsize = [5.0, 5.0, 5.0]\nperiodic = [true, true, true]\n",
                    square = "[box]\nsize = [14.0, 14.0]\nperiodic = [true, true]\n",
                    sampled =
                        "[integrator]\nname = \"monte-carlo\"\n[run]\nequilibrate = 1000\n"
                        "duration = 7000\n";
  const auto bulk = [](const char* B, const char* density) {
    return std::string("filled = true\nB = ") + B + "\ndensity = " + density;
  };
  const auto pressure_3d = [&](const char* density, double pressure, double tolerance) {
    expect_value(liquid_run<3>(bulk("25.0", density), cube + sampled), "pressure", pressure,
                 tolerance);
  };
  pressure_3d("5.8", -11.73, 0.25);
  pressure_3d("6.08", 0.16, 0.25);
  pressure_3d("6.4", 17.45, 0.25);
  pressure_3d("7.0", 60.96, 0.4);
  // Zero at the density of the liquid beside its vapour.
  expect_value(liquid_run<2>(bulk("25.0", "4.142"), square + sampled), "pressure", 0.0, 0.2);
  expect_value(liquid_run<2>(bulk("40.0", "3.304"), square + sampled), "pressure", 0.0, 0.2);
}

// Of another program, by stress and by test area. Both routes go over the same configurations.
TEST(LongManyBody, ASlabHasItsTensionByBothRoutes) {
  const Results slab =
      liquid_run<3>("mass = 0.05\nB = 25.0\ndensity = 6.08",
                    "[box]\nsize = [6.0, 6.0, 18.0]\nperiodic = [true, true, true]\n[start]\n"
                    "region = { from = [0.0, 0.0, 4.5], to = [6.0, 6.0, 13.5] }\n[integrator]\n"
                    "name = \"monte-carlo\"\n[run]\nequilibrate = 1000\nduration = 12000\n"
                    "[[observe]]\nkind = \"surface-tension\"\n");
  const Scalar &stress = *slab.find("surface-tension.stress"),
               &area = *slab.find("surface-tension.test_area");
  std::printf("tension %.4f(%.4f), %.4f(%.4f)\n", stress.mean, stress.standard_error, area.mean,
              area.standard_error);
  EXPECT_LT(stress.standard_error, 0.2);
  EXPECT_NEAR(stress.mean, 7.38, 3.0 * std::hypot(stress.standard_error, 0.14));
  EXPECT_NEAR(area.mean, 7.27, 3.0 * std::hypot(area.standard_error, 0.20));
  EXPECT_NEAR(stress.mean, area.mean, 0.02);
}

}  // namespace
}  // namespace odpd
