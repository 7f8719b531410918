#pragma once
// A key whose value is a vector of D components.
#include <string>

#include "odpd/core/config.h"
#include "odpd/core/vec.h"

namespace odpd {

/// The required `key` as a vector; ConfigError when it has another number of components.
template <int D>
Vec<D> read_vector(const Config& config, const std::string& key);

/// The same, zero where the case does not give the key.
template <int D>
Vec<D> read_optional_vector(const Config& config, const std::string& key);

}  // namespace odpd
