#pragma once
// v = P q + v_known: from the unknowns q to the velocities of all particles (Phan-Thien et al. 2016, eq. 15-18). A free
// particle has D unknowns, a particle of known velocity none; the constituents of a rigid body share its velocity V and
// angular velocity w,
//
//   v_k = V + X(a_k) w,   X(a) w = w x a,   a_k the arm of constituent k
//
// *Nodes* are the groups of D unknowns that solvers see: w of each body (in 2D with one unused component), then the free
// particles in memory order, then V of each body. *Sites* are the particles that move: free ones and constituents, in memory order.
#include <cstdint>
#include <span>
#include <vector>

#include "odpd/core/vec.h"
#include "odpd/particles/particles.h"

namespace odpd {

template <int D>
class DofMap {
 public:
  explicit DofMap(const Particles<D>& particles);

  std::int64_t nodes() const { return translating_nodes() + bodies(); }
  /// Those behind the angular velocities.
  std::int64_t translating_nodes() const {
    return static_cast<std::int64_t>(free_.size()) + bodies();
  }
  std::int64_t unknowns() const { return nodes() * D; }
  std::int64_t particles() const { return static_cast<std::int64_t>(site_.size()); }
  /// Rigid bodies whose motion is unknown: the first of them all.
  std::int64_t bodies() const { return static_cast<std::int64_t>(unknown_); }

  std::int64_t sites() const { return static_cast<std::int64_t>(site_particles().size()); }
  /// Site of a particle, -1 when its velocity is known.
  std::int32_t site_of(std::size_t particle) const { return site_[particle]; }
  std::int32_t particle_of(std::size_t site) const { return site_particles()[site]; }
  /// Particles of the free nodes, ascending; free_particles()[k] is node free_node(k).
  std::span<const std::int32_t> free_particles() const { return free_; }
  std::size_t free_node(std::size_t k) const { return unknown_ + k; }
  /// Constituents of body b, of known motion or not, as places in memory.
  std::span<const std::int32_t> constituents(std::size_t b) const { return body_[b]; }
  /// Node of V of body b; that of its w is b.
  std::size_t body_node(std::size_t b) const { return unknown_ + free_.size() + b; }

  // `arms`: one per particle, zero but for constituents; empty where there are no bodies.

  /// P^T f: from one force per particle to unknowns; forces and torques of bodies.
  void gather(std::span<const Vec<D>> arms, std::span<const Vec<D>> forces,
              std::vector<double>& q) const;
  /// P q + known, with `known` read at the particles without unknowns.
  void scatter(std::span<const Vec<D>> arms, std::span<const double> q,
               std::span<const Vec<D>> known, std::vector<Vec<D>>& velocity) const;
  /// (P^T P)^-1 l: unknowns from momenta per mass, those of bodies linear and angular.
  void divide_by_inertia(std::span<const Vec<D>> arms, std::vector<double>& l) const;

 private:
  const std::vector<std::int32_t>& site_particles() const { return unknown_ == 0 ? free_ : moves_; }

  std::vector<std::int32_t> site_;
  std::vector<std::int32_t> free_;
  std::vector<std::int32_t> moves_;  // particles of the sites; empty without bodies
  std::vector<std::vector<std::int32_t>> body_;
  std::size_t unknown_ = 0;  // bodies
};

}  // namespace odpd
