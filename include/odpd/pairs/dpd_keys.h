#pragma once
// model = "dpd": its keys of [fluid] and [[pair]], by parameters, by physical inputs, or with a calibrated friction.
#include <memory>

#include "odpd/pairs/fluid_keys.h"
#include "odpd/pairs/pair_model.h"

namespace odpd {

/// Throws ConfigError for values out of range and for contradictions (both gamma and sigma, ...).
template <int D>
std::shared_ptr<const PairModel<D>> read_dpd(const FluidKeys& keys);

}  // namespace odpd
