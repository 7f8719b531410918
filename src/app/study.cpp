#include "odpd/app/study.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <map>

#include "odpd/app/interrupt.h"
#include "odpd/app/report.h"
#include "odpd/app/shell.h"
#include "odpd/app/study_report.h"
#include "odpd/core/error.h"
#include "odpd/core/index.h"
#include "odpd/io/file.h"
#include "odpd/io/gnuplot.h"
#include "odpd/io/run_lock.h"

namespace odpd {

namespace {

namespace fs = std::filesystem;

// key="word" as key=word, where that means the same.
std::string bare(const std::string& assignment) {
  const std::size_t quote = assignment.find("=\"");
  if (quote == std::string::npos || assignment.back() != '"') return assignment;
  const std::string word = assignment.substr(quote + 2, assignment.size() - quote - 3);
  const bool is_word = is_plain_name(word) && word != "true" && word != "false" &&
                       !std::isdigit(static_cast<unsigned char>(word.front())) &&
                       word.front() != '-' && word != "inf" && word != "nan";
  return is_word ? assignment.substr(0, quote + 1) + word : assignment;
}

std::string duration_text(double seconds) {
  if (seconds < 90.0) return fmt::format("{:.0f} s", seconds);
  if (seconds < 5400.0) return fmt::format("{:.0f} min", seconds / 60.0);
  return fmt::format("{:.1f} h", seconds / 3600.0);
}

// Seconds a run still takes, by the speed of its method so far, else of all runs so far.
class Forecast {
 public:
  void add(const StudyPoint& point, const StudyRun& run, const RunOutcome& outcome,
           const StudySettings& study) {
    if (outcome.ended_with_error() || !(outcome.time > 0.0)) return;
    const double steps = outcome.time / run.dt;
    for (const std::string& key : {std::string(), method_of(point, study)}) {
      speed_[key].first += outcome.wall_seconds;
      speed_[key].second += steps;
    }
  }
  double seconds(const StudyPoint& point, const StudyRun& run, const StudySettings& study) const {
    auto found = speed_.find(method_of(point, study));
    if (found == speed_.end()) found = speed_.find("");
    if (found == speed_.end()) return 0.0;
    const double all = found->second.first / found->second.second * static_cast<double>(run.steps);
    return study.budget.seconds > 0.0 ? std::min(all, study.budget.seconds) : all;
  }

