#pragma once
// The search of `odpd calibrate` for the friction gamma that gives a viscosity eta, apart from how eta is measured.
//
// About the friction gamma* of the answer, log eta = log eta* + p log(gamma/gamma*). At mass = 0, p = 1 exactly: with R
// linear in gamma and noise of variance 2 kT R, gamma only sets the unit of time, so that every measurement at the same
// rate and step in that unit counts alike. With mass p is fitted, from 1 +- 0.4. All measurements take part, weighted by
// their errors, and the less the further from gamma* they are, by a curvature of up to 1/4.
#include <optional>
#include <span>
#include <string>

#include "odpd/core/error.h"

namespace odpd {

struct ViscosityMeasurement {
  double gamma = 0.0;
  double eta = 0.0, error = 0.0;  ///< with standard error
  double shear_rate = 0.0, dt = 0.0, time = 0.0;
  std::uint64_t seed = 0;
  bool complete = true;  ///< reached the error it was to have
  bool doubled = false;  ///< at twice the rate, to see thinning: no part in the search
  double relative_error() const { return error / eta; }
  /// Good enough to take part: eta > 0, known to better than a half.
  bool counts() const { return !doubled && eta > 0.0 && error > 0.0 && error < 0.5 * eta; }
};

struct FrictionEstimate {
  double gamma = 0.0;           ///< gives the viscosity asked for
  double relative_error = 0.0;  ///< standard error of the viscosity there, over it
  double exponent = 1.0;        ///< p
  double gamma_error() const { return gamma * relative_error / exponent; }
};

/// From one measurement that counts, or more. `linear`: p = 1. Throws SolverError when the viscosity hardly depends on
/// gamma.
FrictionEstimate estimate_friction(std::span<const ViscosityMeasurement> measured, double eta,
                                   bool linear);

struct MeasurementPlan {
  double gamma = 0.0;
  double relative_error = 0.0;
};

/// What to measure next to know eta at the answer to `relative_error`: first roughly at `guess`, then at the estimate.
/// Nothing when that is reached.
std::optional<MeasurementPlan> next_measurement(std::span<const ViscosityMeasurement> measured,
                                                double eta, double guess, double relative_error,
                                                bool linear);

}  // namespace odpd
