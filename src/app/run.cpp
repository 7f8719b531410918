#include "odpd/app/run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <limits>
#include <optional>

#include "odpd/app/dry_run.h"
#include "odpd/app/interrupt.h"
#include "odpd/app/live_line.h"
#include "odpd/app/report.h"
#include "odpd/app/run_output.h"
#include "odpd/app/simulation.h"
#include "odpd/core/error.h"
#include "odpd/core/log.h"
#include "odpd/core/parallel.h"
#include "odpd/io/file.h"

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

// Explicit conservative forces are accurate to dt of about 0.2 to 0.4 gamma/a.
template <int D>
double longest_sensible_step(const SceneSettings<D>& scene) {
  double limit = std::numeric_limits<double>::infinity();
  for (const DpdParameters& p : scene.pairs)
    if (p.a > 0.0) limit = std::min(limit, 0.4 * p.gamma / p.a);
  return limit;
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
  write_file_atomically(output.directory() / "summary.json",
                        summary_json(simulation, results, checks));
  fmt::print("{}  files in {}\n", report_text(simulation, results, checks),
             output.directory().string());
  std::fflush(stdout);
  if (interrupted_early) return 130;
  for (const CheckOutcome& c : checks)
    if (!c.passed) return 4;
  return 0;
}

template <int D>
int run_in(const RunOptions& options, const Config& config, const CaseSettings& settings) {
  Simulation<D> simulation(config, settings);
  set_threads(options.threads, simulation.scene().particles().size());
  if (options.dry_run) {
    fmt::print("{}", dry_run_text(simulation));
    return 0;
  }
  if (const std::string warning = simulation.integrator().warning(); !warning.empty())
    log_warning(warning);
  if (const double limit = longest_sensible_step(simulation.scene().settings());
      simulation.integrator().in_time() && settings.clock.dt > limit)
    log_warning(
        fmt::format("integrator.dt = {} is beyond 0.4 gamma/a = {:.3g}, where the explicit "
                    "repulsion is no longer "
                    "accurate",
                    settings.clock.dt, limit));

  const fs::path directory = output_directory(options, settings);
  std::optional<CheckpointReader> checkpoint;
  if (!options.restart.empty()) {
    checkpoint.emplace(options.restart);
    simulation.load(*checkpoint);
  }
  const bool continues =
      checkpoint && same_directory(directory, fs::absolute(options.restart).parent_path());
  const RunLock lock = continues ? RunLock(directory) : prepare_run_directory(directory);
  RunOutput<D> output(directory, config, simulation);
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
  } catch (...) {
    output.salvage();
    throw;
  }
  return conclude(simulation, output);
}

}  // namespace

int run_case(const RunOptions& options) {
  const Config config = open_case(options.case_path, options.overrides);
  const CaseSettings settings = read_case(config, case_name(options.case_path));
  return settings.dimension == 2 ? run_in<2>(options, config, settings)
                                 : run_in<3>(options, config, settings);
}

}  // namespace odpd
