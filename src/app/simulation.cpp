#include "odpd/app/simulation.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>

#include "odpd/app/calibration_file.h"
#include "odpd/core/error.h"
#include "odpd/core/isa.h"
#include "odpd/core/log.h"

namespace odpd {

namespace {

template <int D>
SceneSettings<D> scene_of(const Config& config) {
  SceneSettings<D> scene = read_scene_settings<D>(config, read_calibration(config));
  read_start_file(scene);
  return scene;
}

// The first value in which two cases differ, in words; empty when there is none.
std::string difference(const Config& saved, const Config& current) {
  const auto before = fixed_values(saved);
  const auto now = fixed_values(current);
  std::map<std::string, std::pair<std::string, std::string>> both;
  for (const auto& [path, value] : before) both[path].first = value;
  for (const auto& [path, value] : now) both[path].second = value;
  // Observers come last: their defaults follow from the rest.
  for (const bool of_observers : {false, true})
    for (const auto& [path, values] : both)
      if (values.first != values.second && path.starts_with("observe.") == of_observers)
        return fmt::format("'{}' was {} and is {}", path,
                           values.first.empty() ? "absent" : values.first,
                           values.second.empty() ? "absent" : values.second);
  return {};
}

// Identities i, j of each bond.
std::vector<std::int64_t> bond_ends(const std::vector<Bond>& bonds) {
  std::vector<std::int64_t> ends;
  for (const Bond& bond : bonds) ends.insert(ends.end(), {bond.i, bond.j});
  return ends;
}

// Their law's numbers, which a file may give.
std::vector<double> bond_numbers(const std::vector<Bond>& bonds) {
  std::vector<double> numbers;
  for (const Bond& bond : bonds)
    numbers.insert(numbers.end(), {bond.p.H, bond.p.r_0, bond.p.r_max});
  return numbers;
}

}  // namespace

template <int D>
Simulation<D>::Simulation(const Config& config, CaseSettings settings)
    : config_(config),
      settings_(std::move(settings)),
      clock_(settings_.clock),
      scene_(scene_of<D>(config)),
      dynamics_(scene_.box(), scene_.particles(), scene_.model(), scene_,
                make_solver(settings_.solver), settings_.dynamics),
      integrator_(make_integrator<D>(settings_.integrator)),
      observers_(make_observers(config, scene_, clock_, integrator_->in_time())),
      watch_of_state_(scene_, settings_.blow_up) {
  if (const std::string why = mass_objection(settings_.integrator.name, dynamics_.constants().mass);
      !why.empty())
    config.table("integrator").fail("name", why);
  if (const std::string why = bodies_objection(settings_.integrator.name);
      !why.empty() && dynamics_.dofs().bodies() > 0)
    config.table("integrator").fail("name", why);
  if (const std::string why = shear_objection(settings_.integrator.name);
      !why.empty() && scene_.box().shear)
    config.table("integrator").fail("name", why);
  config.reject_unread();
  integrator_->check(dynamics_);
  check_observables(config);
}

// A misspelt observable should not come out at the end of a long run.
template <int D>
void Simulation<D>::check_observables(const Config& config) const {
  for (const Config& check : config.tables("check")) check_observable(check);
  if (!settings_.until) return;
  const Config until = config.table("run").table("until");
  if (settings_.until->observable == "alarm_crossings")
    until.fail("observable",
               "'alarm_crossings' is a count without an error: name what is measured");
  if (settings_.until->observable.ends_with(".rms_deviation"))
    until.fail("observable", "it has no standard error: name what has one");
  check_observable(until);
}

template <int D>
void Simulation<D>::check_observable(const Config& entry) const {
  std::vector<std::string> names{"energy_per_particle", "pressure", "config_temperature"};
  if (dynamics_.constants().mass > 0.0 && integrator_->in_time())
    names.push_back("kinetic_temperature");
  if (integrator_->in_time()) names.push_back("diffusion");
  if (!scene_.settings().walls.empty()) names.push_back("alarm_crossings");
  for (const auto& observer : observers_) names.push_back(observer->settings().name);
  const std::string observable = entry.text("observable");
  const std::string stem = observable.substr(0, observable.find('.'));
  if (std::find(names.begin(), names.end(), stem) != names.end()) return;
  const std::string near = nearest_name(stem, names);
  entry.fail("observable",
             fmt::format("nothing in this case measures '{}'{}; names start with one of {}",
                         observable, near.empty() ? "" : fmt::format(", did you mean '{}'?", near),
                         fmt::join(names, ", ")));
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
  } catch (const BlowUpError& state) {
    throw BlowUpError(fmt::format("{}. What the step met: {}", state.what(), error.what()),
                      state.particle());
  }
  const auto* blow_up = dynamic_cast<const BlowUpError*>(&error);
  if (blow_up == nullptr) throw SolverError(what);
  throw BlowUpError(fmt::format("{}: the run has blown up. {}", what,
                                watch_of_state_.cure(settings_.integrator, judged(), clock_.dt,
                                                     blow_up->particle())),
                    blow_up->particle());
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
    const Vec<D>& v = particles.velocity[static_cast<std::size_t>(
        particles.index_of_id()[static_cast<std::size_t>(fastest)])];
    moved = fmt::format(", and particle {} moved furthest in the last step, by {:.3g}", fastest,
                        clock_.dt * std::sqrt(dot(v, v)));
  }
  throw BlowUpError(
      fmt::format("step {} (t = {:.6g}): the run has blown up: {}{}. {}", clock_.step,
                  clock_.time(), why, moved,
                  watch_of_state_.cure(settings_.integrator, judged(), clock_.dt, fastest)),
      fastest);
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
        "fail "
        "when that happens while they measure. Use denser layers, a higher wall.stiffness or a "
        "smaller integrator.dt",
        record.step, record.alarm_crossings));
  }
  if (clock_.measuring()) alarm_crossings_ += record.alarm_crossings;
  const PhaseTimer timer(dynamics_.phases(), Phase::measure);
  for (auto& observer : observers_)
    if (observer->is_due(clock_)) observer->measure(clock_, scene_.particles(), record);
  return record;
}

