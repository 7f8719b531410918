#pragma once
// The name table of the pair models, fluid.model: each reads its keys and makes itself.
#include <memory>
#include <string>
#include <vector>

#include "odpd/pairs/fluid_keys.h"
#include "odpd/pairs/pair_model.h"

namespace odpd {

/// In the order of the table, the default first.
std::vector<std::string> pair_model_names();

/// The model that fluid.model names, from its keys. Throws ConfigError for another name, for physical inputs and calibrations where the
/// model has none, and what its reader throws.
template <int D>
std::shared_ptr<const PairModel<D>> read_pair_model(const FluidKeys& keys);

/// That of a scene which says nothing else: DPD with its default parameters, one species.
template <int D>
std::shared_ptr<const PairModel<D>> default_pair_model();

/// Keys of [fluid] that have no part in the equilibrium distribution of a model; a table stands for all its keys.
std::vector<std::string> dynamical_model_keys();

}  // namespace odpd
