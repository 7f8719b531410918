#include "odpd/analysis/least_squares.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <utility>

#include "odpd/core/error.h"
#include "odpd/core/index.h"

namespace odpd {

namespace {

// Inverse of a small symmetric positive definite matrix by Gauss-Jordan elimination.
std::vector<std::vector<double>> inverse(std::vector<std::vector<double>> a) {
  const std::size_t n = a.size();
  std::vector<std::vector<double>> b(n, std::vector<double>(n, 0.0));
  for (std::size_t k = 0; k < n; ++k) b[k][k] = 1.0;
  for (std::size_t k = 0; k < n; ++k) {
    const double pivot = a[k][k];
    for (std::size_t c = 0; c < n; ++c) {
      a[k][c] /= pivot;
      b[k][c] /= pivot;
    }
    for (std::size_t r = 0; r < n; ++r) {
      if (r == k) continue;
      const double factor = a[r][k];
      for (std::size_t c = 0; c < n; ++c) {
        a[r][c] -= factor * a[k][c];
        b[r][c] -= factor * b[k][c];
      }
    }
  }
  return b;
}

}  // namespace

PolynomialFit fit_polynomial(int degree, std::span<const double> x, std::span<const double> y,
                             std::span<const double> error) {
  const auto terms = index(degree) + 1;
  if (x.size() < terms)
    throw ConfigError(fmt::format(
        "a fit of degree {} needs at least {} bins, {} lie in its range: widen fit_from/fit_to "
        "or use more bins",
        degree, terms, x.size()));
  std::vector<std::vector<double>> normal(terms, std::vector<double>(terms, 0.0));
  for (std::size_t k = 0; k < x.size(); ++k)
    for (std::size_t p = 0; p < terms; ++p)
      for (std::size_t q = 0; q < terms; ++q)
        normal[p][q] += std::pow(x[k], static_cast<double>(p + q)) / (error[k] * error[k]);
  const std::vector<std::vector<double>> covariance = inverse(normal);
  PolynomialFit fit;
  fit.coefficient.assign(terms, 0.0);
  fit.weight.assign(terms, std::vector<double>(x.size(), 0.0));
  for (std::size_t p = 0; p < terms; ++p)
    for (std::size_t k = 0; k < x.size(); ++k) {
      for (std::size_t q = 0; q < terms; ++q)
        fit.weight[p][k] +=
            covariance[p][q] * std::pow(x[k], static_cast<double>(q)) / (error[k] * error[k]);
      fit.coefficient[p] += fit.weight[p][k] * y[k];
    }
  double chi_square = 0.0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    const double miss = (y[k] - fit(x[k])) / error[k];
    chi_square += miss * miss;
  }
  fit.reduced_chi_square = x.size() > terms ? chi_square / static_cast<double>(x.size() - terms)
                                            : std::numeric_limits<double>::quiet_NaN();
  return fit;
}

}  // namespace odpd
