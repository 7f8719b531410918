#include "odpd/app/run.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <new>
#include <optional>

#include "odpd/app/blow_up.h"
#include "odpd/app/dry_run.h"
#include "odpd/app/interrupt.h"
#include "odpd/app/live_line.h"
#include "odpd/app/memory.h"
#include "odpd/app/report.h"
#include "odpd/app/restart.h"
#include "odpd/app/run_output.h"
#include "odpd/app/shell.h"
#include "odpd/app/simulation.h"
#include "odpd/core/error.h"
#include "odpd/core/log.h"
#include "odpd/core/parallel.h"

namespace odpd {

namespace {

namespace fs = std::filesystem;

fs::path output_directory(const RunOptions& options, const CaseSettings& settings) {
  if (!options.out.empty()) return options.out;
  if (!options.restart.empty()) return fs::absolute(options.restart).parent_path();
  return fs::path("runs") / settings.name;
}

bool same_directory(const fs::path& a, const fs::path& b) {
  std::error_code ignored;
  return fs::equivalent(a, b, ignored);
}

// The command that goes on from the last sound configuration with a smaller step.
template <int D>
std::string command_to_go_on(const RunOptions& options, const Simulation<D>& simulation,
                             const fs::path& directory) {
  const fs::path start = fs::absolute(directory / "last_good.h5").lexically_normal();
  std::string command = "odpd run " + shell_quoted(options.case_path.string());
  for (const std::string& set : options.overrides)
    if (!set.starts_with("integrator.dt=") && !set.starts_with("start."))
      command += " --set " + shell_quoted(set);
  command += fmt::format(" --set integrator.dt={} --set start.from=file --set {}",
                         simulation.smaller_step(),
                         shell_quoted(fmt::format("start.file=\"{}\"", start.string())));
  return command + " --out " + shell_quoted(directory.string() + "-smaller-step");
}

// The way out after a step that failed or a state that has blown up: what is left, and how to go on.
template <int D>
[[noreturn]] void give_up(const RunOptions& options, const Simulation<D>& simulation,
                          RunOutput<D>& output, const SolverError& error) {
  const bool blew_up = dynamic_cast<const BlowUpError*>(&error) != nullptr;
  output.salvage();
  output.leave_last_good();
  output.write_summary(
      summary_json(simulation, simulation.results(), {}, Failure{error.cause(), error.what()}));
  const bool bond = dynamic_cast<const BondTooLongError*>(&error) != nullptr;  // no step cures it
  if (!blew_up || bond || simulation.last_good().id.empty()) throw;
  throw BlowUpError(fmt::format(
      "{}. last_good.h5 holds the state at t = {:.6g}; go on from it with: {}", error.what(),
      simulation.last_good().time, command_to_go_on(options, simulation, output.directory())));
}

template <int D>
int conclude(const Simulation<D>& simulation, RunOutput<D>& output) {
  const bool interrupted_early = !simulation.clock().finished();
  output.close();
  const Results results = simulation.results();
  output.write_results(results);
  // An interrupted run has not measured what its checks ask for.
  const auto checks = interrupted_early ? std::vector<CheckOutcome>{}
                                        : evaluate_checks(simulation.settings().checks, results,
                                                          simulation.alarm_crossings());
  output.write_summary(summary_json(simulation, results, checks));
  fmt::print("{}  files in {}\n", report_text(simulation, results, checks),
             output.directory().string());
  std::fflush(stdout);
  if (interrupted_early) return 130;
  for (const CheckOutcome& c : checks)
    if (!c.passed) return 4;
  return 0;
}

template <int D>
void warn_of_step(const Simulation<D>& simulation) {
  const Scene<D>& scene = simulation.scene();
  const CaseSettings& settings = simulation.settings();
  const double dt = settings.clock.dt, mass = scene.settings().mass, kT = scene.largest_kT();
  // Explicit forces of pairs are accurate to one to two times their limit, those of densities up to theirs.
  const std::optional<double> limit = scene.explicit_step_limit();
  const auto reference = scene.model().reference_state(mass);
  const bool of_densities = limit && reference && reference->accurate_step <= *limit;
  const double most = limit ? (of_densities ? 1.0 : 2.0) * *limit : 0.0;
  if (repulsion_is_explicit(settings.integrator) && limit && dt > most)
    log_warning(
        fmt::format("integrator.dt = {} is beyond {:.3g}, {} of explicit repulsion: it is no "
                    "longer accurate there",
                    dt, most, of_densities ? "the limit" : "twice the limit"));
  const double path = scene.model().thermal_path();
  if (mass > 0.0 && integrator_traits(settings.integrator.name).in_time &&
      std::sqrt(kT / mass) * dt > path)
    log_warning(fmt::format(
        "integrator.dt = {}: a particle at its thermal speed sqrt(kT/m) moves by {:.3g} in a step, "
        "more than {:.3g}, and at a free surface nothing slows it. Give dt = {:.2g} or less, or a "
        "mass of {:.2g} or more",
        dt, std::sqrt(kT / mass) * dt, path, path * std::sqrt(mass / kT),
        kT * (dt / path) * (dt / path)));
}

template <int D>
int run_in(const RunOptions& options, const Config& config, const CaseSettings& settings,
           CheckpointReader* checkpoint) {
  Simulation<D> simulation(config, settings, {}, checkpoint);
  set_threads(options.threads, simulation.scene().particles().size());
  if (options.dry_run) {
    fmt::print("{}", dry_run_text(simulation));
    return 0;
  }
  if (const std::string warning = simulation.integrator().warning(); !warning.empty())
    log_warning(warning);
  warn_of_step(simulation);

  const fs::path directory = output_directory(options, settings);
  if (checkpoint) simulation.load(*checkpoint);
  const bool continues =
      checkpoint && same_directory(directory, fs::absolute(options.restart).parent_path());
  // Whatever may be refused is, before anything of a directory that exists is touched.
  simulation.judge();
  RunOutput<D> output(directory, config, simulation);
  if (continues && !RunLock::marks(directory)) output.check(*checkpoint);
  const RunLock lock = continues ? RunLock(directory) : prepare_run_directory(directory);
  if (continues) {
    output.resume(*checkpoint);
  } else {
    output.begin();
  }

  catch_signals();
  try {
    LiveLine<D> line(simulation);
    simulation.run(interrupted, [&] {
      output.after_step();
      line.update();
    });
  } catch (const SolverError& e) {
    give_up(options, simulation, output, e);
  } catch (...) {
    output.salvage();
    throw;
  }
  return conclude(simulation, output);
}

template <int D>
int run_or_tell_size(const RunOptions& options, const Config& config, const CaseSettings& settings,
                     CheckpointReader* restart) {
  try {
    return run_in<D>(options, config, settings, restart);
  } catch (const std::bad_alloc&) {
    // The particles fitted, or it would have been told before; what lies between them did not.
    throw Error(memory_text(memory_need(read_scene<D>(config, restart))), 2);
  }
}

}  // namespace

int run_case(const RunOptions& options) {
  const Config config = open_case(options.case_path, options.overrides);
  std::optional<CheckpointReader> checkpoint;
  if (!options.restart.empty()) {
    checkpoint.emplace(options.restart);
    take_file_texts(*checkpoint, config);
  }
  const CaseSettings settings = read_case(config, case_name(options.case_path));
  CheckpointReader* const from = checkpoint ? &*checkpoint : nullptr;
  return settings.dimension == 2 ? run_or_tell_size<2>(options, config, settings, from)
                                 : run_or_tell_size<3>(options, config, settings, from);
}

}  // namespace odpd
