// The search for the friction on viscosities that are a formula with noise of known size: no simulation.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "odpd/app/calibration.h"
#include "support/errors.h"

namespace {

using odpd::estimate_friction;
using odpd::next_measurement;
using odpd::ViscosityMeasurement;

struct Search {
  double gamma = 0.0, gamma_error = 0.0;
  std::size_t measurements = 0;
};

// As odpd calibrate does it, with measurements that have the error they are asked for.
Search search(const std::function<double(double)>& viscosity, double eta, double guess,
              double relative_error, bool linear, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  std::vector<ViscosityMeasurement> measured;
  while (const auto plan = next_measurement(measured, eta, guess, relative_error, linear)) {
    const double found =
        viscosity(plan->gamma) * std::exp(plan->relative_error * normal(generator));
    measured.push_back({.gamma = plan->gamma, .eta = found, .error = plan->relative_error * found});
    if (measured.size() > 20) break;
  }
  const auto found = estimate_friction(measured, eta, linear);
  EXPECT_LE(found.relative_error, relative_error * (1.0 + 1e-12));
  return {found.gamma, found.gamma_error(), measured.size()};
}

double massless(double gamma) { return 0.57 * gamma; }
// Friction and inertia; 5 at gamma = 8.0992.
double with_mass(double gamma) { return 0.6 * gamma + 1.138 / gamma; }
// An exponent of 3/4 at eta = 5, well off the 1 of the search's start, and bent.
double bent(double gamma) { return 0.9 * std::sqrt(gamma) + 0.33 * gamma; }

// The root of viscosity(gamma) = 5 to the right of the minimum, by bisection.
double root(const std::function<double(double)>& viscosity) {
  double low = 2.0, high = 100.0;
  for (int k = 0; k < 200; ++k) {
    const double middle = 0.5 * (low + high);
    (viscosity(middle) < 5.0 ? low : high) = middle;
  }
  return low;
}

struct FrictionLaw {
  std::function<double(double)> viscosity;
  bool linear;
};

// Over 200 searches: the answers scatter about the right one by the errors that are stated, and few measurements do.
TEST(Calibration, FindsTheFrictionWithinItsError) {
  for (const FrictionLaw& law : {FrictionLaw{massless, true}, FrictionLaw{massless, false},
                                 FrictionLaw{with_mass, false}, FrictionLaw{bent, false}}) {
    const double right = root(law.viscosity);
    double chi_squared = 0.0, bias = 0.0, most = 0.0;
    constexpr int searches = 200;
    for (unsigned seed = 0; seed < searches; ++seed) {
      const Search s = search(law.viscosity, 5.0, 1.7 * right, 0.02, law.linear, seed + 1);
      const double z = (s.gamma - right) / s.gamma_error;
      chi_squared += z * z / searches;
      bias += z / searches;
      most = std::max(most, static_cast<double>(s.measurements));
      EXPECT_LT(std::abs(z), 4.5);
    }
    // The mean of 200 z^2 has a standard error of 0.1, that of z one of 0.07. The start at exponent 1 pulls answers where
    // the exponent is another, by less than their errors.
    SCOPED_TRACE(law.viscosity(1.0));
    EXPECT_LT(chi_squared, 1.7);
    EXPECT_GT(chi_squared, 0.4);
    EXPECT_LT(std::abs(bias), 0.6);
    EXPECT_LE(most, 6.0);
  }
}

TEST(Calibration, TakesTwoMeasurementsWithoutMass) {
  EXPECT_EQ(search(massless, 5.0, 3.0, 0.02, true, 1).measurements, 2U);
  // An error that one rough measurement has already.
  EXPECT_EQ(search(massless, 5.0, 3.0, 0.2, true, 1).measurements, 1U);
}

// Far off, a leap is bounded and the next measurement goes on from there.
TEST(Calibration, ComesFromFarAway) {
  for (const double guess : {0.02, 3000.0}) {
    const Search s = search(bent, 5.0, guess, 0.02, false, 7);
    EXPECT_NEAR(s.gamma, root(bent), 5.0 * s.gamma_error);
    EXPECT_GT(s.measurements, 3U);
    EXPECT_LE(s.measurements, 12U);
  }
}

// At mass 0 all frictions are one fluid: measurements pool as the inverse squares of their errors.
TEST(Calibration, PoolsMeasurementsOfAMasslessFluid) {
  const std::vector<ViscosityMeasurement> measured{
      {.gamma = 2.0, .eta = 1.0, .error = 0.03},
      {.gamma = 20.0, .eta = 10.0, .error = 0.4},
      {.gamma = 1.0, .eta = 7.0, .error = 0.01, .doubled = true},
      {.gamma = 1.0, .eta = -7.0, .error = 9.0}};
  const auto found = estimate_friction(measured, 5.0, true);
  EXPECT_NEAR(found.gamma, 10.0, 1e-12);
  EXPECT_NEAR(found.relative_error, 0.024, 1e-12);
  EXPECT_NEAR(found.gamma_error(), 0.24, 1e-11);
}

// A gas: its viscosity falls with friction, to a least one of 2 sqrt(0.6 4) = 3.1.
TEST(Calibration, SaysWhereThereIsNoSuchFriction) {
  const auto gas = [](double gamma) { return 0.6 * gamma + 4.0 / gamma; };
  support::expect_error<odpd::SolverError>([&] { search(gas, 1.0, 1.5, 0.02, false, 1); },
                                           {"hardly grows with gamma", "larger eta"});
  support::expect_error<odpd::SolverError>([] { estimate_friction({}, 1.0, true); },
                                           {"good enough"});
}

}  // namespace
