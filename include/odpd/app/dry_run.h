#pragma once
// `odpd run --dry-run`: what would be modelled and why, how large it is, and how long it would take.
#include <string>

#include "odpd/app/simulation.h"

namespace odpd {

/// Evaluates and solves the first stage once to measure it; changes no file.
template <int D>
std::string dry_run_text(Simulation<D>& simulation);

}  // namespace odpd
