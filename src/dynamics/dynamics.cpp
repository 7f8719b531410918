#include "odpd/dynamics/dynamics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "odpd/core/error.h"
#include "odpd/operator/edge_sums.h"
#include "odpd/pairs/noise.h"

namespace odpd {

template <int D>
Dynamics<D>::Dynamics(const Box<D>& box, Particles<D>& particles, const PairModel<D>& model,
                      const Surroundings<D>& surroundings, std::unique_ptr<Solver> solver,
                      const DynamicsSettings& settings)
    : box_(box),
      particles_(particles),
      model_(model),
      surroundings_(surroundings),
      solver_(std::move(solver)),
      settings_(settings),
      list_(box, model.cutoff(), settings.skin),
      resistance_(box, settings.hold_centre_of_mass) {}

template <int D>
const DofMap<D>& Dynamics<D>::dofs() {
  if (!dofs_) dofs_ = std::make_unique<DofMap<D>>(particles_);
  return *dofs_;
}

template <int D>
void Dynamics<D>::reorder_if_due(std::int64_t step) {
  if (settings_.reorder_every == 0 || step % settings_.reorder_every != 0) return;
  const PhaseTimer timer(phases_, Phase::neighbours);
  particles_.reorder(spatial_order<D>(box_, model_.cutoff(), particles_.position, particles_.id));
  particles_replaced();
}

template <int D>
void Dynamics<D>::evaluate(std::span<const Vec<D>> positions, double time, Stage<D>& stage) {
  for (std::size_t i = 0; i < positions.size(); ++i)
    if (!finite(positions[i]))
      throw SolverError(fmt::format(
          "the position of particle {} at t = {:.6g} is not finite: continue from the last "
          "checkpoint, with a smaller integrator.dt",
          particles_.id[i], time));
  stage.time = time;
  stage.position.assign(positions.begin(), positions.end());
  {
    const PhaseTimer timer(phases_, Phase::neighbours);
    list_.update(stage.position);
  }
  const PhaseTimer timer(phases_, Phase::edges);
  model_.write_edges(list_, box_, stage.position, particles_, stage.network);
  stage.potential_force.assign(stage.position.size(), Vec<D>{});
  if (model_.conservative()) add_conservative_forces(stage.network, stage.potential_force);
  surroundings_.add_potential_forces(particles_, stage.position, stage.potential_force);
  stage.driving_force.assign(stage.position.size(), Vec<D>{});
  surroundings_.add_driving_forces(particles_, time, stage.driving_force);
  stage.velocity.assign(stage.position.size(), Vec<D>{});
  for (std::size_t i = 0; i < stage.position.size(); ++i)
    if (!particles_.is_free(i))
      stage.velocity[i] = surroundings_.known_velocity(particles_.group[i], time);
}

template <int D>
std::vector<double> Dynamics<D>::draw_noise(const Stage<D>& stage, std::int64_t step, double dt,
                                            std::vector<Vec<D>>& edge_noise) {
  const PhaseTimer timer(phases_, Phase::noise);
  edge_noise.clear();
  if (!model_.thermal())
    return std::vector<double>(static_cast<std::size_t>(dofs().unknowns()), 0.0);
  draw_edge_noise(stage.network, particles_, settings_.seed, static_cast<std::uint64_t>(step), dt,
                  edge_noise);
  std::vector<Vec<D>> force(stage.position.size());
  add_edge_forces<D>(stage.network, edge_noise, force);
  std::vector<double> xi;
  dofs().gather(force, xi);
  return xi;
}

template <int D>
std::vector<double> Dynamics<D>::right_hand_side(Stage<D>& stage, const std::vector<double>& xi) {
  const PhaseTimer timer(phases_, Phase::assembly);
  resistance_.rebuild(stage.network, dofs(), particles_, stage.position, 0.0);
  std::vector<Vec<D>> force(stage.position.size());
  for (std::size_t i = 0; i < force.size(); ++i)
    force[i] = stage.potential_force[i] + stage.driving_force[i];
  // Free particles still have velocity zero here, so this is - R v_known.
  if (dofs().nodes() < dofs().particles())
    add_friction_forces<D>(stage.network, stage.velocity, force);
  std::vector<double> b;
  dofs().gather(force, b);
  for (std::size_t k = 0; k < b.size(); ++k) b[k] += xi[k];
  return b;
}

template <int D>
void Dynamics<D>::solve(Stage<D>& stage, const std::vector<double>& xi,
                        std::vector<double>& guess) {
  const std::vector<double> b = right_hand_side(stage, xi);
  {
    const PhaseTimer timer(phases_, Phase::solve);
    solver_->bind(resistance_);
    stage.report = solver_->solve(b, guess);
  }
  const SolveReport& report = stage.report;
  phases_[Phase::assembly] += report.assembly_seconds;
  phases_[Phase::solve] -= report.assembly_seconds;
  if (!report.converged)
    throw SolverError(
        fmt::format("solver '{}' did not converge: {}", solver_->name(), report.failure));
  ++statistics_.solves;
  statistics_.iterations += report.iterations;
  statistics_.most_iterations = std::max(statistics_.most_iterations, report.iterations);
  statistics_.worst_residual = std::max(statistics_.worst_residual, report.residual);
  statistics_.problem = report.problem;
  const std::vector<Vec<D>> known = stage.velocity;
  dofs().scatter(guess, known, stage.velocity);
  for (std::size_t i = 0; i < stage.velocity.size(); ++i)
    if (!finite(stage.velocity[i]))
      throw SolverError(fmt::format(
          "the velocity of particle {} is not finite; reduce integrator.dt", particles_.id[i]));
}

template <int D>
void Dynamics<D>::check_paths(const std::vector<Vec<D>>& velocity, double dt) const {
  for (std::size_t i = 0; i < velocity.size(); ++i)
    for (int c = 0; c < D; ++c) {
      const double path = dt * velocity[i][c];
      if (std::abs(path) < 0.5 * box_.size[c]) continue;
      throw SolverError(
          fmt::format("particle {} would move {:.3g} in direction {}, more than half the "
                      "box ({:.3g}): the run has blown "
                      "up; reduce integrator.dt (explicit repulsion wants dt below 0.2 gamma/a)",
                      particles_.id[i], path, "xyz"[c], box_.size[c]));
    }
}

template <int D>
std::vector<Vec<D>> Dynamics<D>::displaced(const std::vector<Vec<D>>& velocity, double dt,
                                           std::int64_t& crossings) const {
  check_paths(velocity, dt);
  std::vector<Vec<D>> r = particles_.position;
  for (std::size_t i = 0; i < r.size(); ++i) {
    r[i] += dt * velocity[i];
    box_.wrap(r[i]);
    if (particles_.is_free(i) && surroundings_.confine(r[i])) ++crossings;
  }
  return r;
}

template <int D>
std::int64_t Dynamics<D>::move(const std::vector<Vec<D>>& velocity, double dt) {
  check_paths(velocity, dt);
  std::int64_t crossings = 0;
  for (std::size_t i = 0; i < velocity.size(); ++i) {
    particles_.position[i] += dt * velocity[i];
    particles_.velocity[i] = velocity[i];
    box_.wrap(particles_.position[i], particles_.image[i]);
    if (particles_.is_free(i) && surroundings_.confine(particles_.position[i])) ++crossings;
  }
  return crossings;
}

template class Dynamics<2>;
template class Dynamics<3>;

}  // namespace odpd
