#pragma once
// `odpd run --dry-run`: what would be modelled and why, how large it is, and how long it would take.
#include <string>

#include "odpd/app/simulation.h"

namespace odpd {

/// Takes two steps, with their measurements, on the scene of the case, and measures the second; changes no file. Its memory is that
/// of run_bytes (app/memory.h).
template <int D>
std::string dry_run_text(Simulation<D>& simulation);

}  // namespace odpd
