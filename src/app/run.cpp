#include "odpd/app/run.h"

#include <fmt/format.h>

#include <cstdio>
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

template <int D>
int conclude(const Simulation<D>& simulation, RunOutput<D>& output) {
  const bool interrupted_early = !simulation.clock().finished();
  const Results results = simulation.results();
  output.finish(results);
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

  const fs::path directory = output_directory(options, settings);
  std::optional<CheckpointReader> checkpoint;
  if (!options.restart.empty()) {
    checkpoint.emplace(options.restart);
    simulation.load(*checkpoint);
  }
  const bool continues =
      checkpoint && same_directory(directory, fs::absolute(options.restart).parent_path());
  if (!continues) prepare_run_directory(directory);
  RunOutput<D> output(directory, config, simulation);
  if (continues) {
    output.resume(*checkpoint);
  } else {
    output.begin();
  }

  try {
    LiveLine<D> line(simulation);
    simulation.run(interrupted, [&] {
      output.after_step();
      line.update();
    });
  } catch (const Error&) {
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
