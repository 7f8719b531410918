#pragma once
// Keys of [[observe]] kind = "modes" that any mass has, and what no run may have whose modes are to be measured. All throw
// ConfigError.
#include <cstdint>
#include <vector>

#include "odpd/analysis/observer.h"

namespace odpd {

/// `axes`, directions of k along which the box has one edge: by default those of its longest edges.
template <int D>
std::vector<int> read_wave_axes(const ObserverEntry<D>& entry);

/// `numbers` of waves in the edge, ascending, or 1 to `count`.
std::vector<std::int64_t> read_wave_numbers(const Config& config);

/// `extrapolate`: of how many of these wave numbers, 4 or all where it is absent.
std::int64_t read_extrapolation(const Config& config, std::size_t waves);

/// Refuses a run that is no fluid at rest, in equilibrium, with its momentum kept and nothing in the way of waves.
template <int D>
void refuse_modes_unless_at_rest(const ObserverEntry<D>& entry);

}  // namespace odpd
