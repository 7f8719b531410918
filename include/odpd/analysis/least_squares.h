#pragma once
// Weighted least squares of a polynomial, and the weights with which each point enters each coefficient:
//
//   minimise sum_k (y_k - sum_p c_p x_k^p)^2 / error_k^2,     c_p = sum_k weight[p][k] y_k
//
// The weights let a coefficient's error be found from correlated points by block averaging.
#include <span>
#include <vector>

namespace odpd {

struct PolynomialFit {
  std::vector<double> coefficient;          ///< degree + 1 values
  std::vector<std::vector<double>> weight;  ///< [coefficient][point]
  double reduced_chi_square =
      0.0;  ///< over points - degree - 1 degrees of freedom; NaN when there are none

  double operator()(double x) const {
    double y = 0.0;
    for (std::size_t p = coefficient.size(); p-- > 0;) y = y * x + coefficient[p];
    return y;
  }
};

/// All spans have one entry per point; error > 0. Throws ConfigError with fewer points than coefficients.
PolynomialFit fit_polynomial(int degree, std::span<const double> x, std::span<const double> y,
                             std::span<const double> error);

}  // namespace odpd