template <int D>
void Simulation<D>::run(const std::function<bool()>& stop,
                        const std::function<void()>& after_step) {
  while (!clock_.finished() && !stop()) {
    step();
    if (clock_.step % BlowUpWatch<D>::interval == 0) judge();
    stop_at_target();
    after_step();
  }
  judge();
}

template <int D>
Frame Simulation<D>::frame() const {
  const Particles<D>& particles = scene_.particles();
  Frame frame;
  frame.dimension = D;
  frame.step = clock_.step;
  frame.time = clock_.time();
  for (int c = 0; c < D; ++c) {
    frame.box_size.push_back(scene_.box().size[c]);
    frame.periodic.push_back(scene_.box().is_periodic(c));
  }
  if (const Box<D> box = scene_.box().at(clock_.time()); box.shear) {
    frame.edges.assign(static_cast<std::size_t>(D * D), 0.0);
    for (int c = 0; c < D; ++c) frame.edges[static_cast<std::size_t>(c * (D + 1))] = box.size[c];
    frame.edges[static_cast<std::size_t>(box.shear->gradient * D + box.shear->flow)] = box.offset;
  }
  for (const SpeciesSettings& s : scene_.settings().species) frame.species_names.push_back(s.name);
  frame.bonds = bond_ends(scene_.bonds());
  for (const std::int32_t index : particles.index_of_id()) {
    const auto i = static_cast<std::size_t>(index);
    frame.id.push_back(particles.id[i]);
    frame.species.push_back(particles.species[i]);
    frame.group.push_back(particles.group[i]);
    for (std::size_t c = 0; c < D; ++c) {
      frame.position.push_back(particles.position[i].x[c]);
      frame.image.push_back(particles.image[i][c]);
      frame.velocity.push_back(particles.velocity[i].x[c]);
    }
  }
  return frame;
}

template <int D>
Results Simulation<D>::results() const {
  Results results;
  for (const auto& observer : observers_) observer->add_results(results);
  if (!scene_.settings().walls.empty())
    results.scalars.push_back({"alarm_crossings", static_cast<double>(alarm_crossings_), 0.0});
  return results;
}

template <int D>
void Simulation<D>::save(CheckpointWriter& out) const {
  StateWriter& run = out.component("run");
  run.write_text("case", config_.resolved());
  run.write("counts", std::vector<std::int64_t>{clock_.step, alarm_crossings_});
  const PhaseSeconds& phases = dynamics_.phases();
  run.write("phase_seconds", std::vector<double>(phases.seconds.begin(), phases.seconds.end()));
  run.write("wall_seconds", std::vector<double>{wall_seconds()});
  const SolverStatistics& s = dynamics_.statistics();
  run.write("solver_counts", std::vector<std::int64_t>{s.solves, s.iterations, s.most_iterations,
                                                       s.clamped, s.fallbacks});
  run.write("solver_worst_residual", std::vector<double>{s.worst_residual});
  run.write_text("solver_problem", s.problem);
  if (const auto& shear = scene_.box().shear)
    run.write("shear_start", std::vector<double>{shear->start});
  run.write_text("instructions", std::string(isa_name(isa())));
  if (!scene_.bonds().empty()) {
    run.write("bonds", bond_ends(scene_.bonds()));
    run.write("bond_numbers", bond_numbers(scene_.bonds()));
  }
  if (const auto& calibration = scene_.settings().calibration)
    run.write("calibrated_gamma", std::vector<double>{calibration->fluid.gamma});
  dynamics_.solver().save(out.component("solver"));
  scene_.particles().save(out.component("particles"));
  integrator_->save(out.component("integrator"));
  watch_of_state_.save(out.component("blow_up"));
  for (std::size_t k = 0; k < observers_.size(); ++k)
    observers_[k]->save(out.component(fmt::format("observer_{}", k)));
}

