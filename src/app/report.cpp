#include "odpd/app/report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "odpd/app/suspension_report.h"
#include "odpd/core/parallel.h"
#include "odpd/io/json.h"
#include "odpd/version.h"

namespace odpd {

namespace {

template <int D>
std::int64_t free_particles(const Simulation<D>& simulation) {
  return simulation.scene().particles().free_count();
}

double phase_total(const PhaseSeconds& phases) {
  double total = 0.0;
  for (const double s : phases.seconds) total += s;
  return total;
}

JsonObject phases_json(const PhaseSeconds& phases) {
  JsonObject json;
  for (std::size_t p = 0; p < phases.seconds.size(); ++p)
    json.set(std::string(phase_name(static_cast<Phase>(p))), phases.seconds[p]);
  return json;
}

template <int D>
JsonObject solver_json(const Simulation<D>& simulation) {
  const SolverStatistics& s = simulation.dynamics().statistics();
  const SolverOptions& options = simulation.settings().solver;
  const double solves = static_cast<double>(std::max<std::int64_t>(s.solves, 1));
  JsonObject json;
  json.set("name", options.name).set("tolerance", options.tolerance).set("problem", s.problem);
  json.set("stopping", options.stopping == Stopping::increment ? "increment" : "residual");
  json.set("holds_centre_of_mass", simulation.settings().dynamics.hold_centre_of_mass);
  json.set("solves", s.solves)
      .set("iterations", s.iterations)
      .set("most_iterations", s.most_iterations);
  json.set("iterations_per_solve", static_cast<double>(s.iterations) / solves);
  json.set("worst_residual", s.worst_residual);
  if (solver_traits(options.name).preconditioned)
    json.set("preconditioner", options.preconditioner).set("fallbacks", s.fallbacks);
  if (s.clamped > 0) json.set("stiffnesses_left_out", s.clamped);
  return json;
}

// How the solves went, or what was done instead.
template <int D>
std::string method_text(const Simulation<D>& simulation) {
  if (const std::string summary = simulation.integrator().summary(); !summary.empty())
    return fmt::format("  {}\n", summary);
  if (simulation.integrator().solves() == 0) return "  friction is explicit: nothing was solved\n";
  const SolverOptions& options = simulation.settings().solver;
  const SolverStatistics& s = simulation.dynamics().statistics();
  const auto solves = static_cast<double>(std::max<std::int64_t>(s.solves, 1));
  std::string out = fmt::format(
      "  solver {} to {:g}: {:.1f} iterations per solve (most {}), worst true residual {:.2g}\n",
      options.name, options.tolerance, static_cast<double>(s.iterations) / solves,
      s.most_iterations, s.worst_residual);
  if (!s.problem.empty()) out += fmt::format("  problem solved: {}\n", s.problem);
  if (s.fallbacks > 0)
    out += fmt::format("  in {} solves multilevel gave up and block-Jacobi went on\n", s.fallbacks);
  if (s.clamped > 0)
    out += fmt::format("  {} negative stiffnesses were left out of the implicit repulsion\n",
                       s.clamped);
  return out;
}

std::vector<JsonObject> checks_json(const std::vector<CheckOutcome>& checks) {
  std::vector<JsonObject> list;
  for (const CheckOutcome& c : checks) {
    JsonObject json;
    json.set("name", c.check.name)
        .set("observable", c.check.observable)
        .set("expected", c.check.expected);
    json.set("measured", c.measured)
        .set("stderr", c.standard_error)
        .set("tolerance", c.check.tolerance);
    json.set("passed", c.passed).set("source", c.check.source);
    if (!c.passed) json.set("why", c.why);
    list.push_back(json);
  }
  return list;
}

// One line on the target of [run] until; empty where there is none.
template <int D>
std::string target_text(const Simulation<D>& simulation, const Results& results) {
  const auto& until = simulation.settings().until;
  if (!until) return {};
  const Scalar* scalar = results.find(until->observable);
  return fmt::format("  {}: a standard error of {:g} of {} (now {})\n",
                     simulation.stopped_at_target() ? "stopped early, the target is reached"
                                                    : "the target of run.until was not reached",
                     until->standard_error, until->observable,
                     scalar == nullptr ? "not measured"
                     : std::isnan(scalar->standard_error)
                         ? "no estimate yet"
                         : fmt::format("{:.3g}", scalar->standard_error));
}

}  // namespace

std::vector<CheckOutcome> evaluate_checks(const std::vector<CheckSettings>& checks,
                                          const Results& results, std::int64_t alarm_crossings) {
  std::vector<CheckOutcome> outcomes;
  for (const CheckSettings& check : checks) {
    const Scalar* scalar = results.find(check.observable);
    if (!scalar) {
      std::vector<std::string> names;
      for (const Scalar& s : results.scalars) names.push_back(s.name);
      outcomes.push_back({check, std::nan(""), std::nan(""), false,
                          fmt::format("nothing measured '{}'; this run gives {}", check.observable,
                                      fmt::join(names, ", "))});
      continue;
    }
    CheckOutcome o{check, scalar->mean, scalar->standard_error, false, {}};
    if (alarm_crossings > 0 && check.observable != "alarm_crossings") {
      o.why = fmt::format(
          "{} particle(s) were caught by the mirror behind a wall while this was measured",
          alarm_crossings);
    } else if (!(std::abs(o.measured - check.expected) <= check.tolerance)) {
      o.why = "outside the tolerance";
    } else if (check.standard_error_below > 0.0 &&
               !(o.standard_error <= check.standard_error_below)) {
      o.why =
          fmt::format("the standard error is not below {}: run longer", check.standard_error_below);
    }
    o.passed = o.why.empty();
    outcomes.push_back(std::move(o));
  }
  return outcomes;
}

std::string with_error(double value, double standard_error) {
  if (!std::isfinite(value)) return "undefined";
  if (std::isnan(standard_error)) return fmt::format("{:.6g} (no error estimate)", value);
  if (!(standard_error > 0.0)) return fmt::format("{:.6g}", value);
  // Two digits of the error, and the value to the same place.
  const int decimals =
      std::clamp(1 - static_cast<int>(std::floor(std::log10(standard_error))), 0, 12);
  return fmt::format("{:.{}f} +- {:.{}f}", value, decimals, standard_error, decimals);
}

const char* cause_name(SolverError::Cause cause) {
  switch (cause) {
    case SolverError::Cause::blow_up:
      return "blew up";
    case SolverError::Cause::not_converged:
      return "not converged";
    case SolverError::Cause::singular:
      return "singular";
    case SolverError::Cause::other:
      break;
  }
  return "failed";
}

template <int D>
std::string summary_json(const Simulation<D>& simulation, const Results& results,
                         const std::vector<CheckOutcome>& checks,
                         const std::optional<Failure>& failure) {
  const CaseSettings& settings = simulation.settings();
  const Clock& clock = simulation.clock();
  JsonObject observables;
  for (const Scalar& s : results.scalars)
    observables.set(s.name, JsonObject().set("mean", s.mean).set("stderr", s.standard_error));
  JsonObject json;
  json.set("case", settings.name).set("title", settings.title).set("version", ODPD_VERSION);
  json.set("dimension", D).set("seed", static_cast<std::int64_t>(settings.dynamics.seed));
  json.set("integrator", settings.integrator.name).set("dt", clock.dt);
  if (const std::string summary = simulation.integrator().summary(); !summary.empty())
    json.set("integrator_summary", summary);
  json.set("particles", simulation.scene().particles().size())
      .set("free_particles", free_particles(simulation));
  json.set("steps", clock.step)
      .set("equilibration_steps", clock.equilibration_steps)
      .set("time", clock.time());
  json.set("finished", clock.finished() && !failure)
      .set("interrupted", !clock.finished() && !failure)
      .set("stopped_at_target", simulation.stopped_at_target())
      .set("threads", threads());
  if (failure)
    json.set(failure->cause == SolverError::Cause::blow_up ? "blew_up" : "failed",
             JsonObject()
                 .set("step", clock.step)
                 .set("time", clock.time())
                 .set("cause", cause_name(failure->cause))
                 .set("reason", failure->reason));
  json.set("wall_seconds", simulation.wall_seconds());
  json.set("phase_seconds", phases_json(simulation.dynamics().phases()));
  json.set("solver", solver_json(simulation));
  json.set("fluid", fluid_json(simulation.scene(), results));
  if (const auto suspension = suspension_json(simulation.scene(), results))
    json.set("suspension", *suspension);
  json.set("observables", observables).set("checks", checks_json(checks));
  json.set("alarm_crossings", simulation.alarm_crossings());
  std::vector<JsonObject> notes;
  for (const std::string& note : results.notes) notes.push_back(JsonObject().set("note", note));
  json.set("notes", notes);
  return json.text() + "\n";
}

template <int D>
std::string population_text(const Particles<D>& particles) {
  const std::int64_t free = particles.free_count();
  std::int64_t known = 0;
  for (std::size_t i = 0; i < particles.position.size(); ++i) known += particles.is_known(i);
  const std::int64_t in_bodies = particles.size() - free - known;
  return fmt::format("{} free particles, {}{} of known velocity", free,
                     in_bodies > 0 ? fmt::format("{} in free bodies, ", in_bodies) : "", known);
}

template <int D>
std::string report_text(const Simulation<D>& simulation, const Results& results,
                        const std::vector<CheckOutcome>& checks) {
  const CaseSettings& settings = simulation.settings();
  const Clock& clock = simulation.clock();
  std::string out = fmt::format("\n{}\n", settings.title);
  out += fmt::format("  {}D, {}; {} at dt = {}, {} steps (t = {:.6g}){}\n", D,
                     population_text(simulation.scene().particles()), settings.integrator.name,
                     clock.dt, clock.step, clock.time(), clock.finished() ? "" : ", interrupted");
  out += method_text(simulation);
  out += target_text(simulation, results);
  out += "\n" + fluid_text(simulation.scene(), results);
  if (const std::string text = suspension_text(simulation.scene(), results); !text.empty())
    out += "\n" + text;
  out += "\nMeasured (standard error by block averaging)\n";
  for (const Scalar& scalar : results.scalars)
    out +=
        fmt::format("  {:<34} {}\n", scalar.name, with_error(scalar.mean, scalar.standard_error));
  for (const std::string& note : results.notes) out += fmt::format("  note: {}\n", note);
  if (!checks.empty()) out += "\nExpected\n";
  for (const CheckOutcome& c : checks)
    out += fmt::format("  {} {:<28} {:>12.6g}, expected {:.6g} within {:.3g}{}{}\n",
                       c.passed ? "ok    " : "FAILED", c.check.name, c.measured, c.check.expected,
                       c.check.tolerance, c.passed ? "" : ": " + c.why,
                       c.check.source.empty() ? "" : "  [" + c.check.source + "]");
  const PhaseSeconds& phases = simulation.dynamics().phases();
  const double total = std::max(phase_total(phases), 1e-12);
  out += "\nTime (s)\n ";
  for (std::size_t p = 0; p < phases.seconds.size(); ++p)
    out +=
        fmt::format(" {} {:.2f} ({:.0f} %){}", phase_name(static_cast<Phase>(p)), phases.seconds[p],
                    100.0 * phases.seconds[p] / total, p + 1 < phases.seconds.size() ? "," : "\n");
  out += fmt::format("  {:.2f} s of wall time in all, on {} thread(s)\n", simulation.wall_seconds(),
                     threads());
  return out;
}

template std::string summary_json<2>(const Simulation<2>&, const Results&,
                                     const std::vector<CheckOutcome>&,
                                     const std::optional<Failure>&);
template std::string summary_json<3>(const Simulation<3>&, const Results&,
                                     const std::vector<CheckOutcome>&,
                                     const std::optional<Failure>&);
template std::string report_text<2>(const Simulation<2>&, const Results&,
                                    const std::vector<CheckOutcome>&);
template std::string report_text<3>(const Simulation<3>&, const Results&,
                                    const std::vector<CheckOutcome>&);
template std::string population_text<2>(const Particles<2>&);
template std::string population_text<3>(const Particles<3>&);

}  // namespace odpd
