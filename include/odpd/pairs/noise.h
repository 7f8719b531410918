#pragma once
// The random force of each edge: F_B = sqrt(2 kT Z / dt) w with w standard normal, so that
//
//   <F_B F_B^T> = sum_edges 2 kT J^T Z J / dt = 2 kT R / dt   at one temperature,
//
// without any matrix square root. Numbers are keyed by (seed, step, lower id, higher id).
#include <cstdint>
#include <vector>

#include "odpd/core/random.h"
#include "odpd/pairs/network.h"
#include "odpd/particles/particles.h"

namespace odpd {

/// The standard normal numbers of edge k in a step: functions of (seed, step, pair), whichever of the two comes first.
template <int D>
class EdgeNormals {
 public:
  EdgeNormals(const PairRandom& random, const PairNetwork<D>& network,
              const Particles<D>& particles, std::size_t k);
  double along() const;
  /// Normal in the directions across e, zero along it.
  Vec<D> across() const;

 private:
  PairRandom random_;
  Vec<D> e_;
  std::uint32_t low_, high_;
  double sign_;
};

/// Force on i of every edge (the force on j is its negative), integrated over dt and divided by it.
template <int D>
void draw_edge_noise(const PairNetwork<D>& network, const Particles<D>& particles,
                     std::uint64_t seed, std::uint64_t step, double dt, std::vector<Vec<D>>& force);

/// force[i] += amplitude n on every free particle, n standard normal per component and keyed by (seed, step, id): with
/// amplitude = sqrt(2 kT zeta_0/dt) the noise of a uniform drag zeta_0.
template <int D>
void add_drag_noise(const Particles<D>& particles, std::uint64_t seed, std::uint64_t step,
                    double amplitude, std::vector<Vec<D>>& force);

}  // namespace odpd
