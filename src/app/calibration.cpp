#include "odpd/app/calibration.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace odpd {

namespace {

constexpr double exponent_spread = 0.4;  // of p about 1, before anything is known
constexpr double curvature = 0.25;       // of log eta over log gamma, at most
constexpr double roughest = 0.15;        // relative error of a measurement that helps the search
constexpr double least_exponent = 0.15;
constexpr double longest_leap = 5.0;  // of gamma between two measurements, as a factor

struct Line {
  double value = 0.0, variance = 0.0;  // of log(eta/eta asked for) at log gamma = x
  double exponent = 1.0;
};

// Least squares for the line about x, with what is known of its slope before.
Line fit_at(std::span<const ViscosityMeasurement> measured, double eta, double x, bool linear) {
  double w0 = 0.0, w1 = 0.0, w2 = 0.0, y0 = 0.0, y1 = 0.0;
  for (const ViscosityMeasurement& m : measured) {
    if (!m.counts()) continue;
    const double d = std::log(m.gamma) - x;
    const double y = std::log(m.eta / eta) - d;  // beyond slope 1
    const double bend = linear ? 0.0 : curvature * d * d;
    const double w = 1.0 / (m.relative_error() * m.relative_error() + bend * bend);
    w0 += w;
    w1 += w * d;
    w2 += w * d * d;
    y0 += w * y;
    y1 += w * d * y;
  }
  if (linear) return {y0 / w0, 1.0 / w0, 1.0};
  w2 += 1.0 / (exponent_spread * exponent_spread);
  const double determinant = w0 * w2 - w1 * w1;
  return {(w2 * y0 - w1 * y1) / determinant, w2 / determinant,
          1.0 + (w0 * y1 - w1 * y0) / determinant};
}

// The measurement that came closest to eta.
const ViscosityMeasurement* closest(std::span<const ViscosityMeasurement> measured, double eta) {
  const ViscosityMeasurement* best = nullptr;
  const auto distance = [&](const ViscosityMeasurement& m) {
    return std::abs(std::log(m.eta / eta));
  };
  for (const ViscosityMeasurement& m : measured)
    if (m.counts() && (best == nullptr || distance(m) < distance(*best))) best = &m;
  return best;
}

}  // namespace

FrictionEstimate estimate_friction(std::span<const ViscosityMeasurement> measured, double eta,
                                   bool linear) {
  const ViscosityMeasurement* nearest = closest(measured, eta);
  if (nearest == nullptr) throw SolverError("no measurement of the viscosity is good enough yet");
  const double start = std::log(nearest->gamma);
  const double leap = linear ? 100.0 : std::log(longest_leap);
  double x = start;
  Line line;
  constexpr int rounds = 20;  // each a Newton step: they settle after a few
  for (int round = 0; round < rounds; ++round) {
    line = fit_at(measured, eta, x, linear);
    if (line.exponent < least_exponent)
      throw SolverError(
          fmt::format("the viscosity hardly grows with gamma here (as its power {:.2f} about gamma "
                      "= {:.4g}): inertia carries the stress, and eta = {} may be below what this "
                      "fluid can have. Ask for a larger eta, or lower the mass or kT",
                      line.exponent, std::exp(x), eta));
    x = std::clamp(x - line.value / line.exponent, start - leap, start + leap);
  }
  line = fit_at(measured, eta, x, linear);
  // What a bounded leap leaves undone counts as error.
  return {std::exp(x), std::sqrt(line.variance + line.value * line.value), line.exponent};
}

std::optional<MeasurementPlan> next_measurement(std::span<const ViscosityMeasurement> measured,
                                                double eta, double guess, double relative_error,
                                                bool linear) {
  const double rough = std::max(relative_error, std::min(4.0 * relative_error, roughest));
  if (closest(measured, eta) == nullptr) return MeasurementPlan{guess, rough};
  const FrictionEstimate now = estimate_friction(measured, eta, linear);
  if (now.relative_error <= relative_error) return std::nullopt;
  // Together with what is known, and a little better, as errors are themselves uncertain.
  const double wanted = 0.95 * relative_error;
  const double known = now.relative_error;
  return MeasurementPlan{
      now.gamma, std::min(rough, 1.0 / std::sqrt(1.0 / (wanted * wanted) - 1.0 / (known * known)))};
}

}  // namespace odpd
