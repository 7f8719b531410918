#pragma once
// What viscosities of several wave numbers are handed on as, whatever they were measured by: tables by k and by frequency,
// charts, and
//
//   eta(k) = eta_0 + a k^2       at the smallest k (Palmer 1994), by least squares with the errors of eta(k) as weights.
#include <complex>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "odpd/analysis/results.h"

namespace odpd {

struct ModeResults {
  std::string name;                   ///< of the observer
  std::vector<std::int64_t> numbers;  ///< waves in the edge of the box, ascending
  std::vector<double> k;              ///< of each

  /// <name>.<what>.<wave + 1>
  std::string scalar(const std::string& what, std::size_t wave) const;

  /// A function of eta(k) of all wave numbers, and its standard error: all k see the same configurations, so that errors do not
  /// simply add up.
  using OfViscosities = std::function<double(const std::vector<double>& eta)>;
  using ErrorOf = std::function<double(const OfViscosities& function)>;
  /// <name>.eta_0, <name>.curvature and a note of the range from <name>.eta.1 to that of the last of `waves` wave numbers; NaN
  /// where one of these has no error.
  void add_extrapolation(Results& results, std::size_t waves, const ErrorOf& error_of) const;

  /// number, k, and each of `what` with its error.
  Table by_k(const Results& results, const std::vector<std::string>& what) const;
  /// eta, eta_inf, and the extrapolation over its `waves` wave numbers.
  Chart chart(const Results& results, std::size_t waves) const;

  /// eta*(omega) of a wave number.
  using Viscosity = std::function<std::complex<double>(std::size_t wave, double omega)>;
  /// G' = - omega Im eta* and eta' = Re eta* at frequencies from lowest to highest.
  Table moduli(double lowest, double highest, const Viscosity& viscosity) const;
  /// G' by omega, on logarithmic axes where all of it that is to be seen is positive.
  Chart modulus_chart(const Table& moduli, bool positive) const;
};

}  // namespace odpd
