#pragma once
// The random force of each edge: F_B = sqrt(2 kT Z / dt) w with w standard normal, so that
//
//   <F_B F_B^T> = sum_edges 2 kT J^T Z J / dt = 2 kT R / dt   at one temperature,
//
// without any matrix square root. Numbers are keyed by (seed, step, lower id, higher id).
#include <cstdint>
#include <vector>

#include "odpd/pairs/network.h"
#include "odpd/particles/particles.h"

namespace odpd {

/// Force on i of every edge (the force on j is its negative), integrated over dt and divided by it.
template <int D>
void draw_edge_noise(const PairNetwork<D>& network, const Particles<D>& particles,
                     std::uint64_t seed, std::uint64_t step, double dt, std::vector<Vec<D>>& force);

}  // namespace odpd
