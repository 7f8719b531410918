// Bodies, bonds and flow in SDPD fluids.
#include <gtest/gtest.h>

#include <cmath>

#include "support/sdpd_fluid.h"

namespace odpd {
namespace {

// Pairs of the central form exert no torque on each other, so that a free disk turns with half the vorticity, -rate/2. The classical
// form, whose pairs inside a body are no edges, turns it at -.7 of the rate (docs/density-fluids.md). Standard error here:
// 0.02. What friction heats is the work of the images, which is the stress times the rate.
TEST(SdpdBodies, ADiskInShearTurnsAtHalfTheRateAndTheHeatIsTheWork) {
  const double rate = 0.1;
  const Results results = support::sdpd_scene(
      {"box.size=[18.0, 18.0]", "shear={rate=0.1}", "run={equilibrate=10.0, duration=100.0}",
       "body=[{name=\"disk\", shape=\"disk\", radius=3.0, rings=3, positions=[{at=[9.0, "
       "9.0]}]}]",
       "observe=[{kind=\"bodies\"}, {kind=\"heat\"}, {kind=\"viscosity\"}]"});
  const auto mean = [&](const std::string& name) { return results.find(name)->mean; };
  const Scalar& turn = *results.find("bodies.disk.angular_velocity");
  EXPECT_LT(turn.standard_error, 0.04 * rate);
  EXPECT_NEAR(turn.mean / rate, -0.5, 0.1) << turn.standard_error;
  EXPECT_LT(mean("heat.residual"), 1e-3);
  EXPECT_NEAR(mean("heat.produced") + mean("heat.energy_rate"), mean("heat.shear"),
              1e-3 * mean("heat.shear"));
  EXPECT_NEAR(mean("heat.shear") / (rate * rate), mean("viscosity"), 0.03 * mean("viscosity"));
}

// A rigid disk of seven particles and five dimers in a fluid of 47. Monte Carlo moves them by trial, without forces. Standard errors of the
// differences, which in so short a run are uncertain themselves: energy 0.0002, pressure 0.0005, length 0.01, temperature 2 %. Where densities
// lack the pairs inside the disk, the energy of the motion is 0.0085 below, the pressure 0.013.
TEST(SdpdBodies, DiskAndDimersSampleWhatMonteCarloDoes) {
  const auto sample = [](const std::string& scheme) {
    return support::sdpd_scene(
        {"integrator={dt=0.2, name=\"" + scheme + "\"}", "run={equilibrate=20.0, duration=300.0}",
         "box.size=[8.0, 8.0]",
         "body=[{name=\"disk\", shape=\"disk\", radius=0.9, rings=1, positions=[{at=[4.0, 4.0]}]}]",
         "molecule=[{name=\"dimer\", species=\"fluid\", shape=\"chain\", spacing=0.8, H=0.5, "
         "count=5}]",
         "observe=[{kind=\"molecules\"}, {kind=\"thermo\", every=2}]"});
  };
  const Results moved = sample("trapezoidal"), tried = sample("monte-carlo");
  const auto expect_same = [&](const std::string& name, double bound) {
    const Scalar &a = *moved.find(name), &b = *tried.find(name);
    EXPECT_LT(std::hypot(a.standard_error, b.standard_error), bound / 3.5) << name;
    EXPECT_NEAR(a.mean, b.mean, bound) << name;
  };
  expect_same("energy_per_particle", 0.0012);
  expect_same("pressure", 0.0035);
  expect_same("molecules.dimer.bond_length", 0.06);
  EXPECT_NEAR(moved.find("config_temperature")->mean, 0.01, 0.0012);
}

}  // namespace
}  // namespace odpd
