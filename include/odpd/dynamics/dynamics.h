#pragma once
// The massless balance of forces at one configuration,
//
//   P^T R P q = P^T (F_C + F_ext - R v_known) + xi,   xi = P^T F_B,      v = P q + v_known
//
// (Phan-Thien et al. 2016, eq. 14-18), in the pieces that integrators put together.
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "odpd/core/timer.h"
#include "odpd/dynamics/step_record.h"
#include "odpd/dynamics/surroundings.h"
#include "odpd/geometry/pair_list.h"
#include "odpd/operator/resistance.h"
#include "odpd/pairs/pair_model.h"
#include "odpd/solvers/solver.h"

namespace odpd {

struct DynamicsSettings {
  std::uint64_t seed = 1;
  double skin = 0.4;                 ///< of the pair list (length)
  bool hold_centre_of_mass = false;  ///< solve the problem of Scheme 2
  std::int64_t reorder_every = 100;  ///< steps between spatial reorderings of memory; 0: never
};

/// Sums over all solves of a run.
struct SolverStatistics {
  std::int64_t solves = 0;
  std::int64_t iterations = 0;
  std::int64_t most_iterations = 0;
  double worst_residual = 0.0;
  std::string problem;  ///< which problem was solved, in words
};

template <int D>
class Dynamics {
 public:
  /// References must outlive this object. Throws ConfigError when the box is too small for the cutoff.
  Dynamics(const Box<D>& box, Particles<D>& particles, const PairModel<D>& model,
           const Surroundings<D>& surroundings, std::unique_ptr<Solver> solver,
           const DynamicsSettings& settings);

  Particles<D>& particles() { return particles_; }
  const Box<D>& box() const { return box_; }

  /// The particles were replaced (a checkpoint was read): forget what was derived from them.
  void particles_replaced() {
    list_.invalidate();
    dofs_.reset();
  }
  /// Brings memory into spatial order when this step is due for it (a function of the step number alone).
  void reorder_if_due(std::int64_t step);
  /// Fills position, edges and forces of a stage at the given positions and time. Throws SolverError for a position
  /// that is not finite.
  void evaluate(std::span<const Vec<D>> positions, double time, Stage<D>& stage);
  /// Draws F_B of the stage's edges and returns xi = P^T F_B as unknowns (zero, and nothing drawn, at kT = 0).
  std::vector<double> draw_noise(const Stage<D>& stage, std::int64_t step, double dt,
                                 std::vector<Vec<D>>& edge_noise);
  /// Assembles the stage's system and right-hand side for the given xi, with known velocities of the stage's time.
  std::vector<double> right_hand_side(Stage<D>& stage, const std::vector<double>& xi);
  /// Solves for the stage's velocities. `guess` in, answer out (unknowns). Throws SolverError when the solver did
  /// not converge or a velocity is not finite.
  void solve(Stage<D>& stage, const std::vector<double>& xi, std::vector<double>& guess);
  /// position + dt velocity, wrapped; a particle that moves further than half the box throws, as in `move`.
  /// Adds the mirror's catches to `crossings`.
  std::vector<Vec<D>> displaced(const std::vector<Vec<D>>& velocity, double dt,
                                std::int64_t& crossings) const;
  /// Moves the particles by dt velocity and remembers it; returns the mirror's catches. Throws SolverError when a
  /// particle moves further than half the box in one step.
  std::int64_t move(const std::vector<Vec<D>>& velocity, double dt);

  const Resistance<D>& resistance() const { return resistance_; }
  const PairList<D>& pair_list() const { return list_; }
  const DofMap<D>& dofs();
  Solver& solver() { return *solver_; }
  PhaseSeconds& phases() { return phases_; }
  const PhaseSeconds& phases() const { return phases_; }
  SolverStatistics& statistics() { return statistics_; }
  const SolverStatistics& statistics() const { return statistics_; }

 private:
  void check_paths(const std::vector<Vec<D>>& velocity, double dt) const;

  const Box<D> box_;
  Particles<D>& particles_;
  const PairModel<D>& model_;
  const Surroundings<D>& surroundings_;
  std::unique_ptr<Solver> solver_;
  DynamicsSettings settings_;
  PairList<D> list_;
  std::unique_ptr<DofMap<D>> dofs_;
  Resistance<D> resistance_;
  PhaseSeconds phases_;
  SolverStatistics statistics_;
};

}  // namespace odpd
