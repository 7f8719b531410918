#include "odpd/dynamics/dynamics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "odpd/core/error.h"
#include "odpd/core/index.h"
#include "odpd/core/log.h"
#include "odpd/core/parallel.h"
#include "odpd/operator/edge_sums.h"
#include "odpd/pairs/levers.h"
#include "odpd/pairs/noise.h"

namespace odpd {

namespace {

// P^T A P q where `add` adds the forces - A v of the edges.
template <int D, class Add>
std::vector<double> resisted(const Stage<D>& stage, const DofMap<D>& dofs,
                             const std::vector<double>& q, const Add& add) {
  std::vector<Vec<D>> velocity, force(stage.position.size());
  dofs.scatter(stage.arms, q, force, velocity);
  std::vector<Vec<D>> spin, torque;
  if (dofs.any_spin()) {
    torque.resize(force.size());
    dofs.scatter_spins(q, torque, spin);
  }
  add(stage.network, velocity, spin, force, torque);
  std::vector<double> f;
  dofs.gather(stage.arms, force, torque, f);
  for (double& value : f) value = -value;
  return f;
}

// Forces along e, which turn nobody.
template <int D, class Add>
auto along_edges(const Add& add) {
  return [&add](const PairNetwork<D>& network, std::span<const Vec<D>> velocity,
                std::span<const Vec<D>>, std::vector<Vec<D>>& force,
                std::vector<Vec<D>>&) { add(network, velocity, force); };
}

// Solves that leave no trace in the solver.
class Unremembered {
 public:
  explicit Unremembered(Solver& solver) : solver_(solver) { solver_.remember(false); }
  ~Unremembered() { solver_.remember(true); }
  Unremembered(const Unremembered&) = delete;
  Unremembered& operator=(const Unremembered&) = delete;

