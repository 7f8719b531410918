#pragma once
// Lever arms of the edges between particles that spin (particles/spin.h):
//
//   l_i = r R_i/(R_i + R_j),   l_j = r R_j/(R_i + R_j);   0 and 0 where neither has a lever radius R
#include "odpd/pairs/network.h"
#include "odpd/particles/particles.h"

namespace odpd {

/// Writes lever_i and lever_j of all edges of `network`, whatever model wrote these; none where nobody spins or friction is along e
/// alone, which sees no spin. Particles of walls and bodies have the lever radius of their species too.
template <int D>
void write_levers(const Particles<D>& particles, PairNetwork<D>& network);

}  // namespace odpd
