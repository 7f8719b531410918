#pragma once
// The memory that a case needs, known before anything of its size is built:
//
//   particles N from counts, densities and layers;  edges E = N/2 (N/V) S_d r_c^d, S_d the volume of the unit ball
//   bytes = 1350 N + 190 E (2D),  2400 N + 205 E (3D)
//
// The coefficients are those of the largest resident memory of runs with pcg and trapezoidal (docs/performance.md).
#include "odpd/scene/scene_settings.h"

namespace odpd {

struct MemoryNeed {
  double particles = 0.0, edges = 0.0;
  double least = 0.0;  ///< bytes of the arrays of particles alone
  double bytes = 0.0;  ///< of all, about
  std::string keys;    ///< which make it less, in words
};

/// Of a scene whose start file is read.
template <int D>
MemoryNeed memory_need(const SceneSettings<D>& scene);

/// Bytes that this process may have: the smaller of its limit (ulimit -v) and the machine's memory with swap.
double memory_limit();

/// What the case needs, what there is, and the keys to change, in one sentence.
std::string memory_text(const MemoryNeed& need);

/// Throws Error (exit code 2) with that sentence where not even the particles fit.
template <int D>
void check_memory(const SceneSettings<D>& scene);

}  // namespace odpd
