#pragma once
// What one step saw and did, for whoever measures: both stages' edges, forces and velocities, and the random force.
#include <cstdint>
#include <functional>
#include <vector>

#include "odpd/geometry/box.h"
#include "odpd/pairs/network.h"
#include "odpd/solvers/solver.h"

namespace odpd {

/// One solve inside a step. Vectors have one entry per particle, in memory order.
template <int D>
struct Stage {
  double time = 0.0;
  Box<D> box;                           ///< with its images where they are at `time`
  std::vector<Vec<D>> position;         ///< inside the box along periodic directions
  std::vector<Vec<D>> arms;             ///< of constituents, zero for others; empty without bodies
  PairNetwork<D> network;               ///< edges at `position`
  std::vector<Vec<D>> potential_force;  ///< conservative pair forces and wall potentials
  std::vector<Vec<D>> driving_force;    ///< body force
  std::vector<Vec<D>> velocity;         ///< solved (free) or prescribed (known)
  std::vector<Vec<D>> spin;             ///< likewise angular velocities; empty where nobody spins
  /// With shear: boxes along the gradient from the image whose velocity this is to the one in the box. In all of a step
  /// a particle has the velocity of the image that it was at the step's start. A constituent has that of the image
  /// hanging together with its body's centre then, so that a body across the face moves as one. network.slip_0 holds
  /// the rest.
  std::vector<std::int32_t> crossed;
  SolveReport report;
};

/// Forces, and torques about the particles' centres (empty: none), one per particle.
template <int D>
struct ParticleLoads {
  std::vector<Vec<D>> force, torque = {};
};

/// Velocities and angular velocities (empty where nobody spins), one per particle.
template <int D>
struct ParticleMotions {
  std::vector<Vec<D>> velocity, spin = {};
};

template <int D>
struct StepRecord {
  std::int64_t step = 0;  ///< index of the step, counted from 0
  double dt = 0.0;
  std::vector<Vec<D>> v_start;  ///< velocity at the step's start, of variance kT/m; empty at m = 0
  std::vector<Vec<D>> w_start;  ///< likewise angular velocities, of variance kT/I
  Stage<D> start;               ///< at the step's start: r, v1
  double start_weight = 1.0;  ///< of this stage in means over the stages; the rest is the second's
  Stage<D> corrector;         ///< the second stage, where a scheme has one: r*, v2
  /// F_B on i, one per edge of start.network; empty at kT = 0. Of shardlow: what acted beyond friction at the start.
  std::vector<Vec<D>> edge_noise;
  std::vector<Vec<D>> v_mid;         ///< velocity that moved each particle: displacement/dt
  std::vector<Vec<D>> w_mid;         ///< likewise angular velocities; empty where nobody spins
  std::int64_t alarm_crossings = 0;  ///< particles the mirror had to catch in this step

  /// P (P^T R P)^+ P^T f at `start`: the velocities (length/time, 1/time) that a force f, and a torque, on each particle cause
  /// there besides what acts in the step. One more solve, by the solver of the run, to this tolerance (0: that of the run);
  /// at mass 0 it touches none of the later solves, with mass a grid may be built anew. A force on all particles alike
  /// counts for nothing where no drag and no particle of known velocity takes it up. Empty for schemes that are not of two
  /// stages; on all ranks together. Throws SolverError when the solver did not converge.
  std::function<ParticleMotions<D>(const ParticleLoads<D>& loads, double tolerance)> respond;

  bool has_corrector() const { return start_weight < 1.0; }
};

}  // namespace odpd
