#include "odpd/app/simulation.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "odpd/app/memory.h"
#include "odpd/core/error.h"
#include "odpd/core/index.h"
#include "odpd/core/log.h"

namespace odpd {

namespace {

template <int D>
SceneSettings<D> scene_that_fits(const Config& config, CheckpointReader* restart) {
  SceneSettings<D> scene = read_scene<D>(config, restart);
  check_memory(scene);
  return scene;
}

// Why an observer gives no numbers and no table.
std::string unsampled(const ObserverSettings& observer, std::int64_t measured_steps) {
  return fmt::format(
      "{}: nothing was sampled, so its numbers are undefined and it has no table: {}, and {} "
      "step(s) were measured",
      observer.name,
      observer.from > 0 ? fmt::format("it samples every {} step(s) after the first {}",
                                      observer.every, observer.from)
                        : fmt::format("every = {}", observer.every),
      measured_steps);
}

}  // namespace

template <int D>
Simulation<D>::Simulation(const Config& config, CaseSettings settings,
                          const std::vector<ObserverKind<D>>& own_observers,
                          CheckpointReader* restart, const Communicator& ranks)
    : config_(config),
      settings_(std::move(settings)),
      clock_(settings_.clock),
      scene_(scene_that_fits<D>(config, restart), ranks),
      dynamics_(scene_.box(), scene_.particles(), scene_.model(), scene_,
                make_solver(settings_.solver), settings_.dynamics),
      integrator_(make_integrator<D>(settings_.integrator)),
      observers_(make_observers(config, scene_, clock_,
                                integrator_traits(settings_.integrator.name), own_observers)),
      watch_of_state_(scene_, settings_.blow_up) {
  if (const std::string why = mass_objection(settings_.integrator.name, dynamics_.constants().mass);
      !why.empty())
    config.table("integrator").fail("name", why);
  if (const std::string why = bodies_objection(settings_.integrator.name);
      !why.empty() && dynamics_.dofs().bodies() > 0)
    config.table("integrator").fail("name", why);
  if (const std::vector<Spin>& spins = scene_.particles().spin_of_species; !spins.empty()) {
    const bool massless = std::any_of(spins.begin(), spins.end(), [](const Spin& s) {
      return s.lever_radius > 0.0 && s.moment == 0.0;
    });
    if (const std::string why = spin_objection(settings_.integrator.name, massless); !why.empty())
      config.table("integrator").fail("name", why);
  }
  if (const std::string why = shear_objection(settings_.integrator.name);
      !why.empty() && scene_.box().shear)
    config.table("integrator").fail("name", why);
  refuse_densities(config);
  config.reject_unread();
  integrator_->prepare(dynamics_);
  check_observables(config);
}

template <int D>
void Simulation<D>::refuse_densities(const Config& config) const {
  const Config integrator = config.table("integrator");
  const PairModel<D>& model = scene_.model();
  if (model.densities() != nullptr &&
      !integrator_traits(settings_.integrator.name).repulsion_limits_dt && in_time())
    integrator.fail("name",
                    fmt::format("'{}' takes the stiffness of pairs, and that of densities couples "
                                "partners of partners: use trapezoidal",
                                settings_.integrator.name));
  const auto reference = model.reference_state(dynamics_.constants().mass);
  if (reference && in_time() && clock_.dt >= reference->stable_step)
    integrator.fail(
        "dt", fmt::format("is {}: from {:.3g} on steps are unstable, and accurate up to about "
                          "{:.2g}",
                          clock_.dt, reference->stable_step, reference->accurate_step));
}

// A misspelt observable should not come out at the end of a long run.
template <int D>
void Simulation<D>::check_observables(const Config& config) const {
  const Results measured = results();
  const auto check = [&](const Config& entry) {
    if (const std::string why = measured.objection(entry.text("observable")); !why.empty())
      entry.fail("observable", why);
  };
  for (const Config& entry : config.tables("check")) check(entry);
  if (!settings_.until) return;
  const Config until = config.table("run").table("until");
  check(until);
  if (!measured.find(settings_.until->observable)->has_error)
    until.fail("observable", fmt::format("'{}' has no standard error: name what has one",
                                         settings_.until->observable));
}

// The integrator's step; what goes wrong in it leaves the state as it was.
template <int D>
const StepRecord<D>& Simulation<D>::named_step() {
  const SolverStatistics before = dynamics_.statistics();
  try {
    return integrator_->step(dynamics_, clock_);
  } catch (const SolverError& e) {
    dynamics_.statistics() = before;
    explain(e);
  }
}

// With the number of the step, and whether the state it met, or the step itself, is what has blown up.
template <int D>
void Simulation<D>::explain(const SolverError& error) {
  const std::string what = fmt::format("step {}: {}", clock_.step, error.what());
  judged_step_ = -1;  // the step may have reordered memory
  try {
    judge();
  } catch (const BondTooLongError&) {
    throw;
  } catch (const BlowUpError& state) {
    throw BlowUpError(fmt::format("{}. What the step met: {}", state.what(), error.what()),
                      state.particle());
  }
  const auto* blow_up = dynamic_cast<const BlowUpError*>(&error);
  if (blow_up == nullptr) throw SolverError(what, error.cause());
  refuse_long_bond(error, what);
  throw BlowUpError(fmt::format("{}: the run has blown up. {}", what,
                                watch_of_state_.cure(settings_.integrator, judged(), clock_.dt,
                                                     blow_up->particle())),
                    blow_up->particle());
}

// A bond that no smaller step cures says itself what does.
template <int D>
void Simulation<D>::refuse_long_bond(const SolverError& error, const std::string& message) const {
  const auto* bond = dynamic_cast<const BondTooLongError*>(&error);
  const bool large_step = repulsion_is_explicit(settings_.integrator) &&
                          clock_.dt > scene_.explicit_step_limit().value_or(clock_.dt);
  if (bond != nullptr && !large_step && !bonds_are_explicit(settings_.integrator))
    throw BondTooLongError(message, bond->particle());
}

template <int D>
void Simulation<D>::judge() {
  if (judged_step_ == clock_.step) return;
  const std::int64_t fastest = watch_of_state_.fastest();
  const Particles<D>& particles = scene_.particles();
  std::string why;
  try {
    dynamics_.evaluate(particles.position, clock_.time(), judged());
    why = watch_of_state_.judge(judged(), clock_.dt);
  } catch (const BlowUpError& e) {
    refuse_long_bond(e,
                     fmt::format("step {} (t = {:.6g}): {}", clock_.step, clock_.time(), e.what()));
    why = e.what();
    judged().network = PairNetwork<D>{};
  }
  if (why.empty()) {
    judged_step_ = clock_.step;
    last_good_ = frame();
    return;
  }
  std::string moved;
  if (fastest >= 0) {
    const Vec<D>& v = particles.velocity[index(particles.index_of_id()[index(fastest)])];
    moved = fmt::format(", and particle {} moved furthest in the last step, by {:.3g}", fastest,
                        clock_.dt * std::sqrt(dot(v, v)));
  }
  throw BlowUpError(
      fmt::format("step {} (t = {:.6g}): the run has blown up: {}{}. {}", clock_.step,
                  clock_.time(), why, moved,
                  watch_of_state_.cure(settings_.integrator, judged(), clock_.dt, fastest)),
      fastest);
}

template <int D>
Frame Simulation<D>::frame() {
  if (scene_.model().densities() == nullptr) return scene_frame(scene_, clock_);
  judge();
  return scene_frame<D>(scene_, clock_, judged().network.densities.d);
}

// Looked at 16 to 32 times per doubling of the measured steps: a matter of their number alone.
template <int D>
void Simulation<D>::stop_at_target() {
  if (!settings_.until || !clock_.measuring()) return;
  const auto measured = static_cast<std::uint64_t>(clock_.measured_steps());
  if (measured % std::max<std::uint64_t>(1, std::bit_floor(measured) / 16) != 0) return;
  const Results now = results();
  const Scalar* scalar = now.find(settings_.until->observable);
  if (scalar == nullptr || !(scalar->standard_error <= settings_.until->standard_error)) return;
  stopped_at_target_ = true;
  clock_.total_steps = clock_.step;
}

template <int D>
const StepRecord<D>& Simulation<D>::step() {
  Clock after = clock_;
  after.advance();
  clock_.sampled = std::any_of(observers_.begin(), observers_.end(),
                               [&](const auto& observer) { return observer->is_due(after); });
  const StepRecord<D>& record = named_step();
  clock_.advance();
  if (record.alarm_crossings > 0 && !alarmed_) {
    alarmed_ = true;
    log_warning(fmt::format(
        "step {}: {} particle(s) crossed a wall and were caught by the mirror behind it; checks "
        "fail when that happens while they measure. Use denser layers, a higher wall.stiffness "
        "or a smaller integrator.dt",
        record.step, record.alarm_crossings));
  }
  if (clock_.measuring()) alarm_crossings_ += record.alarm_crossings;
  const PhaseTimer timer(dynamics_.phases(), Phase::measure);
  for (auto& observer : observers_) {
    if (!observer->is_due(clock_)) continue;
    try {
      observer->measure(clock_, scene_.particles(), record);
    } catch (const SolverError& error) {
      throw SolverError(fmt::format("step {}: in a solve for the observer '{}': {}", record.step,
                                    observer->settings().name, error.what()),
                        error.cause());
    }
  }
  return record;
}

template <int D>
void Simulation<D>::run(const std::function<bool()>& stop,
                        const std::function<void()>& after_step) {
  while (!clock_.finished() && !scene_.particles().ranks().any(stop())) {
    step();
    if (clock_.step % BlowUpWatch<D>::interval == 0) judge();
    stop_at_target();
    after_step();
  }
  judge();
}

template <int D>
Results Simulation<D>::results() const {
  Results results;
  for (const auto& observer : observers_) {
    observer->add_results(results);
    if (clock_.measuring() && observer->samples_due(clock_) == 0)
      results.notes.push_back(unsampled(observer->settings(), clock_.measured_steps()));
  }
  if (!scene_.settings().walls.empty())
    results.scalars.push_back(
        without_error("alarm_crossings", static_cast<double>(alarm_crossings_), 0.0));
  return results;
}

template class Simulation<2>;
template class Simulation<3>;

}  // namespace odpd
