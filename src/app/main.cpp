// The program: reads the command line, calls one command of the library, turns errors into one message and an exit code.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <system_error>
#include <vector>

#include "odpd/app/calibrate.h"
#include "odpd/app/calibrate_radius.h"
#include "odpd/app/compare.h"
#include "odpd/app/info.h"
#include "odpd/app/interrupt.h"
#include "odpd/app/run.h"
#include "odpd/app/study.h"
#include "odpd/core/error.h"
#include "odpd/core/log.h"
#include "odpd/version.h"

namespace {

constexpr const char* exit_codes =
    "Exit codes: 0 ok, 1 case or usage, 2 solver or physics, 3 files, 4 a check failed or an error "
    "was not reached, 130 "
    "interrupted.\n"
    "Start with: odpd run cases/01_couette      Every key of a case file: docs/case-file.md";

void add_case(CLI::App& command, std::filesystem::path& path, std::vector<std::string>& overrides,
              bool& quiet) {
  command.add_option("case", path, "directory that holds case.toml, or a .toml file")->required();
  // One value each time, so that a case may follow.
  command
      .add_option("--set", overrides,
                  "key=value overrides a key of the case, as in --set integrator.dt=0.01; values "
                  "are TOML, a bare word is "
                  "a string; may be repeated")
      ->allow_extra_args(false)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command.add_flag("--quiet", quiet, "as before the command");
}

// What is wrong with the command line, in one line.
std::string usage_error(const CLI::App& app, const std::string& reason) {
  if (!app.get_subcommands().empty())
    return reason + "; see odpd " + app.get_subcommands().front()->get_name() + " --help";
  const std::vector<std::string> words = app.remaining();
  const auto word =
      std::find_if(words.begin(), words.end(), [](const auto& w) { return w.rfind('-', 0) != 0; });
  if (word == words.end())
    return "a command is needed: run, compare, study, calibrate, info; see odpd --help";
  return "there is no command '" + *word +
         "', only run, compare, study, calibrate, info; see odpd --help";
}

CLI::App* add_run(CLI::App& app, odpd::RunOptions& run, bool& quiet) {
  CLI::App* run_command = app.add_subcommand("run", "run a case and check its results");
  add_case(*run_command, run.case_path, run.overrides, quiet);
  run_command->add_option(
      "--out", run.out,
      "output directory [runs/<case>]; an earlier run there is moved aside to <dir>.N");
  run_command
      ->add_option("--threads", run.threads,
                   "threads; 0 chooses by the number of particles; never changes results")
      ->check(CLI::Range(0, 4096))
      ->capture_default_str();
  CLI::Option* restart = run_command->add_option(
      "--restart", run.restart,
      "checkpoint.h5 to continue from: into its own directory (default) or, with --out, a new one");
  run_command
      ->add_flag("--dry-run", run.dry_run,
                 "print what would be modelled, its size and an estimate of the time")
      ->excludes(restart);
  return run_command;
}

CLI::App* add_compare(CLI::App& app, odpd::CompareOptions& compare, std::string& stopping,
                      bool& quiet) {
  CLI::App* compare_command = app.add_subcommand(
      "compare", "solve one frozen step of a case with every backend: iterations, error, seconds");
  add_case(*compare_command, compare.case_path, compare.overrides, quiet);
  compare_command
      ->add_option("--solvers", compare.solvers, "names, separated by commas [all of this build]")
      ->delimiter(',');
  compare_command
      ->add_option("--tolerance", compare.tolerances,
                   "tolerances, separated by commas [1e-2 to 1e-10]")
      ->delimiter(',')
      ->check(CLI::Range(1e-16, 1.0));
  compare_command
      ->add_option(
          "--stopping", stopping,
          "when the Picard schemes stop: residual, or increment (the overdamped paper's eq. 27)")
      ->check(CLI::IsMember({"residual", "increment"}))
      ->capture_default_str();
  compare_command
      ->add_option("--steps", compare.steps, "steps of the case before its configuration is frozen")
      ->check(CLI::Range(std::int64_t{0}, std::int64_t{1000000000}))
      ->capture_default_str();
  compare_command->add_option("--out", compare.out, "output directory [runs/<case>-compare]");
  compare_command->add_option("--threads", compare.threads, "threads")
      ->check(CLI::Range(0, 4096))
      ->capture_default_str();
  return compare_command;
}

CLI::App* add_study(CLI::App& app, odpd::StudyOptions& study, bool& quiet) {
  CLI::App* command = app.add_subcommand(
      "study", "run a case over axes of its keys: error against cost, and where methods break");
  command->add_option("study", study.study_path, "study.toml, or the directory that holds it")
      ->required();
  command->add_flag("--quick", study.quick, "the study's quick form: fewer and shorter points");
  command->add_flag("--dry-run", study.dry_run,
                    "list the points and an estimate of the time; no files");
  command->add_option(
      "--out", study.out,
      "output directory [runs/study-<name>]; what is finished there is not run again");
  command
      ->add_option("--threads", study.threads,
                   "threads of each run, one after another; 0 chooses by its size")
      ->check(CLI::Range(0, 4096))
      ->capture_default_str();
  command->add_flag("--quiet", quiet, "as before the command");
  return command;
}

struct CalibrateCommand {
  odpd::CalibrateOptions viscosity;
  CLI::Option* radius = nullptr;  // given: of a body, in place of a viscosity
  std::string body, find;
  double wanted = 0.0;
  std::vector<double> edges;