template <int D>
void Simulation<D>::load(CheckpointReader& in) {
  const StateReader& run = in.component("run");
  const Config saved = Config::from_text(run.read_text("case"), "checkpoint");
  if (const std::string what = difference(saved, config_); !what.empty())
    throw ConfigError(fmt::format(
        "the checkpoint belongs to another case: {}. A restart may change run.duration, "
        "run.until, run.blow_up, [solver] (but not hold_centre_of_mass), [output], [[check]] and "
        "the number of threads, "
        "nothing else",
        what));
  if (!scene_.bonds().empty() && (run.read_integers("bonds") != bond_ends(scene_.bonds()) ||
                                  run.read_doubles("bond_numbers") != bond_numbers(scene_.bonds())))
    throw ConfigError(
        "the checkpoint has other bonds than the file of [bonds] now: restore that file");
  if (const auto& shear = scene_.box().shear;
      shear && run.read_doubles("shear_start").at(0) != shear->start)
    throw ConfigError(
        fmt::format("the images of the checkpoint's run began with an offset of {}, those of "
                    "start.file with {}: start.file must be the one of that run",
                    run.read_doubles("shear_start").at(0), shear->start));
  const auto& calibration = scene_.settings().calibration;
  if (run.has("calibrated_gamma") != calibration.has_value() ||
      (calibration &&
       run.read_doubles("calibrated_gamma") != std::vector<double>{calibration->fluid.gamma}))
    throw ConfigError(
        "the checkpoint has another friction than the file of fluid.calibration gives now: "
        "restore that file");
  const std::vector<std::int64_t> counts = run.read_integers("counts");
  clock_.step = counts.at(0);
  if (clock_.step > clock_.total_steps)
    throw ConfigError(fmt::format(
        "the checkpoint is at t = {:.6g}, after the end of this run at t = {:.6g}: raise "
        "run.duration",
        clock_.time(), static_cast<double>(clock_.total_steps) * clock_.dt));
  alarm_crossings_ = counts.at(1);
  const std::vector<double> seconds = run.read_doubles("phase_seconds");
  std::copy(seconds.begin(), seconds.end(), dynamics_.phases().seconds.begin());
  earlier_seconds_ = run.read_doubles("wall_seconds").at(0);
  const std::vector<std::int64_t> solver = run.read_integers("solver_counts");
  SolverStatistics& s = dynamics_.statistics();
  s.solves = solver.at(0);
  s.iterations = solver.at(1);
  s.most_iterations = solver.at(2);
  s.clamped = solver.at(3);
  s.fallbacks = solver.at(4);
  s.worst_residual = run.read_doubles("solver_worst_residual").at(0);
  s.problem = run.read_text("solver_problem");
  const std::int64_t expected = scene_.particles().size();
  scene_.particles().load(in.component("particles"));
  if (scene_.particles().size() != expected)
    throw ConfigError(fmt::format(
        "the checkpoint holds {} particles, the case has {}: it belongs to another case",
        scene_.particles().size(), expected));
  dynamics_.particles_replaced();
  if (const std::string path = run.read_text("instructions"); path != isa_name(isa()))
    log_warning(fmt::format(
        "the run so far took the instruction path {}, this process takes {}: rounding will differ "
        "(ODPD_ISA={} forces the former where the processor has it)",
        path, isa_name(isa()), path));
  dynamics_.solver().load(in.component("solver"), dynamics_.resistance());
  integrator_->load(in.component("integrator"));
  watch_of_state_.load(in.component("blow_up"));
  for (std::size_t k = 0; k < observers_.size(); ++k)
    observers_[k]->load(in.component(fmt::format("observer_{}", k)));
  stop_at_target();  // continued with a target that it had reached
}

template class Simulation<2>;
template class Simulation<3>;

}  // namespace odpd
