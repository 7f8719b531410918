// Rigid disks and molecules in SDPD fluids, in runs long enough to tell per cents.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "odpd/app/simulation.h"

namespace odpd {
namespace {

constexpr const char* fluid_of_kappa_100 = R"(
dimension = 2
[box]
size = [36.0, 36.0]
periodic = [true, true]
[fluid]
model = "sdpd"
density = 1.0
kT = 0.01
eta = 1.0
bulk_modulus = 1.0
[integrator]
dt = 0.3
[output]
trajectory_every = 0
)";

Results long_run(const std::vector<std::string>& overrides) {
  const Config config = Config::from_text(fluid_of_kappa_100, "case.toml", overrides);
  Simulation<2> simulation(config, read_case(config, "sdpd"));
  simulation.run([] { return false; }, [] {});
  return simulation.results();
}

// Half the vorticity for the central form: -0.508(7) of the rate. In the classical form pairs exert torques, of which those inside the body are
// missing: -0.768(9).
TEST(LongSdpdBodies, ADiskOfTwoSupportsTurnsAtHalfTheRateInTheCentralFormOnly) {
  const auto turn = [](const std::string& form, double dt) {
    const Results results = long_run(
        {"shear={rate=0.03}", "fluid.form=" + form, "integrator.dt=" + std::to_string(dt),
         "run={equilibrate=100.0, duration=2000.0}",
         "body=[{name=\"disk\", shape=\"disk\", radius=6.0, rings=6, positions=[{at=[18.0, "
         "18.0]}]}]",
         "observe=[{kind=\"bodies\"}]"});
    Scalar speed = *results.find("bodies.disk.angular_velocity");
    speed.mean /= 0.03;
    speed.standard_error /= 0.03;
    std::printf("%s: %.4f(%.4f) of the rate\n", form.c_str(), speed.mean, speed.standard_error);
    return speed;
  };
  const Scalar central = turn("central", 0.3), classical = turn("classical", 0.2);
  EXPECT_LT(central.standard_error, 0.012);
  EXPECT_NEAR(central.mean, -0.5, 0.035);
  EXPECT_NEAR(classical.mean, -0.76, 0.04);
}

}  // namespace
}  // namespace odpd
