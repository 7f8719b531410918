// A fluid with densities between frozen walls. A wall's particles have a density and an energy of their own, to which pairs of two of them
// contribute though they are no edges: with these the wall presses back as fluid would, and the bulk has the density that was asked for.
#include <gtest/gtest.h>

#include "support/sdpd_fluid.h"

namespace odpd {
namespace {

// 192 particles of SDPD between walls as they are by default: three layers, as deep as the kernel reaches.
TEST(DensityWalls, TheBulkHasTheDensityAskedFor) {
  const Results results =
      support::sdpd_scene({"box.size=[16.0, 18.0]", "box.periodic=[true, false]",
                           "wall=[{ side = \"y-\" }, { side = \"y+\" }]", "integrator.dt=0.4",
                           "run.equilibrate=40.0", "run.duration=400.0",
                           "observe=[{ kind = \"profile\", fit = \"parabola\", fit_from = 6.0, "
                           "fit_to = 12.0, bins = 18 "
                           "}]"});
  EXPECT_EQ(results.find("alarm_crossings")->mean, 0.0);
  // The number in 96 particles' room varies by its root times sqrt(n kT/K), and forgets that at the rate K/(3 eta): a standard error of 0.001
  // over 400.
  EXPECT_NEAR(results.find("profile.bulk_density")->mean, 0.999, 0.005);
}

}  // namespace
}  // namespace odpd
