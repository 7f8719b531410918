#include <gtest/gtest.h>

#include <cmath>

#include "odpd/analysis/least_squares.h"
#include "odpd/core/error.h"
#include "support/points.h"

namespace {

using odpd::fit_polynomial;
using odpd::PolynomialFit;

TEST(LeastSquares, ReproducesPolynomials) {
  const std::vector<double> c{0.7, -1.3, 2.1, 0.4};
  for (int degree = 0; degree <= 3; ++degree) {
    std::vector<double> x, y, error;
    for (int k = 0; k < 12; ++k) {
      x.push_back(-2.0 + 0.37 * k);
      error.push_back(0.1 + 0.05 * (k % 4));
      double value = 0.0;
      for (int p = degree; p >= 0; --p) value = value * x.back() + c[static_cast<std::size_t>(p)];
      y.push_back(value);
    }
    const PolynomialFit fit = fit_polynomial(degree, x, y, error);
    ASSERT_EQ(fit.coefficient.size(), static_cast<std::size_t>(degree) + 1);
    for (std::size_t p = 0; p < fit.coefficient.size(); ++p) {
      EXPECT_NEAR(fit.coefficient[p], c[p], 1e-11);
      double sum = 0.0;
      for (std::size_t k = 0; k < y.size(); ++k) sum += fit.weight[p][k] * y[k];
      EXPECT_NEAR(sum, fit.coefficient[p], 1e-12) << "the weights give the coefficient";
    }
    EXPECT_NEAR(fit(0.3),
                c[0] + (degree > 0 ? c[1] * 0.3 : 0.0) + (degree > 1 ? c[2] * 0.09 : 0.0) +
                    (degree > 2 ? c[3] * 0.027 : 0.0),
                1e-11);
    EXPECT_NEAR(fit.reduced_chi_square, 0.0, 1e-18);
  }
}

TEST(LeastSquares, WeighsPointsByTheirErrors) {
  // A constant through two values: the weighted mean.
  const std::vector<double> x{0.0, 1.0}, y{1.0, 4.0}, error{1.0, 2.0};
  const PolynomialFit fit = fit_polynomial(0, x, y, error);
  EXPECT_NEAR(fit.coefficient[0], (1.0 + 4.0 / 4.0) / (1.0 + 1.0 / 4.0), 1e-14);
  EXPECT_NEAR(fit.reduced_chi_square, 0.6 * 0.6 + 2.4 * 2.4 / 4.0, 1e-13);
}

// Over 400 fits of 10 points with true errors: mean reduced chi-square 1 with standard error
// sqrt(2/(8 * 400)); slope variance sum (w e)^2 with relative standard error sqrt(2/400). Bounds:
// 5.
TEST(LeastSquares, ChiSquareAndWeightsAreStatisticallyRight) {
  constexpr std::size_t fits = 400;
  std::vector<double> x, error;
  for (int k = 0; k < 10; ++k) {
    x.push_back(0.1 * k);
    error.push_back(0.2 + 0.03 * k);
  }
  double chi_square = 0.0, square = 0.0, predicted = 0.0;
  for (std::uint64_t seed = 0; seed < fits; ++seed) {
    std::vector<double> y = support::random_numbers(10, seed);
    for (std::size_t k = 0; k < 10; ++k) y[k] = 2.0 - 3.0 * x[k] + error[k] * y[k];
    const PolynomialFit fit = fit_polynomial(1, x, y, error);
    chi_square += fit.reduced_chi_square / fits;
    square += (fit.coefficient[1] + 3.0) * (fit.coefficient[1] + 3.0) / fits;
    predicted = 0.0;
    for (std::size_t k = 0; k < 10; ++k) predicted += std::pow(fit.weight[1][k] * error[k], 2);
  }
  EXPECT_NEAR(chi_square, 1.0, 5.0 * std::sqrt(2.0 / (8.0 * fits)));
  EXPECT_NEAR(square / predicted, 1.0, 5.0 * std::sqrt(2.0 / fits));
}

TEST(LeastSquares, NeedsAsManyPointsAsCoefficients) {
  const std::vector<double> two{0.0, 1.0}, ones{1.0, 1.0};
  EXPECT_THROW(fit_polynomial(2, two, two, ones), odpd::ConfigError);
  const PolynomialFit fit = fit_polynomial(1, two, two, ones);
  EXPECT_NEAR(fit.coefficient[1], 1.0, 1e-13);
  EXPECT_TRUE(std::isnan(fit.reduced_chi_square)) << "no degrees of freedom left";
}

}  // namespace
