// Free disks in a fluid sheared by its sliding images.
#include <gtest/gtest.h>

#include <cmath>

#include "odpd/app/simulation.h"

namespace odpd {
namespace {

// A disk without torque turns with half the vorticity, -rate/2 for a flow along x that varies along y, wherever the box is cut
// (a disk across the faces whose parts had the velocities of two images would turn as if thrown). The power of the images is
// the stress times the rate, if forces on disks act at their centres.
TEST(ShearedDisks, TurnAtHalfTheRateAndTheStressHasThePowerOfTheImages) {
  const Config config =
      open_case(std::string(ODPD_SOURCE_DIR) + "/cases/04_equilibrium/case.toml",
                {"run.equilibrate=1", "run.duration=16", "check=[]", "integrator.dt=0.01",
                 "shear={rate=4.0}", "body=[{name=\"disk\", shape=\"disk\", radius=0.5, count=4}]",
                 "observe=[{kind=\"bodies\"}, {kind=\"heat\"}, {kind=\"viscosity\"}]"});
  Simulation<2> simulation(config, read_case(config, "disks"));
  simulation.run([] { return false; }, [] {});
  const Results results = simulation.results();
  const Scalar& turn = *results.find("bodies.disk.angular_velocity");
  EXPECT_LT(turn.standard_error, 0.15);
  EXPECT_NEAR(turn.mean, -2.0, 4.0 * turn.standard_error) << turn.standard_error;
  const Scalar& power = *results.find("heat.shear");
  const Scalar& eta = *results.find("viscosity");
  EXPECT_LT(eta.standard_error, 0.05 * eta.mean);
  EXPECT_NEAR(power.mean / 16.0, eta.mean,
              4.0 * std::hypot(power.standard_error / 16.0, eta.standard_error))
      << eta.standard_error;
  EXPECT_LT(results.find("heat.residual")->mean, 1e-2);
  for (const char* c : {"x", "y"}) {
    const Scalar& v = *results.find(std::string("bodies.disk.velocity.") + c);
    EXPECT_NEAR(v.mean, 0.0, 4.0 * v.standard_error) << "relative to the flow, along " << c;
  }
}

}  // namespace
}  // namespace odpd
