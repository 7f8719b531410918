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
#include "odpd/dynamics/motion.h"
#include "odpd/geometry/pair_list.h"
#include "odpd/operator/spin_resistance.h"
#include "odpd/pairs/pair_model.h"
#include "odpd/solvers/solver.h"

namespace odpd {

struct DynamicsSettings {
  std::uint64_t seed = 1;
  /// Of the pair list (length). None: what the motion makes cheapest.
  std::optional<double> skin = {};
  bool hold_centre_of_mass = false;  ///< solve the problem of Scheme 2
  std::int64_t reorder_every = 100;  ///< steps between spatial reorderings of memory; 0: never
};

/// What a time step adds to the friction of a solve.
struct StepWeights {
  double inertia = 0.0;         ///< on the diagonal, M = 2 m/dt (mass/time)
  double stiffness_time = 0.0;  ///< theta dt, of max(k_c, 0) along each edge of a pair (time)
  double bond_time = 0.0;       ///< the same along each bond (time)
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

  void add(const SolveReport& report);
  void save(StateWriter& out) const;
  void load(const StateReader& in);
};

template <int D>
class Dynamics {
 public:
  using Unknowns = std::vector<double>;

  /// References must outlive this object. Gives the particles an `end_velocity` where they have mass. Throws
  /// ConfigError when the box is too small for the cutoff.
  Dynamics(const Box<D>& box, Particles<D>& particles, const PairModel<D>& model,
           const Surroundings<D>& surroundings, std::unique_ptr<Solver> solver,
           const DynamicsSettings& settings);

  Particles<D>& particles() { return particles_; }
  const Box<D>& box() const { return box_; }
  const PairModel<D>& model() const { return model_; }
  const Surroundings<D>& surroundings() const { return surroundings_; }
  const DynamicsSettings& settings() const { return settings_; }
  /// Those of the surroundings.
  const ParticleConstants& constants() const { return constants_; }
  /// How these particles move.
  Motion<D>& motion() { return motion_; }

  /// The particles were replaced (a checkpoint was read): forget what was derived from them.
  void particles_replaced() {
    list_.invalidate();
    motion_.particles_replaced();
  }
  /// Brings memory into spatial order when this step is due for it (a function of the step number alone).
  void reorder_if_due(std::int64_t step);
  /// Fills a stage at these positions at this time: what Motion::locate does, edges and forces. Throws BlowUpError for
  /// a position that is not finite. As all that moves, sums or solves, it is called by all ranks of the particles together, and
  /// what one of them throws all throw.
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
  /// Solves A q = load for the stage's velocities: `guess` in, answer out. Throws SolverError when the solver did not
  /// converge, and where forces from outside drive a null motion; BlowUpError when a velocity is not finite. Where nothing
  /// has a known velocity, the mean of the answer is exact: with mass or drag, and no bodies, it is what momentum balance
  /// says; with neither it is 0, or under shear that of the sheared flow.
  void solve(Stage<D>& stage, const Unknowns& load, const StepWeights& weights, Unknowns& guess);

  /// P (P^T R P)^+ P^T f at a stage that was evaluated: velocities from loads on particles, with the drag in R but no
  /// mass and no stiffness. Sets the solver up first unless the last solve was one of these for the same stage (`again`).
  /// Throws SolverError when the solver did not converge.
  ParticleMotions<D> respond(const Stage<D>& stage, const ParticleLoads<D>& loads, double tolerance,
                             bool again);

  /// M = 2 m/dt.
  double inertia(double dt) const { return 2.0 * constants_.mass / dt; }
  bool has_mass() const { return constants_.mass > 0.0; }

  /// R on the mobile particles: free particles and constituents.
  const Resistance<D>& resistance() const { return resistance_.velocities().mobile(); }
  const RigidResistance<D>& rigid_resistance() const { return resistance_.velocities(); }
  /// Of all unknowns.
  const SpinResistance<D>& spin_resistance() const { return resistance_; }
  const PairList<D>& pair_list() const { return list_; }
  const DofMap<D>& dofs() { return motion_.dofs(); }
  Solver& solver() { return *solver_; }
  const Solver& solver() const { return *solver_; }
  PhaseSeconds& phases() { return phases_; }
  const PhaseSeconds& phases() const { return phases_; }
  SolverStatistics& statistics() { return statistics_; }
  const SolverStatistics& statistics() const { return statistics_; }

 private:
  void write_slips(Stage<D>& stage) const;
  Unknowns without_sliding_springs(const Stage<D>& stage, const StepWeights& weights,
                                   Unknowns load);
  void add_mean_flow(const Stage<D>& stage, Unknowns& q);
  void balance_momentum(const Unknowns& load, double shift, Unknowns& q);
  void note(const SolveReport& report);
  void judge_null_motions(const Stage<D>& stage);

  const Box<D> box_;
  Particles<D>& particles_;
  const PairModel<D>& model_;
  const Surroundings<D>& surroundings_;
  const ParticleConstants constants_;
  Motion<D> motion_;
  std::unique_ptr<Solver> solver_;
  DynamicsSettings settings_;
  PairList<D> list_;
  SpinResistance<D> resistance_;
  PhaseSeconds phases_;
  SolverStatistics statistics_;
  bool told_null_motions_ = false;
};

}  // namespace odpd
