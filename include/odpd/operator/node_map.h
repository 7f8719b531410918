#pragma once
// Which particles carry unknowns of a field, and where they stand in the vector q that solvers see:
//
//   u = P q + u_known
//
// A particle whose values are known has none; every other one is a node of `block_size` unknowns, in memory order. Each
// field says for itself who is known: velocities (operator/dof_map.h: block_size = D), a temperature (block_size = 1), ...
#include <cstdint>
#include <span>
#include <vector>

namespace odpd {

class NodeMap {
 public:
  NodeMap() = default;
  /// known: a flag per particle, not zero where its values are.
  NodeMap(std::span<const char> known, int block_size);

  int block_size() const { return block_; }
  std::int64_t particles() const { return static_cast<std::int64_t>(node_.size()); }
  std::int64_t nodes() const { return static_cast<std::int64_t>(particle_.size()); }
  std::int64_t unknowns() const { return nodes() * block_; }
  /// Node of a particle, -1 when its values are known.
  std::int32_t node_of(std::size_t particle) const { return node_[particle]; }
  std::int32_t particle_of(std::size_t node) const { return particle_[node]; }
  /// Particles of the nodes, ascending.
  std::span<const std::int32_t> node_particles() const { return particle_; }

  // `values`: block_size numbers per particle, q: per node.

  /// q = P^T values.
  void gather(std::span<const double> values, std::span<double> q) const;
  /// values := P q at the particles with unknowns; the others keep theirs.
  void scatter(std::span<const double> q, std::span<double> values) const;

 private:
  int block_ = 1;
  std::vector<std::int32_t> node_;      // per particle
  std::vector<std::int32_t> particle_;  // per node
};

}  // namespace odpd
