// A model whose energy depends on densities: its motion must sample what Monte Carlo samples, which knows no forces.
#include <gtest/gtest.h>

#include "odpd/analysis/block_average.h"
#include "odpd/dynamics/integrator.h"
#include "odpd/operator/edge_sums.h"
#include "support/density_toy.h"

namespace odpd {
namespace {

using support::Crowd;
using support::ToyModel;
using support::ToyParameters;

// Means of U/N, pressure, |F|^2 and the Laplacian of U; 100 particles of two species at density 4, kT = 1.
BlockAverage toy_averages(const std::string& scheme, double dt, std::int64_t steps,
                          ToyParameters toy) {
  constexpr double edge = 5.0;
  constexpr std::size_t count = 100;
  Crowd<2> crowd(count, edge, true);
  const ToyModel<2> model(toy);
  const NoSurroundings<2> nothing({.kT = toy.kT});
  Dynamics<2> dynamics(crowd.box, crowd.particles, model, nothing,
                       make_solver({.name = "pcg", .tolerance = 1e-6}), {});
  const auto integrator = make_integrator<2>(scheme);
  BlockAverage average(4);
  Clock clock{.dt = dt, .equilibration_steps = steps / 20, .total_steps = steps};
  for (; !clock.finished(); clock.advance()) {
    clock.sampled = clock.step >= clock.equilibration_steps && clock.step % 4 == 0;
    const Stage<2>& stage = integrator->step(dynamics, clock).start;
    if (!clock.sampled) continue;
    double virial = 0.0, squares = 0.0, curvature = 0.0;
    for (std::size_t k = 0; k < stage.network.i.size(); ++k)
      virial += stage.network.r[k] * stage.network.f_c[k];
    std::vector<double> laplacian(count, 0.0);
    add_laplacian(stage.network, laplacian);
    for (std::size_t i = 0; i < count; ++i) {
      squares += dot(stage.potential_force[i], stage.potential_force[i]);
      curvature += laplacian[i];
    }
    average.add(std::vector{stage.network.energy() / count,
                            (count * toy.kT + 0.5 * virial) / (edge * edge), squares, curvature});
  }
  return average;
}

double temperature(const BlockAverage& average) { return average.ratio(2, 3); }

const BlockAverage& sampled() {
  static const BlockAverage average = toy_averages("monte-carlo", 1.0, 20000, {.c = 0.5});
  return average;
}

// Standard errors: U 0.0011, p 0.005, temperature 0.0034. Without psi'' the Laplacian would be too small.
TEST(DensityToy, MonteCarloHasTheTemperatureThatForcesAndLaplacianTell) {
  EXPECT_LT(sampled().standard_error(0), 0.002);
  EXPECT_NEAR(temperature(sampled()), 1.0, 0.015);
}

// Standard errors of the difference: U 0.0022, p 0.011; temperature 0.005. The bounds are five of them wide; the scheme's own
// error at this dt is within one or two.
TEST(DensityToy, TrapezoidalSamplesWhatMonteCarloDoes) {
  const BlockAverage average = toy_averages("trapezoidal", 0.01, 40000, {.c = 0.5});
  EXPECT_LT(average.standard_error(0), 0.003);
  EXPECT_LT(average.standard_error(1), 0.02);
  EXPECT_NEAR(average.mean(0), sampled().mean(0), 0.011);
  EXPECT_NEAR(average.mean(1), sampled().mean(1), 0.06);
  EXPECT_NEAR(temperature(average), 1.0, 0.05);
}

// Measured: U lower by 0.06, a temperature of 0.78; 20 standard errors.
TEST(DensityToy, EulerMissesItAndTheTestSeesThat) {
  const BlockAverage average = toy_averages("euler", 0.01, 10000, {.c = 0.5});
  EXPECT_LT(average.mean(0), sampled().mean(0) - 0.03);
  EXPECT_LT(temperature(average), 0.9);
}

// Measured: U higher by 0.24, a pressure of 9.6 instead of 14.2.
TEST(DensityToy, SoDoesAForceWithoutThePartnersDensity) {
  const BlockAverage average =
      toy_averages("trapezoidal", 0.005, 8000, {.c = 0.5, .forgets = true});
  EXPECT_GT(average.mean(0), sampled().mean(0) + 0.1);
  EXPECT_LT(average.mean(1), 0.8 * sampled().mean(1));
}

}  // namespace
}  // namespace odpd
