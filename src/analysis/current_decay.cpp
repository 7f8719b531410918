#include "odpd/analysis/current_decay.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace odpd {

namespace {

constexpr double undefined = std::numeric_limits<double>::quiet_NaN();
constexpr int most_iterations = 40;
constexpr double converged = 1e-10;

// Where c falls to 1/e of c[0], for a fit to begin with.
double first_rate(std::span<const double> c, double interval) {
  for (std::size_t lag = 1; lag < c.size(); ++lag)
    if (c[lag] < c[0] / 2.7) return 1.0 / (interval * static_cast<double>(lag));
  return std::log(c.front() / c.back()) / (interval * static_cast<double>(c.size() - 1));
}

double square_miss(std::span<const double> c, double interval, const MaxwellFit& fit) {
  double sum = 0.0;
  for (std::size_t lag = 1; lag < c.size(); ++lag) {
    const double miss = c[lag] / c[0] - fit(interval * static_cast<double>(lag));
    sum += miss * miss;
  }
  return sum;
}

}  // namespace

std::array<MaxwellFit::Term, 2> MaxwellFit::terms() const {
  if (tau <= 0.0) {
    const double w = std::sqrt(1.0 + 4.0 * std::abs(tau) * rate);
    return {Term{0.5 * (1.0 + 1.0 / w), 2.0 * rate / (1.0 + w)}, Term{0.0, rate}};
  }
  constexpr double smallest = 1e-4;  // the terms part at W = 0, where both grow beyond bounds
  std::complex<double> w = std::sqrt(std::complex(1.0 - 4.0 * tau * rate));
  if (std::abs(w) < smallest) w = smallest;
  return {Term{0.5 * (1.0 + 1.0 / w), 2.0 * rate / (1.0 + w)},
          Term{0.5 * (1.0 - 1.0 / w), (1.0 + w) / (2.0 * tau)}};
}

double MaxwellFit::operator()(double t) const {
  if (t == 0.0) return 1.0;
  double sum = 0.0;
  for (const Term& term : terms())
    sum += term.rate.imag() == 0.0 ? term.amplitude.real() * std::exp(-term.rate.real() * t)
                                   : (term.amplitude * std::exp(-term.rate * t)).real();
  return sum;
}

double MaxwellFit::area_beyond(double t, double interval) const {
  double sum = 0.0;
  for (const Term& term : terms()) {
    const std::complex<double> q = std::exp(-term.rate * interval);
    sum += (term.amplitude * std::exp(-term.rate * t) * (1.0 + q) / (1.0 - q)).real();
  }
  return 0.5 * interval * sum;
}

double fit_exponential(std::span<const double> c, double interval) {
  double rate = first_rate(c, interval);
  if (!(c[0] > 0.0) || !(rate > 0.0)) return undefined;
  double best = square_miss(c, interval, {rate, 0.0});
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    double along = 0.0, square = 0.0, curvature = 0.0;
    for (std::size_t lag = 1; lag < c.size(); ++lag) {
      const double turn = rate * interval * static_cast<double>(lag);
      const double e = std::exp(-turn);
      const double miss = c[lag] / c[0] - e;
      along -= miss * turn * e;
      square += turn * turn * e * e;
      curvature -= miss * (turn - 1.0) * turn * e;
    }
    // Newton's step of the rate's logarithm, Gauss and Newton's far from the least.
    curvature += square;
    double change = std::clamp(along / (curvature > 0.0 ? curvature : square), -0.5, 0.5);
    double miss = square_miss(c, interval, {rate * std::exp(change), 0.0});
    while (miss > best && std::abs(change) > converged) {
      change *= 0.5;
      miss = square_miss(c, interval, {rate * std::exp(change), 0.0});
    }
    if (std::abs(change) <= converged) return rate;
    rate *= std::exp(change);
    best = miss;
  }
  return rate;
}

// Levenberg and Marquardt's way, in the logarithm of the rate and in tau over the time of the exponential.
MaxwellFit fit_maxwell(std::span<const double> c, double interval) {
  const double rate = fit_exponential(c, interval);
  if (std::isnan(rate)) return {undefined, undefined};
  using Pair = std::array<double, 2>;
  const auto at = [&](const Pair& x) { return MaxwellFit{rate * std::exp(x[0]), x[1] / rate}; };
  Pair x{};
  double best = square_miss(c, interval, at(x)), damping = 1e-3;
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    constexpr double small = 1e-6;
    const MaxwellFit here = at(x), ahead = at({x[0] + small, x[1]}),
                     later = at({x[0], x[1] + small});
    double a = 0.0, b = 0.0, d = 0.0, right_0 = 0.0, right_1 = 0.0;
    for (std::size_t lag = 1; lag < c.size(); ++lag) {
      const double t = interval * static_cast<double>(lag), value = here(t);
      const double by_0 = (ahead(t) - value) / small, by_1 = (later(t) - value) / small;
      a += by_0 * by_0;
      b += by_0 * by_1;
      d += by_1 * by_1;
      right_0 += by_0 * (c[lag] / c[0] - value);
      right_1 += by_1 * (c[lag] / c[0] - value);
    }
    for (; damping < 1e6; damping *= 10.0) {
      const double p = a * (1.0 + damping), q = d * (1.0 + damping), determinant = p * q - b * b;
      const Pair change{(right_0 * q - right_1 * b) / determinant,
                        (right_1 * p - right_0 * b) / determinant};
      const Pair next{x[0] + change[0], x[1] + change[1]};
      const double miss = square_miss(c, interval, at(next));
      if (!(miss <= best)) continue;
      x = next;
      best = miss;
      damping *= 0.1;
      if (std::max(std::abs(change[0]), std::abs(change[1])) < 1e-8) return at(x);
      break;
    }
    if (damping >= 1e6) return at(x);
  }
  return at(x);
}

double decay_area(std::span<const double> c, double interval, std::size_t join,
                  const MaxwellFit& fit) {
  double sum = 0.5 * (c[0] + c[join]);
  for (std::size_t lag = 1; lag < join; ++lag) sum += c[lag];
  return interval * sum / c[0] + fit.area_beyond(interval * static_cast<double>(join), interval);
}

}  // namespace odpd
