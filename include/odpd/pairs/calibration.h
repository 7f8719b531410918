#pragma once
// The friction that was measured to give a viscosity, and of which fluid (`odpd calibrate`).
#include <optional>
#include <string>

#include "odpd/core/config.h"
#include "odpd/pairs/dpd_parameters.h"

namespace odpd {

/// What a calibration holds for, and what it found.
struct Calibration {
  std::string file;  ///< where it was read, for messages
  int dimension = 2;
  double density = 0.0;  ///< n (1/length^d)
  double mass = 0.0;
  DpdParameters fluid;  ///< kT, cutoff, a, s_bar, s, gamma_far, cutoff_far; gamma is the result
  double gamma_error = 0.0;  ///< standard error of gamma
  double eta = 0.0;          ///< viscosity asked for, which gamma gives
  double eta_error = 0.0;    ///< standard error of the viscosity at gamma
};

/// [fluid] has the key `calibration`, and it is not "".
bool names_calibration(const Config& fluid);

/// A fluid to use a calibration for.
struct FluidState {
  int dimension = 2;
  double density = 0.0, mass = 0.0;
  DpdParameters p;
};

/// The calibrated friction of a fluid that is described by `eta`, with `here` its state and parameters. Throws ConfigError
/// at the key in which the calibration (the contents of the file it names) differs, with `alpha`, whose a
/// would follow from gamma, and without `eta` or `calibration`.
double calibrated_friction(const Config& fluid, const std::optional<Calibration>& calibration,
                           const std::optional<double>& eta, const FluidState& here);

}  // namespace odpd
