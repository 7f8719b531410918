// The series of bodies in periodic cells against published numbers and against sums over Fourier modes; and the radius of a small
// disk, measured.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "odpd/app/hydrodynamic_radius.h"

namespace {

using odpd::BodyInCell;
using odpd::Measured;

using std::numbers::pi;

// Drag over Stokes' on spheres in a simple cubic lattice, at volume fractions c: Zick & Homsy 1982, table 2.
TEST(HydrodynamicRadius, DragOfSpheresInACubicLattice) {
  const std::vector<std::pair<double, double>> table{
      {0.027, 2.008}, {0.064, 2.810}, {0.125, 4.292}, {0.216, 7.442}};
  for (const auto& [c, drag] : table) {
    const double edge = 3.0, a = edge * std::cbrt(0.75 * c / pi);
    EXPECT_NEAR(1.0 / (6.0 * pi * a * odpd::eta_mobility(3, a, edge)), drag, 0.01 * drag) << c;
  }
  // Hasimoto 1959.
  const double a = 0.01;
  EXPECT_NEAR(6.0 * pi * a * odpd::eta_mobility(3, a, 1.0), 1.0 - 2.837297 * a, 1e-5);
}

// F/(eta U) of cylinders in a square lattice: Sangani & Acrivos 1982, table 1.
TEST(HydrodynamicRadius, DragOfDisksInASquareLattice) {
  const std::vector<std::pair<double, double>> table{{0.05, 15.56}, {0.10, 24.83}, {0.20, 51.53}};
  for (const auto& [c, drag] : table) {
    const double edge = 3.0, a = edge * std::sqrt(c / pi);
    EXPECT_NEAR(1.0 / odpd::eta_mobility(2, a, edge), drag, 0.016 * drag) << c;
  }
}

// Sum over the modes k = 2 pi m/L, k != 0, of weight(k)/V up to a cutoff, where weight(k) is spherically symmetric on average.
double sum_over_modes(int dimension, double edge, int most,
                      const std::function<double(double)>& weight) {
  double sum = 0.0;
  const int deep = dimension > 2 ? most : 0;
  for (int x = -most; x <= most; ++x)
    for (int y = -most; y <= most; ++y)
      for (int z = -deep; z <= deep; ++z) {
        const int square = x * x + y * y + z * z;
        if (square > 0 && square <= most * most)
          sum += weight(2.0 * pi / edge * std::sqrt(static_cast<double>(square)));
      }
  return sum / std::pow(edge, dimension);
}

// Forces on a surface that turns or moves as without images: exact in the orders that these series have before reflections.
TEST(HydrodynamicRadius, MobilitiesAreSumsOverModes) {
  const double a = 0.15, edge = 1.0;
  const int most = 40;
  const double end = 2.0 * pi * most;
  // Translation, 2/3 of directions: (2/3) j0(ka)^2/k^2; beyond the cutoff sin^2 is 1/2.
  const auto j0 = [](double x) { return std::sin(x) / x; };
  const double moved =
      sum_over_modes(3, edge, most,
                     [&](double k) { return 2.0 / 3.0 * std::pow(j0(k * a) / k, 2); }) +
      1.0 / (6.0 * pi * pi * a * a * end);
  EXPECT_NEAR(odpd::eta_mobility(3, a, edge) / moved, 1.0, 2e-3);
  // Rotation: (3/2) (j1(ka)/(ka))^2; beyond, cos^2 is 1/2.
  const auto j1 = [](double x) { return (std::sin(x) / x - std::cos(x)) / x; };
  const double turned =
      sum_over_modes(3, edge, most,
                     [&](double k) { return 1.5 * std::pow(j1(k * a) / (k * a), 2); }) +
      3.0 / (8.0 * pi * pi * std::pow(a, 4) * end);
  EXPECT_NEAR(odpd::radius_of_rotation(3, turned, edge) / a, 1.0, 5e-4);
  // 2D: (J1(ka)/(ka))^2; beyond, J1^2 is 1/(pi k a).
  const double disk = sum_over_modes(2, edge, 200,
                                     [&](double k) {
                                       return std::pow(std::cyl_bessel_j(1.0, k * a) / (k * a), 2);
                                     }) +
                      1.0 / (4.0 * pi * pi * std::pow(a, 3) * 200.0 * 2.0 * pi);
  EXPECT_NEAR(odpd::radius_of_rotation(2, disk, edge) / a, 1.0, 1.5e-3);
}

TEST(HydrodynamicRadius, SeriesAreInverted) {
  for (const int dimension : {2, 3})
    for (const double a : {0.05, 0.3, 0.55})
      EXPECT_NEAR(odpd::radius_of_mobility(dimension, odpd::eta_mobility(dimension, a, 2.0), 2.0),
                  a, 1e-9);
  EXPECT_TRUE(std::isnan(odpd::radius_of_mobility(2, 0.001, 2.0)));
  EXPECT_TRUE(std::isnan(odpd::radius_of_mobility(3, -1.0, 2.0)));
}

// A sphere that takes n v_ex of the fluid's particles and has p of its own. All N have the opposite force, and velocities are
// relative to the mean of all of them.
TEST(HydrodynamicRadius, OfAMobilityRelativeToAllParticles) {
  const double n = 3.0, a = 1.0, edge = 6.0, eta = 2.0, v_ex = 5.0;
  const double volume = edge * edge * edge;
  const auto fluid = static_cast<std::int64_t>(n * (volume - v_ex));  // 633
  for (const std::int64_t sites : {10, 200}) {
    const double all = static_cast<double>(fluid + sites), own = static_cast<double>(sites);
    // Force on the body beyond its share, as a pressure gradient over the cell: Hasimoto's F is V/(V - v_ex) of it. Relative to
    // the cell's mean the body has U; the fluid, (V - v_ex)/V of the cell, has the rest.
    const double share = (volume - v_ex) / volume;
    const double U = (1.0 - own / all) / share * odpd::eta_mobility(3, a, edge) / eta;
    const double to_fluid = U / share;
    const double to_all = to_fluid * (1.0 - own / all);
    const BodyInCell cell{.dimension = 3,
                          .edge = edge,
                          .particles = fluid + sites,
                          .sites = sites,
                          .translation = {to_all, 0.02 * to_all},
                          .density = {n, 0.0}};
    const Measured radius = odpd::drag_radius(cell, {eta, n, 2.0});
    EXPECT_NEAR(radius.value, a, 1e-9) << sites;
    // da/a = -dU/U/(1 + 2.84 a/(L - 2.84 a)), nearly.
    EXPECT_NEAR(radius.error, 0.02 * (1.0 - 2.84 / 6.0), 0.001);
    EXPECT_NEAR(odpd::excluded_volume(cell).value, v_ex, 1e-9);
    // A fluid of another density has another viscosity.
    EXPECT_NEAR(odpd::drag_radius(cell, {eta * 1.21, 1.1 * n, 2.0}).value, a, 1e-9);
    EXPECT_NEAR(odpd::drag_radius(cell, {eta, 1.1 * n, 0.0}).value, a, 1e-9);
  }
}

TEST(HydrodynamicRadius, MeanAndExtrapolation) {
  const std::vector<Measured> values{{1.0, 0.1}, {1.3, 0.1}, {1.3, 0.1}};
  const Measured mean = odpd::weighted_mean(values);
  EXPECT_NEAR(mean.value, 1.2, 1e-12);
  // chi^2 = 6 for two degrees of freedom.
  EXPECT_NEAR(mean.error, 0.1, 1e-12);
  const std::vector<Measured> line{
      {1.0 + 0.5 / 4.0, 0.01}, {1.0 + 0.5 / 6.0, 0.02}, {1.0 + 0.5 / 8.0, 0.03}};
  const std::vector<double> edges{4.0, 6.0, 8.0};
  EXPECT_NEAR(odpd::extrapolated(line, edges).value, 1.0, 1e-12);
  EXPECT_GT(odpd::extrapolated(line, edges).error, 0.03);
  EXPECT_TRUE(std::isnan(odpd::extrapolated(std::span(line).first(1), edges).value));
}

}  // namespace
