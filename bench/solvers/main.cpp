// Solver benchmark: odpd's pcg against other solvers on the same configurations, in one process (docs/performance.md).
//   scripts/bench [--quick] [--robustness | --ageing | --suspension] [--out DIR]
#include <omp.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>

#include "benchmark.h"
#include "odpd/core/error.h"
#include "odpd/core/log.h"
#include "odpd/io/file.h"

namespace bench {

void say(const std::string& line) {
  std::puts(line.c_str());
  std::fflush(stdout);
}

std::vector<Backend> Options::chosen() const {
  if (backends.empty()) return bench::backends();
  std::vector<Backend> some;
  for (const std::string& name : backends) {
    const auto& all = bench::backends();
    const auto found =
        std::find_if(all.begin(), all.end(), [&](const Backend& b) { return b.name == name; });
    if (found == all.end()) {
      std::string names;
      for (const Backend& b : all) names += (names.empty() ? "" : ", ") + b.name;
      throw odpd::ConfigError("--backends: no backend '" + name + "'; there are " + names);
    }
    some.push_back(*found);
  }
  return some;
}

namespace {

struct CommandLine {
  Options options;
  bool robustness = false;
  bool ageing = false;
  bool suspension = false;
};

void declare(CLI::App& app, CommandLine& line) {
  Options& o = line.options;
  CLI::Option* robustness =
      app.add_flag("--robustness", line.robustness,
                   "iterations in scenes where solvers may fail: robustness.csv, .md");
  CLI::Option* ageing = app.add_flag("--ageing", line.ageing,
                                     "iterations over 50 steps with one solver: ageing.csv, .md")
                            ->excludes(robustness);
  app.add_flag("--suspension", line.suspension,
               "rigid bodies against a fluid of as many particles: suspension*.csv, .md, charts")
      ->excludes(robustness)
      ->excludes(ageing);
  app.add_option("--scenes", o.scenes, "of --robustness: those with this in their names [all]")
      ->needs(robustness);
  app.add_flag("--quick", o.quick,
               "sizes 540 and 10000 only (--robustness, --ageing: 540; --suspension: 10000)");
  app.add_flag("--fresh", o.fresh, "forget the rows that --out holds of this part");
  app.add_option("--out", o.out, "output directory; rows that are there are not measured again")
      ->take_last()
      ->capture_default_str();
  app.add_option("--sizes", o.sizes,
                 "numbers of fluid particles, separated by commas [540,10000,100000,1000000; "
                 "--robustness, --ageing: 10000; --suspension: 10000,100000,1000000]")
      ->delimiter(',')
      ->check(CLI::Range(std::int64_t{100}, std::int64_t{100000000}));
  app.add_option("--tolerance", o.tolerances,
                 "separated by commas [1e-3,1e-5,1e-7; --suspension: 1e-7]")
      ->delimiter(',')
      ->check(CLI::Range(1e-12, 0.1));
  app.add_option("--backends", o.backends,
                 "of the comparison, separated by commas [all]; with --fresh only their solves "
                 "are made again")
      ->delimiter(',');
  app.add_option("--threads", o.threads, "of the solvers compared")
      ->check(CLI::Range(1, 4096))
      ->capture_default_str();
  app.add_option(
         "--step-threads", o.step_threads,
         "of triad, product and whole steps, separated by commas [1,2, or 1 on one processor]")
      ->delimiter(',')
      ->check(CLI::Range(1, 4096))
      ->capture_default_str();
  app.add_option("--limit-seconds", o.limit_seconds,
                 "solves predicted to take longer are skipped [300; --suspension: 15]")
      ->check(CLI::PositiveNumber);
  app.add_option("--limit-gigabytes", o.limit_gigabytes,
                 "backends predicted to need more memory are skipped")
      ->capture_default_str();
}

void choose_defaults(CommandLine& line) {
  Options& o = line.options;
  const bool scenes = line.robustness || line.ageing;
  if (o.sizes.empty()) {
    if (scenes)
      o.sizes = {o.quick ? 540 : 10000};
    else if (line.suspension)
      o.sizes = o.quick ? std::vector<std::int64_t>{10000}
                        : std::vector<std::int64_t>{10000, 100000, 1000000};
    else if (o.quick)
      o.sizes = {540, 10000};
    else
      o.sizes = {540, 10000, 100000, 1000000};
  }
  if (o.step_threads.empty()) {
    o.step_threads = {1};
    if (omp_get_num_procs() > 1) o.step_threads.push_back(2);
  }
  if (o.tolerances.empty() && line.suspension) o.tolerances = {1e-7};
  if (o.tolerances.empty()) o.tolerances = {1e-3, 1e-5, 1e-7};
  if (o.limit_seconds == 0.0) o.limit_seconds = line.suspension ? 15.0 : 300.0;
  std::sort(o.sizes.begin(), o.sizes.end());  // small sizes predict the large ones
  std::sort(o.tolerances.rbegin(), o.tolerances.rend());
}

/// Files of the part that --fresh makes anew. The solves of some backends go row by row (run_comparison).
void forget(const CommandLine& line) {
  std::vector<const char*> files{"products.csv", "steps.csv", "triad.csv"};
  if (line.options.backends.empty()) files.push_back("results.csv");
  if (line.robustness) files = {"robustness.csv"};
  if (line.ageing) files = {"ageing.csv"};
  if (line.suspension)
    files = {"suspension.csv", "suspension_steps.csv", "suspension_backends.csv",
             "suspension_robustness.csv"};
  for (const char* file : files) std::filesystem::remove(line.options.out / file);
}

int run(int argc, char** argv) {
  CLI::App app{"odpd solver benchmark"};
  CommandLine line;
  declare(app, line);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app.exit(e);
    throw odpd::ConfigError(std::string(e.what()) + "; see scripts/bench --help");
  }
  choose_defaults(line);
  odpd::set_quiet(true);
  odpd::make_directory(line.options.out);
  if (line.options.fresh) forget(line);
  if (line.robustness)
    run_robustness(line.options);
  else if (line.ageing)
    run_ageing(line.options);
  else if (line.suspension)
    run_suspension(line.options);
  else
    run_comparison(line.options);
  say("results: " + line.options.out.string());
  return 0;
}

}  // namespace

}  // namespace bench

int main(int argc, char** argv) {
  try {
    return bench::run(argc, argv);
  } catch (const odpd::Error& e) {
    std::fprintf(stderr, "bench: error: %s\n", e.what());
    return e.exit_code();
  } catch (const std::exception& e) {
    std::fprintf(stderr, "bench: error: %s\n", e.what());
    return 2;
  }
}
