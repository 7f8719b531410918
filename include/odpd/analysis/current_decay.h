#pragma once
// What the decay of a transverse current tells of its rate lam = eta(k) k^2/rho, from c(t) at equal intervals:
//
//   exponential   c(t)/c(0) = exp(-lam t)
//   Maxwell       c(t)/c(0) = exp(-t/2tau) [cosh(W t/2tau) + sinh(W t/2tau)/W],   W = sqrt(1 - 4 tau lam)       (Hess 2002)
//   area          1/lam = int_0^inf c/c(0) dt
//
// Maxwell's is that of the memory G(t) = (eta/tau) exp(-t/tau), with a W that may be imaginary. To first order in lam tau it
// is (1 + lam tau) exp(-lam t) once the memory is over. A tau below 0 is taken to say so alone: friction is larger at first,
// and the slow decay begins below 1. Fits are unweighted least squares.
#include <array>
#include <complex>
#include <span>

namespace odpd {

struct MaxwellFit {
  double rate = 0.0, tau = 0.0;  ///< lam and tau; NaN where there is no fit

  /// c(t)/c(0).
  double operator()(double t) const;
  /// interval (c(t)/2 + c(t + interval) + c(t + 2 interval) + ...)/c(0).
  double area_beyond(double t, double interval) const;

 private:
  struct Term {
    std::complex<double> amplitude, rate;
  };
  std::array<Term, 2> terms() const;
};

/// c: values 0, 1, 2, ... intervals apart. The rate; NaN where c does not decay.
double fit_exponential(std::span<const double> c, double interval);
MaxwellFit fit_maxwell(std::span<const double> c, double interval);

/// Area under c/c(0) by the trapezoidal rule up to c[join] and by the fit from there on.
double decay_area(std::span<const double> c, double interval, std::size_t join,
                  const MaxwellFit& fit);

}  // namespace odpd