 private:
  Solver& solver_;
};

}  // namespace

void SolverStatistics::add(const SolveReport& report) {
  ++solves;
  iterations += report.iterations;
  most_iterations = std::max(most_iterations, report.iterations);
  worst_residual = std::max(worst_residual, report.residual);
  problem = report.problem;
}

void SolverStatistics::save(StateWriter& out) const {
  out.write("solver_counts",
            std::vector<std::int64_t>{solves, iterations, most_iterations, clamped, fallbacks});
  out.write("solver_worst_residual", std::vector<double>{worst_residual});
  out.write_text("solver_problem", problem);
}

void SolverStatistics::load(const StateReader& in) {
  const std::vector<std::int64_t> counts = in.read_integers("solver_counts");
  solves = counts.at(0);
  iterations = counts.at(1);
  most_iterations = counts.at(2);
  clamped = counts.at(3);
  fallbacks = counts.at(4);
  worst_residual = in.read_doubles("solver_worst_residual").at(0);
  problem = in.read_text("solver_problem");
}

template <int D>
Dynamics<D>::Dynamics(const Box<D>& box, Particles<D>& particles, const PairModel<D>& model,
                      const Surroundings<D>& surroundings, std::unique_ptr<Solver> solver,
                      const DynamicsSettings& settings)
    : box_(box),
      particles_(particles),
      model_(model),
      surroundings_(surroundings),
      constants_(surroundings.constants()),
      motion_(box, particles, surroundings),
      solver_(std::move(solver)),
      settings_(settings),
      list_(box, model.cutoff(), settings.skin),
      resistance_(box, settings.hold_centre_of_mass) {
  if (has_mass()) particles_.carry_inertia();
  if (!particles_.spin_of_species.empty()) particles_.carry_spins(has_mass());
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
  {
    const PhaseTimer timer(phases_, Phase::neighbours);
    motion_.locate(positions, time, stage);
    list_.slide(stage.box);
    list_.update(stage.position, particles_.owned());
  }
  const PhaseTimer timer(phases_, Phase::edges);
  particles_.ranks().together([&] {
    model_.write_edges(list_, stage.box, stage.position, particles_, stage.network);
    model_.refuse_unknown(stage.network, particles_);
  });
  stage.network.owned = particles_.owned();
  write_levers(particles_, stage.network);
  write_slips(stage);
  stage.potential_force.resize(positions.size());
  stage.driving_force.resize(positions.size());
  parallel_for(static_cast<std::int64_t>(positions.size()), [&](std::int64_t particle) {
    const auto i = index(particle);
    stage.potential_force[i] = stage.driving_force[i] = Vec<D>{};
  });
  if (model_.conservative()) add_conservative_forces(stage.network, stage.potential_force);
  surroundings_.add_potential_forces(particles_, stage.position, stage.potential_force);
  surroundings_.add_driving_forces(particles_, stage.position, time, stage.driving_force);
}

template <int D>
auto Dynamics<D>::draw_noise(const Stage<D>& stage, std::int64_t step, double dt,
                             std::vector<Vec<D>>& edge_noise) -> Unknowns {
  const PhaseTimer timer(phases_, Phase::noise);
  if (!model_.thermal()) {
    edge_noise.clear();
    return Unknowns(index(motion_.dofs().unknowns()), 0.0);
  }
  draw_edge_noise(stage.network, particles_, settings_.seed, static_cast<std::uint64_t>(step), dt,
                  edge_noise);
  std::vector<Vec<D>> force(stage.position.size());
  add_edge_forces<D>(stage.network, edge_noise, force);
  std::vector<Vec<D>> torque(stage.spin.size());
  add_edge_torques<D>(stage.network, edge_noise, torque);
  if (constants_.zeta_0 > 0.0)
    add_drag_noise(particles_, settings_.seed, static_cast<std::uint64_t>(step),
                   std::sqrt(2.0 * constants_.kT * constants_.zeta_0 / dt), force);
  Unknowns xi;
  motion_.dofs().gather(stage.arms, force, torque, xi);
  return xi;
}

template <int D>
auto Dynamics<D>::force(const Stage<D>& stage) -> Unknowns {
  const PhaseTimer timer(phases_, Phase::assembly);
  std::vector<Vec<D>> force(stage.position.size());
  parallel_for(static_cast<std::int64_t>(force.size()), [&](std::int64_t particle) {
    const auto i = index(particle);
    force[i] = stage.potential_force[i] + stage.driving_force[i];
  });
  std::vector<Vec<D>> torque(stage.spin.size());
  if (motion_.dofs().mobile() < motion_.dofs().particles()) {
    std::vector<std::int32_t> known;
    for (std::size_t i = 0; i < force.size(); ++i)
      if (particles_.is_known(i)) known.push_back(static_cast<std::int32_t>(i));
    add_known_friction<D>(stage.network, known, stage.velocity, stage.spin, force, torque);
  }
  add_sliding_friction(stage.network, force);
  add_sliding_torques(stage.network, torque);
  Unknowns f;
  motion_.dofs().gather(stage.arms, force, torque, f);
  const std::span<double> of_nodes = motion_.dofs().velocities(std::span(f));
  for (std::size_t b = 0; b < index(motion_.dofs().bodies()); ++b) {
    const RigidLoad<D> load = surroundings_.body_load(b, stage.time);
    for (std::size_t c = 0; c < D; ++c) {
      of_nodes[b * D + c] += load.torque.x[c];
      of_nodes[motion_.dofs().body_node(b) * D + c] += load.force.x[c];
    }
  }
  return f;
}

template <int D>
auto Dynamics<D>::friction(const Stage<D>& stage, const Unknowns& q) -> Unknowns {
  const PhaseTimer timer(phases_, Phase::assembly);
  return resisted(
      stage, motion_.dofs(), q,
      [](const PairNetwork<D>& network, std::span<const Vec<D>> velocity,
         std::span<const Vec<D>> spin, std::vector<Vec<D>>& force, std::vector<Vec<D>>& torque) {
        add_friction_forces<D>(network, velocity, force, spin);
        add_friction_torques<D>(network, velocity, spin, torque);
      });
}

template <int D>
auto Dynamics<D>::spring(const Stage<D>& stage, const Unknowns& q) -> Unknowns {
  const PhaseTimer timer(phases_, Phase::assembly);
  return resisted(stage, motion_.dofs(), q, along_edges<D>(add_spring_forces<D>));
}

template <int D>
auto Dynamics<D>::bond_spring(const Stage<D>& stage, const Unknowns& q) -> Unknowns {
  const PhaseTimer timer(phases_, Phase::assembly);
  return resisted(stage, motion_.dofs(), q, along_edges<D>(add_bond_springs<D>));
}

template <int D>
auto Dynamics<D>::total_force(const Stage<D>& stage, const Unknowns& q) -> Unknowns {
  Unknowns f = force(stage);
  const Unknowns drag = friction(stage, q);
  Unknowns background = motion_.times_inertia(stage, q, constants_.zeta_0);
  std::fill_n(background.begin(), motion_.dofs().spins() * D, 0.0);  // the drag knows no spins
  for (std::size_t k = 0; k < f.size(); ++k) f[k] -= drag[k] + background[k];
  return f;
}

template <int D>
const System& Dynamics<D>::assemble(const Stage<D>& stage, const StepWeights& weights) {
  const PhaseTimer timer(phases_, Phase::assembly);
  resistance_.slide(stage.box);
  resistance_.rebuild(stage.network, motion_.dofs(), particles_, stage.position, stage.arms,
                      {weights.inertia, constants_.zeta_0}, weights.stiffness_time,
                      weights.bond_time);
  if (weights.stiffness_time > 0.0) {
    std::int64_t clamped = 0;
    for (std::size_t k = 0; k < stage.network.k_c.size(); ++k)
      if (stage.network.k_c[k] < 0.0 && stage.network.counts(k)) ++clamped;
    statistics_.clamped += particles_.ranks().sum(clamped);
  }
  return resistance_.system();
}

/// Summed over all particles, A q = load says (inertia + zeta_0) sum q = sum load where all else is pairwise.
template <int D>
void Dynamics<D>::balance_momentum(const Unknowns& load, double shift, Unknowns& q) {
  const Translations translations = motion_.dofs().translations();
  Unknowns difference(q.size());
  for (std::size_t k = 0; k < q.size(); ++k) difference[k] = load[k] / shift - q[k];
  const Share share = motion_.dofs().share();
  std::vector<double> excess = translations.sums(difference, share);
  const double nodes = translations.squares(q.size(), share);
  for (double& component : excess) component *= 1.0 / nodes;
  translations.add(excess, q);
}

template <int D>
void Dynamics<D>::note(const SolveReport& report) {
  phases_[Phase::assembly] += report.assembly_seconds;
  phases_[Phase::solve] -= report.assembly_seconds;
  if (!report.converged)
    throw SolverError(
        fmt::format("solver '{}' did not converge: {}", solver_->name(), report.failure),
        SolverError::Cause::not_converged);
  statistics_.add(report);
  if (report.note.empty()) return;
  if (++statistics_.fallbacks == 1) log_warning(fmt::format("solver: {}", report.note));
}

template <int D>
void Dynamics<D>::solve(Stage<D>& stage, const Unknowns& load, const StepWeights& weights,
                        Unknowns& guess) {
  const System& system = assemble(stage, weights);
  judge_null_motions(stage);
  Unknowns changed;  // the load, where it is not to be taken as it is
  if (box_.shear) {
    changed = without_sliding_springs(stage, weights, load);
  } else if (motion_.dofs().bodies() > 0 || motion_.dofs().spins() > 0) {
    changed = load;
  }
  {
    const PhaseTimer timer(phases_, Phase::solve);
    solver_->bind(system);
    resistance_.scale_load(changed);
    resistance_.scale_velocity(guess);
    stage.report = solver_->solve(changed.empty() ? load : changed, guess);
    resistance_.unscale_velocity(guess);
  }
  note(stage.report);
  const double shift = weights.inertia + constants_.zeta_0;
  if (shift > 0.0 && !guess.empty() && motion_.dofs().nodes() == motion_.dofs().particles() &&
      particles_.bodies.empty() && !system.holds_centre_of_mass())
    balance_momentum(load, shift, guess);
  if (box_.shear && system.translations_are_null()) add_mean_flow(stage, guess);
  stage.velocity = motion_.velocities(stage, guess);
  stage.spin = motion_.spins(stage, guess);
  const Share own = particles_.owned();
  own.ranks->together([&] {
    for (auto i = index(own.first); i < index(own.last); ++i)
      if (!finite(stage.velocity[i]) || !(stage.spin.empty() || finite(stage.spin[i])))
        throw BlowUpError(
            fmt::format("the velocity of particle {} is not finite", particles_.id[i]),
            particles_.id[i]);
  });
}

template <int D>
ParticleMotions<D> Dynamics<D>::respond(const Stage<D>& stage, const ParticleLoads<D>& loads,
                                        double tolerance, bool again) {
  const Stopwatch watch;
  const Unremembered aside(*solver_);
  const System& system = again ? resistance_.system() : assemble(stage, {});
  Unknowns load;
  motion_.dofs().gather(stage.arms, loads.force, loads.torque, load);
  Unknowns q(load.size(), 0.0);
  SolveReport report;
  {
    const PhaseTimer timer(phases_, Phase::solve);
    if (!again) solver_->bind(system);
    resistance_.scale_load(load);
    report = solver_->solve(load, q, tolerance);
    resistance_.unscale_velocity(q);
  }
  note(report);
  const std::vector<Vec<D>> still(stage.position.size());
  ParticleMotions<D> motions;
  motion_.dofs().scatter(stage.arms, q, still, motions.velocity);
  motion_.dofs().scatter_spins(q, still, motions.spin);
  // Observers ask for this while their own time is taken.
  phases_[Phase::measure] -= watch.seconds();
  return motions;
}

template class Dynamics<2>;
template class Dynamics<3>;

}  // namespace odpd
