// The CSV files of study_report.h.
#include <fmt/format.h>

#include <cmath>

#include "odpd/app/study_report.h"

namespace odpd {

namespace {

std::string number(double value) { return std::isnan(value) ? "nan" : fmt::format("{}", value); }

// A word in CSV: quoted where it needs it.
std::string field(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text)
    out += c == '"' ? std::string("\"\"") : std::string(1, c == '\n' ? ' ' : c);
  return out + "\"";
}

std::string axis_columns(const StudySettings& study) {
  std::string text;
  for (const StudyAxis& axis : study.axes) text += axis.name + ",";
  return text;
}

std::string axis_values(const StudySettings& study, const StudyPoint& point) {
  std::string text;
  for (std::size_t k = 0; k < study.axes.size(); ++k)
    text += field(study.axes[k].values[point.at[k]].label) + ",";
  return text;
}

std::string status_text(const RunOutcome& outcome) {
  if (outcome.ended_with_error()) return outcome.failure;
  if (outcome.status == RunStatus::missing) return "missing";
  return outcome.status == RunStatus::done ? "done" : "out of seconds";
}

}  // namespace

std::string findings_csv(const StudyResults& results) {
  const StudySettings& study = results.settings;
  std::string text =
      axis_columns(study) +
      "observable,verdict,seeds,mean,standard_error,reference,reference_standard_error,bias,"
      "bias_standard_error,below_noise,pareto,seconds_per_time,wall_seconds,out_of_seconds,blew_up_"
      "at,message\n";
  for (const Finding& f : results.findings)
    text += fmt::format(
        "{}{},{},{},{},{},{},{},{},{},{:d},{:d},{},{},{:d},{},{}\n",
        axis_values(study, results.plan.points[f.point]), study.observables[f.observable].name,
        f.verdict_text(), f.seeds, number(f.value.mean), number(f.value.standard_error),
        number(f.reference.mean), number(f.reference.standard_error), number(f.bias),
        number(f.sigma), f.below_noise, f.on_front, number(f.cost), number(f.wall_seconds),
        f.out_of_time, number(f.blew_up_at), field(f.message));
  return text;
}

std::string runs_csv(const StudyResults& results) {
  std::string text =
      "point,seed,status,time,step_seconds,wall_seconds,observable,mean,standard_error,directory,"
      "message\n";
  for (std::size_t p = 0; p < results.plan.points.size(); ++p)
    for (std::size_t r = 0; r < results.outcomes[p].size(); ++r) {
      const RunOutcome& outcome = results.outcomes[p][r];
      const std::string start = fmt::format(
          "{},{},{},{},{},{}", field(results.plan.points[p].label), r + 1, status_text(outcome),
          number(outcome.time), number(outcome.step_seconds), number(outcome.wall_seconds));
      const std::string end = fmt::format("{},{}\n", field(results.plan.points[p].runs[r].name),
                                          field(outcome.message));
      if (outcome.observables.empty()) text += start + ",,,," + end;
      for (const auto& o : outcome.observables)
        text += fmt::format("{},{},{},{},{}", start, o.name, number(o.mean),
                            number(o.standard_error), end);
    }
  return text;
}

}  // namespace odpd