 private:
  static std::string method_of(const StudyPoint& point, const StudySettings& study) {
    if (point.monte_carlo) return "monte-carlo";
    return study.method < study.axes.size() ? fmt::format("method {}", point.at[study.method])
                                            : "points";
  }
  std::map<std::string, std::pair<double, double>> speed_;  // seconds and steps
};

std::string outcome_text(const RunOutcome& outcome, const StudySettings& study) {
  if (outcome.ended_with_error()) {
    std::string failure = outcome.failure;
    for (char& c : failure) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    return failure + ": " + outcome.message;
  }
  if (outcome.status == RunStatus::missing) return "interrupted";
  std::string text;
  for (const StudyObservable& o : study.observables)
    if (const auto* number = outcome.find(o.name))
      text += fmt::format("{} {}, ", o.name, with_error(number->mean, number->standard_error));
  text += fmt::format("{:.3g} s/time, {:.1f} s", outcome.step_seconds / outcome.time,
                      outcome.wall_seconds);
  return text + (outcome.status == RunStatus::out_of_time ? " (out of seconds)" : "");
}

// A table that no run gives should not come out at the end of a long study.
void require_tables(const StudySettings& study, const StudyPlan& plan, std::size_t point,
                    const StudyRun& run, const RunOutcome& outcome, const fs::path& directory) {
  if (outcome.status != RunStatus::done) return;
  const StudyPoint& where = plan.points[point];
  for (const StudyObservable& o : study.observables) {
    if (o.table.empty() || (where.monte_carlo && o.kind != ReferenceKind::monte_carlo)) continue;
    if (outcome.find(o.name) != nullptr ||
        fs::exists(directory / run.name / "run" / (o.table + ".csv")))
      continue;
    throw ConfigError(fmt::format(
        "{}: the point {} gives no table {}.csv for '{}': name one that it gives, or add an "
        "[[observe]] to the case",
        study.file.string(), where.label, o.table, o.name));
  }
}

// The directory of a study, new or to be continued.
RunLock open_directory(const fs::path& directory) {
  std::error_code ignored;
  const bool vacant = !fs::exists(directory, ignored) ||
                      (fs::is_directory(directory, ignored) && fs::is_empty(directory, ignored));
  if (!vacant && !fs::exists(directory / "points", ignored))
    throw IoError(fmt::format("{}: is there already and holds no study; choose another --out",
                              directory.string()));
  make_directory(directory / "points");
  return RunLock(directory);
}

int list_points(const StudySettings& study, const StudyPlan& plan) {
  double total = 0.0;
  for (const StudyPoint& point : plan.points) {
    double seconds = 0.0;
    for (const StudyRun& run : point.runs) {
      const double all = run.step_seconds * static_cast<double>(run.steps);
      seconds += study.budget.seconds > 0.0 ? std::min(all, study.budget.seconds) : all;
    }
    total += seconds;
    fmt::print("  {:<60} {} x {:>9} steps, about {}\n", point.label, point.runs.size(),
               point.runs.front().steps, duration_text(seconds));
  }
  fmt::print(
      "{} points, about {} on one thread at the speed of the first steps; blow-ups cost less\n",
      plan.points.size(), duration_text(total));
  return 0;
}

// Runs what is missing; false when the user interrupted.
bool run_points(const StudyExecution& execution, StudyResults& results) {
  const StudySettings& study = results.settings;
  struct Due {
    std::size_t point, run;
  };
  std::vector<Due> due;
  Forecast forecast;
  results.outcomes.resize(results.plan.points.size());
  std::size_t total = 0;
  // Seeds outermost: an interrupted study has something of every point.
  for (std::size_t r = 0; r < index(study.seeds); ++r)
    for (std::size_t p = 0; p < results.plan.points.size(); ++p) {
      const StudyPoint& point = results.plan.points[p];
      results.outcomes[p].resize(point.runs.size());
      if (r >= point.runs.size()) continue;
      ++total;
      results.outcomes[p][r] = earlier_outcome(execution, point.runs[r]);
      if (results.outcomes[p][r].status == RunStatus::missing) {
        due.push_back({p, r});
      } else {
        forecast.add(point, point.runs[r], results.outcomes[p][r], study);
      }
    }
  if (due.size() < total) fmt::print("{} of {} runs are done already\n", total - due.size(), total);
  for (std::size_t k = 0; k < due.size(); ++k) {
    const StudyPoint& point = results.plan.points[due[k].point];
    const StudyRun& run = point.runs[due[k].run];
    RunOutcome& outcome = results.outcomes[due[k].point][due[k].run];
    outcome = execute(execution, run);
    fmt::print("[{:>3}/{}] {}, seed {}: {}", total - due.size() + k + 1, total, point.label,
               due[k].run + 1, outcome_text(outcome, study));
    forecast.add(point, run, outcome, study);
    double rest = 0.0;
    for (std::size_t j = k + 1; j < due.size(); ++j) {
      const StudyPoint& next = results.plan.points[due[j].point];
      rest += forecast.seconds(next, next.runs[due[j].run], study);
    }
    fmt::print("; {} to go\n", duration_text(rest));
    std::fflush(stdout);
    if (outcome.status == RunStatus::missing || interrupted()) return false;
    require_tables(study, results.plan, due[k].point, run, outcome, execution.directory);
  }
  return true;
}

void write_files(const fs::path& out, const StudyResults& results) {
  write_file_atomically(out / "study.csv", findings_csv(results));
  write_file_atomically(out / "runs.csv", runs_csv(results));
  const std::vector<StudyPicture> pictures = study_pictures(results);
  std::vector<std::string> svg;
  for (const StudyPicture& picture : pictures) {
    const bool drawn = picture.is_map ? draw_map(out / picture.stem, picture.map)
                                      : draw_chart(out / picture.stem, picture.chart);
    svg.push_back(drawn ? read_file(out / (picture.stem + ".svg")) : "");
  }
  write_file_atomically(out / "study.html", study_page(results, pictures, svg));
}

}  // namespace

std::string run_command(const StudySettings& study, const StudyRun& run) {
  std::string command = "odpd run " + shell_quoted(study.case_path.string());
  for (const std::string& o : run.overrides) command += " --set " + shell_quoted(bare(o));
  return command;
}

int run_study(const StudyOptions& options) {
  StudyResults results;
  results.settings = read_study(options.study_path, options.quick);
  const StudySettings& study = results.settings;
  results.plan = plan_study(study, options.dry_run);
  if (options.dry_run) return list_points(study, results.plan);
  results.threads = options.threads;
  results.command =
      "odpd study " + shell_quoted(options.study_path.string()) + (options.quick ? " --quick" : "");
  const fs::path out =
      !options.out.empty()
          ? options.out
          : fs::path("runs") / ("study-" + study.name + (options.quick ? "-quick" : ""));
  const RunLock lock = open_directory(out);
  catch_signals();
  const StudyExecution execution{
      .directory = out / "points", .threads = options.threads, .seconds = study.budget.seconds};
  const bool whole = run_points(execution, results);
  tell_numbers_from_tables(results.settings, results.outcomes);
  results.findings = findings(study, results.plan, results.outcomes, execution.directory);
  write_files(out, results);
  fmt::print("{}{}: page {}, table {}\n", study.title,
             whole ? "" : ", interrupted (the same command continues)",
             (out / "study.html").string(), (out / "study.csv").string());
  std::fflush(stdout);
  return whole ? 0 : 130;
}

}  // namespace odpd
