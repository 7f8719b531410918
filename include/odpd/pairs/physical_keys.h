#pragma once
// The keys of [fluid] that describe it by physical properties: eta, Sc, tau_P, alpha, kappa_inverse.
#include "odpd/core/config.h"
#include "odpd/pairs/physical_inputs.h"

namespace odpd {

/// The physical inputs that [fluid] gives; none is in order. Throws ConfigError where DPD parameters that follow from
/// them are given too (eta with gamma or sigma, Sc or tau_P with s, alpha with a, ...), or one is missing.
PhysicalInputs read_physical_inputs(const Config& fluid);

/// DPD parameters by physical inputs (`inputs.any()`); the parameters that they leave open, and kT and cutoff, are read
/// as keys of their own. Throws ConfigError at the key whose condition is not met.
template <int D>
DpdParameters read_physical_fluid(const Config& fluid, const PhysicalInputs& inputs, double density,
                                  double mass);

/// Throws ConfigError where [fluid] has such a key, or a calibration: they are of DPD, not of this model.
void refuse_physical_inputs(const Config& fluid, const std::string& model);

}  // namespace odpd
