#pragma once
// The balance of forces at one configuration, for particles of mass m >= 0,
//
//   P^T (R + zeta_0) P q + M (q - q_before) = P^T (F_C + F_ext - R v_known) + xi,   xi = P^T F_B,   v = P q + v_known
//
// (Phan-Thien et al. 2016, eq. 14-18, with M = 2 m/dt), in the pieces that integrators put together. Vectors of
// unknowns are flat, D numbers per free particle in memory order.
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "odpd/core/timer.h"
#include "odpd/dynamics/step_record.h"
#include "odpd/dynamics/surroundings.h"
#include "odpd/geometry/pair_list.h"
#include "odpd/operator/rigid_resistance.h"
#include "odpd/pairs/pair_model.h"
#include "odpd/solvers/solver.h"

namespace odpd {

struct DynamicsSettings {
  std::uint64_t seed = 1;
  std::optional<double> skin =
      {};  ///< of the pair list (length); none: what the motion makes cheapest
  bool hold_centre_of_mass = false;  ///< solve the problem of Scheme 2
  std::int64_t reorder_every = 100;  ///< steps between spatial reorderings of memory; 0: never
  double mass = 0.0;                 ///< of every free particle
  double zeta_0 = 0.0;  ///< uniform drag on every free particle, with its noise (mass/time)
  double kT = 1.0;      ///< of that noise, and of the scene (energy)
};

/// What a time step adds to the friction of a solve.
struct StepWeights {
  double inertia = 0.0;  ///< on the diagonal, M = 2 m/dt (mass/time)
  double stiffness_time =
      0.0;                 ///< theta dt, weight of max(k_c, 0) along each edge of a pair (time)
  double bond_time = 0.0;  ///< the same along each bond (time)
};

/// Sums over all solves of a run.
struct SolverStatistics {
  std::int64_t solves = 0;
  std::int64_t iterations = 0;
  std::int64_t most_iterations = 0;
  double worst_residual = 0.0;
  std::int64_t fallbacks = 0;  ///< solves whose preconditioner was given up
  std::int64_t clamped = 0;    ///< negative stiffnesses that an implicit step left out
  std::string problem;         ///< which problem was solved, in words
};

template <int D>
class Dynamics {
 public:
  using Unknowns = std::vector<double>;

  /// References must outlive this object. Gives the particles an `end_velocity` where they have mass. Throws ConfigError
  /// when the box is too small for the cutoff.
  Dynamics(const Box<D>& box, Particles<D>& particles, const PairModel<D>& model,
           const Surroundings<D>& surroundings, std::unique_ptr<Solver> solver,
           const DynamicsSettings& settings);

  Particles<D>& particles() { return particles_; }
  const Box<D>& box() const { return box_; }
  const PairModel<D>& model() const { return model_; }
  const Surroundings<D>& surroundings() const { return surroundings_; }
  const DynamicsSettings& settings() const { return settings_; }

  /// The particles were replaced (a checkpoint was read): forget what was derived from them.
  void particles_replaced() {
    list_.invalidate();
    dofs_.reset();
  }
  /// Brings memory into spatial order when this step is due for it (a function of the step number alone).
  void reorder_if_due(std::int64_t step);
  /// Fills position, edges and forces of a stage at the given positions and time; with shear the positions may have left
  /// the box since the step's start. Throws SolverError for a position that is not finite.
  void evaluate(std::span<const Vec<D>> positions, double time, Stage<D>& stage);
  /// Draws F_B of the stage's edges and returns xi = P^T F_B, with the noise of the drag (zero, and nothing drawn, at
  /// kT = 0).
  Unknowns draw_noise(const Stage<D>& stage, std::int64_t step, double dt,
                      std::vector<Vec<D>>& edge_noise);
  /// P^T (F_C + F_ext - R v_known) at the stage, with friction by sliding images as a part of the last.
  Unknowns force(const Stage<D>& stage);
  /// P^T R P q at the stage: friction among the particles, without the drag.
  Unknowns friction(const Stage<D>& stage, const Unknowns& q);
  /// P^T K P q, K the stiffness of the conservative force along the lines of centres (negative parts left out).
  Unknowns spring(const Stage<D>& stage, const Unknowns& q);
  /// The same of the bonds alone.
  Unknowns bond_spring(const Stage<D>& stage, const Unknowns& q);
  /// F - (R + zeta_0) q: all forces at the velocities q but the random ones.
  Unknowns total_force(const Stage<D>& stage, const Unknowns& q);

