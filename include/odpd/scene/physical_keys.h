#pragma once
// The keys of [fluid] that describe it by physical properties: eta, Sc, alpha, kappa_inverse, and rho = n m.
#include "odpd/core/config.h"
#include "odpd/scene/physical_inputs.h"

namespace odpd {

/// The physical inputs that [fluid] gives; none is in order. Throws ConfigError where DPD parameters that follow from
/// them are given too (eta with gamma or sigma, Sc with s, alpha with a, ...), or one is missing.
PhysicalInputs read_physical_inputs(const Config& fluid);

/// DPD parameters by physical inputs (`inputs.any()`); the parameters that they leave open, and kT and cutoff, are read
/// as keys of their own. Throws ConfigError at the key whose condition is not met.
template <int D>
DpdParameters read_physical_fluid(const Config& fluid, const PhysicalInputs& inputs, double density,
                                  double mass);

/// rho = n m: the density that rho and mass give, and the mass that rho and the density n give. Throws ConfigError when
/// rho, mass and an amount (density or count) are all given, or rho alone, or rho at mass = 0.
double density_of_rho(const Config& fluid);
double mass_of_rho(const Config& fluid, double density);

}  // namespace odpd
