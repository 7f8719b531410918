// An SDPD fluid at equilibrium, to the accuracy of its reference values.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <string>
#include <utility>

#include "support/sdpd_fluid.h"

namespace odpd {
namespace {

using support::sdpd_144;
using support::sdpd_144_without;
using support::sdpd_400;
using support::sdpd_results;
using support::SdpdReference;

void expect_reference(const Results& results, const char* name, double mean, double error,
                      double most) {
  const Scalar* scalar = results.find(name);
  ASSERT_NE(scalar, nullptr);
  std::printf("%-20s %.6f(%.6f), reference %.6f(%.6f)\n", name, scalar->mean,
              scalar->standard_error, mean, error);
  EXPECT_LT(scalar->standard_error, most * mean) << name;
  EXPECT_NEAR(scalar->mean, mean, 3.0 * std::hypot(scalar->standard_error, error)) << name;
}

TEST(SdpdReferences, MonteCarlo) {
  for (const SdpdReference& fluid : {sdpd_400, sdpd_144, sdpd_144_without}) {
    const Results r = sdpd_results(fluid, {.equilibrate = 500.0, .duration = 10000.0});
    expect_reference(r, "energy_per_particle", fluid.energy, fluid.energy_error, 0.006);
    expect_reference(r, "pressure", fluid.pressure, fluid.pressure_error,
                     fluid.background > 0.0 ? 1e-4 : 3e-3);
    EXPECT_NEAR(r.find("config_temperature")->mean, 0.01, 1e-4);
  }
}

// K dt/eta = 0.2. Standard error of U: 0.16 %, of the temperature: 0.2 %; of the shorter run twice that.
Results sdpd_motion_at_length(const char* integrator, double duration) {
  return sdpd_results(sdpd_144, {.integrator = integrator,
                                 .dt = 0.2,
                                 .equilibrate = 200.0,
                                 .duration = duration,
                                 .every = 4});
}

TEST(SdpdReferences, TrapezoidalIsWithinHalfAPercent) {
  const Results r = sdpd_motion_at_length("trapezoidal", 16000.0);
  const double energy = r.find("energy_per_particle")->mean,
               temperature = r.find("config_temperature")->mean;
  std::printf("trapezoidal: U = %.6f(%.6f), T = %.5f kT\n", energy,
              r.find("energy_per_particle")->standard_error, temperature / 0.01);
  EXPECT_NEAR(energy, sdpd_144.energy, 0.005 * sdpd_144.energy);
  EXPECT_NEAR(temperature, 0.01, 1e-4);
}

TEST(SdpdReferences, EulerIsNotAndTheTestSeesThat) {
  const Results r = sdpd_motion_at_length("euler", 4000.0);
  const double energy = r.find("energy_per_particle")->mean;
  std::printf("euler: U = %.6f(%.6f), T = %.5f kT\n", energy,
              r.find("energy_per_particle")->standard_error,
              r.find("config_temperature")->mean / 0.01);
  EXPECT_LT(energy, (1.0 - 0.02) * sdpd_144.energy);
}

// Sheared by sliding images, a Peclet number of 1: 0.983(2) and 0.992(2) of the viscosity asked for, by another program. Standard errors
// here 0.005 and 0.004.
TEST(SdpdReferences, ViscosityIsWithinTwoPercentOfTheOneAskedFor) {
  for (const auto& [lines, expected] : {std::pair{"", 0.983}, {"support = 4.0\n", 0.992}}) {
    const std::string more =
        std::string(lines) +
        "[shear]\nrate = 0.01\n[[observe]]\nkind = \"viscosity\"\ncontrol = true\nevery = 4\n";
    const Results r = sdpd_results(sdpd_400, {.integrator = "trapezoidal",
                                              .dt = 0.3,
                                              .equilibrate = 300.0,
                                              .duration = 3000.0,
                                              .more = more.c_str()});
    const Scalar& eta = *r.find("viscosity.stress");
    std::printf("viscosity %.4f(%.4f), expected %.3f\n", eta.mean, eta.standard_error, expected);
    EXPECT_LT(eta.standard_error, 0.007);
    EXPECT_NEAR(eta.mean, expected, 0.025);
  }
}

}  // namespace
}  // namespace odpd
