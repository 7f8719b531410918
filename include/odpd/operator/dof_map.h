#pragma once
// v = P q + v_known: from the unknowns q to the velocities of all particles (Phan-Thien et al. 2016, eq. 15-18). A free
// particle has D unknowns, a particle of known velocity none; the constituents of a rigid body share its velocity V and
// angular velocity w,
//
//   v_k = V + X(a_k) w,   X(a) w = w x a,   a_k the arm of constituent k
//
// *Nodes* are the groups of D unknowns that solvers see: w of each body (in 2D with one unused component, of a rod in 3D
// with one that moves nothing, along its line), then the free particles in memory order, then V of each body. A translation
// moves all but the first of these. *Mobile* are the particles that move: free ones and constituents, in memory order.
// Free particles that spin (particles/spin.h) have an angular velocity each, D unknowns in memory order (in 2D one unused), in front of
// the nodes: q = (spins, nodes). A constituent spins as its body does.
#include <cstdint>
#include <span>
#include <vector>

#include "odpd/core/index.h"
#include "odpd/core/vec.h"
#include "odpd/operator/node_map.h"
#include "odpd/operator/translations.h"
#include "odpd/particles/constituents.h"
#include "odpd/particles/particles.h"

namespace odpd {

template <int D>
class DofMap {
 public:
  /// mass: of a free particle, in whose units moments of inertia are taken.
  explicit DofMap(const Particles<D>& particles, double mass = 0.0);

  int block_size() const { return D; }
  /// Without the spins.
  std::int64_t nodes() const { return free_.nodes() + 2 * bodies(); }
  std::int64_t spins() const { return spins_.nodes(); }
  std::int64_t unknowns() const { return (spins() + nodes()) * block_size(); }
  /// The part of q that the nodes are.
  std::span<const double> velocities(std::span<const double> q) const {
    return q.subspan(index(spins()) * D);
  }
  std::span<double> velocities(std::span<double> q) const { return q.subspan(index(spins()) * D); }
  /// Some species has a lever radius.
  bool any_spin() const { return any_spin_; }
  Translations translations() const { return {block_size(), free_.nodes() + bodies(), D}; }
  std::int64_t particles() const { return free_.particles(); }
  /// Rigid bodies whose motion is unknown: the first of them all.
  std::int64_t bodies() const { return static_cast<std::int64_t>(unknown_); }

  std::int64_t mobile() const { return mobile_map().nodes(); }
  /// Number of a particle among the mobile ones, -1 when its velocity is known.
  std::int32_t mobile_of(std::size_t particle) const { return mobile_map().node_of(particle); }
  std::int32_t particle_of(std::size_t row) const { return mobile_map().particle_of(row); }
  /// Particles of the free nodes, ascending; free_particles()[k] is node free_node(k).
  std::span<const std::int32_t> free_particles() const { return free_.node_particles(); }
  std::size_t free_node(std::size_t k) const { return unknown_ + k; }
  /// Constituents of body b, of known motion or not, as indices in memory.
  std::span<const std::int32_t> constituents(std::size_t b) const { return constituents_[b]; }
  /// Of the spins, ascending.
  std::span<const std::int32_t> spin_particles() const { return spins_.node_particles(); }
  /// Number of the spin of a particle, -1 when it has none of its own.
  std::int32_t spin_of(std::size_t particle) const {
    return spins() == 0 ? -1 : spins_.node_of(particle);
  }
  /// Moment of inertia over mass of each spin (length^2); 0 without mass.
  std::span<const double> moments() const { return moment_; }
  /// Node of V of body b; that of its w is b.
  std::size_t body_node(std::size_t b) const { return unknown_ + index(free_.nodes()) + b; }

  /// The nodes of this rank: those of its free particles, of the first rank also the w of all bodies, of the last their V.
  Share node_share() const;
  /// The same for all of q, in nodes. Throws SolverError where there are several ranks and somebody spins.
  Share share() const;
  /// Likewise its mobile particles.
  Share mobile_share() const { return run_of(mobile_map().node_particles()); }

  // `arms`: one per particle, zero but for constituents; empty where there are no bodies.

  /// P^T f: from one force per particle to unknowns; forces and torques of bodies, whose constituents may belong to any rank.
  /// With bodies all ranks call it together.
  void gather(std::span<const Vec<D>> arms, std::span<const Vec<D>> forces,
              std::vector<double>& q) const;
  /// The same with torques about the particles' centres (empty: none).
  void gather(std::span<const Vec<D>> arms, std::span<const Vec<D>> forces,
              std::span<const Vec<D>> torques, std::vector<double>& q) const;
  /// P q + known, with `known` read at the particles without unknowns.
  void scatter(std::span<const Vec<D>> arms, std::span<const double> q,
               std::span<const Vec<D>> known, std::vector<Vec<D>>& velocity) const;
  /// The angular velocities of all particles; `known` is read at those that move with what has a known motion. Empty where nobody spins.
  void scatter_spins(std::span<const double> q, std::span<const Vec<D>> known,
                     std::vector<Vec<D>>& spin) const;
  /// q := P^T P q: momenta per mass from unknowns, those of bodies linear and angular.
  void times_inertia(std::span<const Vec<D>> arms, std::vector<double>& q) const;
  /// (P^T P)^+ l: unknowns from momenta per mass, those of bodies linear and angular; no spin of a rod about its line, nor of a particle
  /// without moment of inertia.
  void divide_by_inertia(std::span<const Vec<D>> arms, std::vector<double>& l) const;

 private:
  /// Where this rank's particles stand among these, which ascend.
  Share run_of(std::span<const std::int32_t> particles) const;
  /// The two nodes of a body, V and w, within unknowns, and back.
  RigidMotion<D> motion_of(std::size_t b, std::span<const double> q) const;
  void set(std::size_t b, const Vec<D>& linear, const Vec<D>& angular, std::span<double> q) const;
  const NodeMap& mobile_map() const { return unknown_ == 0 ? free_ : mobile_; }

  NodeMap free_, spins_;
  std::vector<double> moment_;
  bool any_spin_ = false;
  NodeMap mobile_;  // empty without bodies of unknown motion: the same as free_
  Constituents constituents_;
  std::size_t unknown_ = 0;  // bodies
  Share owned_;              // particles
};

}  // namespace odpd
