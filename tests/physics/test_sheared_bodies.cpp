// Free disks in a fluid sheared by its sliding images.
#include <gtest/gtest.h>

#include "odpd/app/simulation.h"

namespace odpd {
namespace {

// A disk without torque turns with half the vorticity, -rate/2 for a flow along x that varies along y, wherever the box is cut
// (a disk across the faces whose parts had the velocities of two images would turn as if thrown). Measured over t = 300 at rate
// 1: -0.519 +- 0.018; at high rates it turns faster, between walls as well (docs/rheology.md). The power of the images is the
// stress times the rate, if forces on disks act at their centres. Standard errors here: 0.04 and 1 %.
TEST(ShearedDisks, TurnAtHalfTheRateAndTheStressHasThePowerOfTheImages) {
  const double rate = 2.0;
  const Config config =
      open_case(std::string(ODPD_SOURCE_DIR) + "/cases/04_equilibrium/case.toml",
                {"run.equilibrate=1", "run.duration=20", "check=[]", "integrator.dt=0.02",
                 "shear={rate=2.0}", "body=[{name=\"disk\", shape=\"disk\", radius=0.5, count=4}]",
                 "observe=[{kind=\"bodies\"}, {kind=\"heat\"}, {kind=\"viscosity\"}]"});
  Simulation<2> simulation(config, read_case(config, "disks"));
  simulation.run([] { return false; }, [] {});
  const Results results = simulation.results();
  const auto scalar = [&](const std::string& name) { return *results.find(name); };
  const Scalar turn = scalar("bodies.disk.angular_velocity");
  EXPECT_LT(turn.standard_error, 0.08);
  EXPECT_NEAR(turn.mean, -0.5 * rate, 5.0 * turn.standard_error) << turn.standard_error;
  const Scalar power = scalar("heat.shear"), eta = scalar("viscosity");
  EXPECT_LT(eta.standard_error, 0.03 * eta.mean);
  EXPECT_NEAR(power.mean / (rate * rate), eta.mean, 4.0 * eta.standard_error);
  EXPECT_LT(scalar("heat.residual").mean, 1e-2);
  for (const char* c : {"x", "y"}) {
    const Scalar v = scalar(std::string("bodies.disk.velocity.") + c);
    EXPECT_LT(v.standard_error, 0.1);
    EXPECT_NEAR(v.mean, 0.0, 5.0 * v.standard_error) << "relative to the flow, along " << c;
  }
}

}  // namespace
}  // namespace odpd
