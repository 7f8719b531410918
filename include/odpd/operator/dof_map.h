#pragma once
// v = P q + v_known: from the unknowns q to the velocities of all particles. A free particle has D unknowns, a particle
// of known velocity none (Phan-Thien et al. 2016, eq. 15-18).
#include <cstdint>
#include <span>
#include <vector>

#include "odpd/core/vec.h"
#include "odpd/particles/particles.h"

namespace odpd {

template <int D>
class DofMap {
 public:
  /// Nodes are the free particles in memory order.
  explicit DofMap(const Particles<D>& particles);

  std::int64_t nodes() const { return static_cast<std::int64_t>(particle_.size()); }
  std::int64_t particles() const { return static_cast<std::int64_t>(node_.size()); }
  std::int64_t unknowns() const { return nodes() * D; }
  /// Node of a particle, -1 when its velocity is known.
  std::int32_t node_of(std::size_t particle) const { return node_[particle]; }
  std::int32_t particle_of(std::size_t node) const { return particle_[node]; }

  /// P^T f: from one vector per particle to unknowns.
  void gather(std::span<const Vec<D>> particle_values, std::vector<double>& q) const;
  /// P q + known, with `known` read at the particles without unknowns.
  void scatter(std::span<const double> q, std::span<const Vec<D>> known,
               std::vector<Vec<D>>& velocity) const;

 private:
  std::vector<std::int32_t> node_;
  std::vector<std::int32_t> particle_;
};

}  // namespace odpd
