#pragma once
// Integrals over an interval by the double-exponential rule (Takahasi & Mori 1974): with r = a + (b - a)/(1 + exp(-pi sinh t)),
//
//   int_a^b f dr = sum over t = 0, +-h, +-2h, ... of f(r(t)) dr/dt h
//
// exponentially accurate in 1/h for f smooth inside, whatever power of the distance it goes with at the ends, if only it is integrable.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace odpd {

/// Integrals of all components of f(r) (a std::array of N) over a < r < b. h is halved until they settle to about 14 digits,
/// less those that a and b have in common, or at most to 1/2048, where f has a kink inside. What is not finite in f is so in the result.
template <std::size_t N, class Function>
std::array<double, N> integrate(const Function& f, double a, double b) {
  using Values = std::array<double, N>;
  constexpr double last = 5.4;  // ends are left out up to 1e-150 of the interval
  constexpr double coarsest = 1.0 / 8.0, finest = 1.0 / 2048.0;
  // Where the interval is narrow for what r can tell apart, nodes at its ends are lost to rounding.
  const double narrow = std::max(std::abs(a), std::abs(b)) / (b - a);
  const double tolerance = 1e-14 * (narrow > 100.0 ? narrow : 1.0);
  Values sum{}, size{}, integral{};
  const auto add = [&](double t) {
    // Of the interval, from its nearer end, which keeps all digits of it.
    const double away = std::exp(-std::numbers::pi * std::sinh(std::abs(t)));
    const double part = away / (1.0 + away);
    const double r = t < 0.0 ? a + (b - a) * part : b - (b - a) * part;
    if (!(r > a && r < b)) return;
    const double weight =
        (b - a) * std::numbers::pi * std::cosh(t) * away / ((1.0 + away) * (1.0 + away));
    const Values value = f(r);
    for (std::size_t k = 0; k < N; ++k) {
      sum[k] += weight * value[k];
      size[k] += weight * std::abs(value[k]);
    }
  };
  add(0.0);
  for (double h = coarsest; h >= finest; h *= 0.5) {
    // Those of the coarser rules are there already.
    const int stride = h < coarsest ? 2 : 1;
    for (int k = 1; k * h <= last; k += stride) {
      add(k * h);
      add(-k * h);
    }
    bool settled = h < coarsest;
    for (std::size_t k = 0; k < N; ++k) {
      const double before = integral[k];
      integral[k] = h * sum[k];
      settled = settled && !(std::abs(integral[k] - before) > tolerance * h * size[k]);
    }
    if (settled) break;
  }
  return integral;
}

}  // namespace odpd
