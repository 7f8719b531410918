#pragma once
// The memory that a case needs, known before anything of its size is built:
//
//   particles N from counts, densities and layers;  edges E = N/2 (N/V) S_d r_c^d, S_d the volume of the unit ball, less pairs
//   inside a body
//   bytes = 45e6 + 1110 N + 204 E (2D),  45e6 + 1980 N + 230 E (3D)
//         + 65 N + 150 N_c + 250 B (2D), 110 N + 60 N_c + 250 B (3D) with B free bodies of N_c constituents in all
//         + 300 E_s (2D), 380 E_s (3D) with E_s edges that have lever arms (particles/spin.h)
//
// The coefficients are those of the largest resident memory of runs with pcg and trapezoidal (docs/performance.md).
#include "odpd/scene/scene_settings.h"

namespace odpd {

struct RunSize {
  double particles = 0.0, edges = 0.0;
  double bodies = 0.0, constituents = 0.0;  ///< free bodies, and their constituents
  double levers = 0.0;                      ///< edges with lever arms
};

/// At the peak of a run, about.
template <int D>
double run_bytes(const RunSize& size);

struct MemoryNeed {
  RunSize size;
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