  int run() const {
    if (radius->count() == 0) return odpd::calibrate(viscosity);
    return odpd::calibrate_radius({.case_path = viscosity.case_path,
                                   .out = viscosity.out,
                                   .overrides = viscosity.overrides,
                                   .body = body,
                                   .find = find,
                                   .wanted = wanted,
                                   .edges = edges,
                                   .relative_error = viscosity.relative_error,
                                   .limit_seconds = viscosity.limit_seconds,
                                   .threads = viscosity.threads});
  }
};

CLI::App* add_calibrate(CLI::App& app, CalibrateCommand& options, bool& quiet) {
  CLI::App* command = app.add_subcommand(
      "calibrate",
      "measure viscosities of a case's fluid and find the friction that gives one; or the "
      "hydrodynamic radius of a body");
  odpd::CalibrateOptions& calibrate = options.viscosity;
  add_case(*command, calibrate.case_path, calibrate.overrides, quiet);
  const CLI::Validator positive = CLI::Range(1e-300, 1e300);
  CLI::Option* eta =
      command->add_option("--eta", calibrate.eta, "viscosity wanted [fluid.eta of the case]")
          ->check(positive);
  command
      ->add_option("--relative-error", calibrate.relative_error,
                   "standard error of the result, over it [0.02 of a viscosity, 0.01 of a radius]")
      ->check(CLI::Range(1e-4, 0.2));
  CLI::Option* rate = command
                          ->add_option("--shear-rate", calibrate.shear_rate,
                                       "of the measurements [9 kT/(gamma r_c^2), less with mass]")
                          ->check(positive);
  CLI::Option* particles =
      command
          ->add_option("--particles", calibrate.particles,
                       "in the measuring scene [a cube with an edge of 8 (2D), 6 (3D) cutoffs]")
          ->check(CLI::Range(std::int64_t{1}, std::int64_t{100000000}));
  CLI::Option* only = command
                          ->add_flag("--measure-only", calibrate.measure_only,
                                     "one measurement, at the friction of the case")
                          ->excludes(eta);
  options.radius =
      command
          ->add_option(
              "--radius", options.body,
              "after the case: measure how large the free [[body]], or the [[molecule]] of one "
              "particle, of this name is to a flow and to the fluid's particles [the only one]")
          ->expected(0, 1);
  for (CLI::Option* other : {eta, rate, particles, only}) options.radius->excludes(other);
  command
      ->add_option("--boxes", options.edges,
                   "with --radius: edges of its periodic boxes, separated by commas [three]")
      ->delimiter(',')
      ->check(positive)
      ->needs(options.radius);
  CLI::Option* wanted = command
                            ->add_option("--wanted", options.wanted,
                                         "with --find: the hydrodynamic radius it is to give")
                            ->check(positive);
  CLI::Option* find = command
                          ->add_option("--find", options.find,
                                       "with --radius: key of its [[pair]] with the fluid to be "
                                       "found, cutoff, core or gamma")
                          ->check(CLI::IsMember({"cutoff", "core", "gamma"}))
                          ->needs(options.radius)
                          ->needs(wanted);
  wanted->needs(find);
  command->add_option(
      "--out", calibrate.out,
      "output directory [runs/<case>-calibrate, -radius]; measurements of the same that are there "
      "count");
  command->add_option("--threads", calibrate.threads, "threads; never changes results")
      ->check(CLI::Range(0, 4096))
      ->capture_default_str();
  command
      ->add_option("--limit-seconds", calibrate.limit_seconds,
                   "end, with exit code 4, after so long; the same command goes on")
      ->check(positive);
  return command;
}

int command_line(int argc, char** argv) {
  CLI::App app{"odpd: creeping flow of dissipative-particle fluids"};
  app.set_version_flag("--version", "odpd " ODPD_VERSION);
  app.require_subcommand(1);
  app.footer(exit_codes);
  bool quiet = false;
  app.add_flag("--quiet", quiet, "only warnings and errors on stderr beside the live line");

  odpd::RunOptions run;
  const CLI::App* run_command = add_run(app, run, quiet);
  odpd::CompareOptions compare;
  std::string stopping = "residual";
  const CLI::App* compare_command = add_compare(app, compare, stopping, quiet);
  odpd::StudyOptions study;
  const CLI::App* study_command = add_study(app, study, quiet);
  CalibrateCommand calibrate;
  const CLI::App* calibrate_command = add_calibrate(app, calibrate, quiet);
  CLI::App* info_command =
      app.add_subcommand("info", "version, build options, backends and machine");

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() == 0) return app.exit(e);  // --help, --version
    throw odpd::ConfigError(usage_error(app, e.what()));
  }
  odpd::set_quiet(quiet);
  odpd::let_large_writes_fail();
  if (run_command->parsed()) return odpd::run_case(run);
  if (study_command->parsed()) return odpd::run_study(study);
  if (calibrate_command->parsed()) return calibrate.run();
  compare.increment_rule = stopping == "increment";
  if (compare_command->parsed()) return odpd::compare_solvers(compare);
  if (info_command->parsed()) std::fputs(odpd::info_text().c_str(), stdout);
  return 0;
}

// What was printed must have arrived, on a full disk too.
void require_printed() {
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return;
  throw odpd::IoError(
      "standard output cannot be written: free some space, or send it elsewhere; the files of a "
      "run are complete");
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const int code = command_line(argc, argv);
    require_printed();
    return code;
  } catch (const odpd::Error& e) {
    std::fprintf(stderr, "odpd: error: %s\n", e.what());
    return e.exit_code();
  } catch (const std::bad_alloc&) {
    std::fputs(
        "odpd: error: not enough memory for this case: odpd run --dry-run tells what it needs; "
        "fewer particles (fluid.density, fluid.count, box.size) need less\n",
        stderr);
    return 2;
  } catch (const std::system_error& e) {
    std::fprintf(stderr, "odpd: error: %s; check the files and directories involved\n", e.what());
    return 3;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "odpd: error: %s\n", e.what());
    return 2;
  }
}
