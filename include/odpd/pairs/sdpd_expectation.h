#pragma once
// The viscosity that SDPD fluids were measured to have, over the one asked for: eta/eta_asked by dimension, form, kernel, support in spacings,
// kappa = K/(n kT) and Gamma = p_b/(n kT), from sheared massless fluids at a Peclet number eta rate/(n kT) of 1 (docs/density-fluids.md,
// "Viscosity as measured"). There is no formula: friction loses what particles give way, and the structure that p_b makes adds a stress.
#include <optional>

#include "odpd/pairs/sdpd.h"

namespace odpd {

struct ExpectedViscosity {
  double ratio = 1.0;                              ///< of the viscosity asked for
  double standard_error = 0.0;                     ///< of the measurement
  double support = 0.0, kappa = 0.0, Gamma = 0.0;  ///< of the fluid that was measured
};

/// The nearest fluid measured; nothing where none has the same dimension, form and kernel, a support within a quarter of a spacing, and
/// kappa and Gamma within half as much again (or a Gamma below 3 where it was 0), at kT = 0, for zeta_b of one's own, and where particles spin.
std::optional<ExpectedViscosity> expected_viscosity(const SdpdParameters& p,
                                                    const SdpdFriction& friction, int dimension);

}  // namespace odpd