  /// Assembles A = P^T (R + K_pairs stiffness_time + K_bonds bond_time) P + zeta_0 + inertia at the stage.
  const System& assemble(const Stage<D>& stage, const StepWeights& weights);
  /// Solves A q = load for the stage's velocities. `guess` in, answer out. With mass or drag and nothing of known
  /// velocity, the mean of the answer is set to what momentum balance says, to rounding. Throws SolverError when the
  /// solver did not converge or a velocity is not finite. With shear and nothing else to fix it, the mean of the answer is
  /// that of the sheared flow.
  void solve(Stage<D>& stage, const Unknowns& load, const StepWeights& weights, Unknowns& guess);

  /// M = 2 m/dt.
  double inertia(double dt) const { return 2.0 * settings_.mass / dt; }
  bool has_mass() const { return settings_.mass > 0.0; }
  /// The unknowns of the particles' end velocities (zeros without mass), at the stage of a step's start.
  Unknowns end_velocity(const Stage<D>& stage);
  /// After `move`: sets them from momenta per mass p = P^T P q of the step, with the moments of inertia of where the bodies
  /// are now, as those of the images that are now in the box.
  void set_end_momentum(const Unknowns& p);
  /// inertia P^T P q: momenta, with a mass, or a drag, of `inertia` on every particle that moves.
  Unknowns times_inertia(const Stage<D>& stage, const Unknowns& q, double inertia);
  /// P q + the stage's known velocities.
  std::vector<Vec<D>> velocities(const Stage<D>& stage, const Unknowns& q);

  /// position + dt velocity from time t on, wrapped (with shear single particles by `evaluate` only); a particle that moves
  /// further than half the box throws, as in `move`. Adds the mirror's catches to `crossings`.
  std::vector<Vec<D>> displaced(const std::vector<Vec<D>>& velocity, double dt, double t,
                                std::int64_t& crossings);
  /// Moves the particles by dt velocity from time t on and remembers it; returns the mirror's catches. Throws SolverError
  /// when a particle moves further than half the box in one step.
  std::int64_t move(const std::vector<Vec<D>>& velocity, double dt, double t);
  /// After `move`: velocities q of the step become those of the images that are now in the box.
  void cross_faces(Unknowns& q);

  /// R on the sites: free particles and constituents.
  const Resistance<D>& resistance() const { return resistance_.sites(); }
  const PairList<D>& pair_list() const { return list_; }
  const DofMap<D>& dofs();
  Solver& solver() { return *solver_; }
  const Solver& solver() const { return *solver_; }
  PhaseSeconds& phases() { return phases_; }
  const PhaseSeconds& phases() const { return phases_; }
  SolverStatistics& statistics() { return statistics_; }
  const SolverStatistics& statistics() const { return statistics_; }

 private:
  void wrap_sheared(Stage<D>& stage) const;
  void write_slips(Stage<D>& stage) const;
  Unknowns without_sliding_springs(const Stage<D>& stage, const StepWeights& weights,
                                   Unknowns load);
  void add_mean_flow(const Stage<D>& stage, Unknowns& q);
  void check_paths(const std::vector<Vec<D>>& velocity, double dt) const;
  void leave_images(const std::vector<std::int32_t>& before);
  std::vector<std::int32_t> moving_images() const;
  std::vector<Vec<D>> arms_at(const Box<D>& box, std::span<const Vec<D>> positions);
  void place_arms(Stage<D>& stage);
  void count_boxes(std::size_t body, Stage<D>& stage);
  /// Moves a pose of the body along velocities of its constituents, wrapped in `box`. False when that changes no position.
  bool advance(std::size_t body, const std::vector<Vec<D>>& velocity, double dt, const Box<D>& box,
               RigidPose<D>& pose);
  void place(std::size_t body, const RigidPose<D>& pose, const Box<D>& box,
             std::vector<Vec<D>>& positions, std::vector<typename Particles<D>::Image>* images);
  void balance_momentum(const Unknowns& load, double shift, Unknowns& q) const;
  void note(const SolveReport& report);

  const Box<D> box_;
  Particles<D>& particles_;
  const PairModel<D>& model_;
  const Surroundings<D>& surroundings_;
  std::unique_ptr<Solver> solver_;
  DynamicsSettings settings_;
  PairList<D> list_;
  std::unique_ptr<DofMap<D>> dofs_;
  RigidResistance<D> resistance_;
  std::vector<Vec<D>> faces_crossed_;  // with shear: velocity that each particle lost in `move`
  Box<D> moved_in_;                    // the box at the end of `move`
  PhaseSeconds phases_;
  SolverStatistics statistics_;
};

}  // namespace odpd
