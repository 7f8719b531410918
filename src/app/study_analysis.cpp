#include "odpd/app/study_analysis.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <numeric>

#include "odpd/core/error.h"
#include "odpd/io/csv.h"

namespace odpd {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

struct TableColumn {
  std::vector<double> x;
  std::vector<Estimate> y;
};

// First column, second column and its error, the third, of a run's table.
TableColumn read_column(const std::filesystem::path& file, double below) {
  const TextTable table = read_csv(file);
  TableColumn column;
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    std::vector<double> numbers;
    for (std::size_t c = 0; c < 3 && c < table.columns.size(); ++c) {
      const std::string& text = table.rows[row][c];
      double value = nan;
      std::from_chars(text.data(), text.data() + text.size(), value);
      numbers.push_back(value);
    }
    if (numbers.size() < 3)
      throw IoError(fmt::format(
          "{}: needs three columns (x, value, its standard error) to be compared as .rms",
          file.string()));
    if (!(numbers[0] < below)) continue;
    column.x.push_back(numbers[0]);
    column.y.push_back({numbers[1], numbers[2]});
  }
  return column;
}

// What a point gave: a number, or a table's column, averaged over its seeds.
struct Measured {
  int seeds = 0;
  Estimate value{nan, nan};
  TableColumn column;
};

class Reader {
 public:
  Reader(const StudyPlan& plan, const std::vector<std::vector<RunOutcome>>& outcomes,
         const std::filesystem::path& directory)
      : plan_(plan), outcomes_(outcomes), directory_(directory) {}

  Measured read(std::size_t point, const StudyObservable& observable) const {
    Measured measured;
    std::vector<Estimate> values;
    std::vector<TableColumn> columns;
    for (std::size_t k = 0; k < plan_.points[point].runs.size(); ++k) {
      const RunOutcome& outcome = outcomes_[point][k];
      if (outcome.status != RunStatus::done && outcome.status != RunStatus::out_of_time) continue;
      if (!observable.table.empty()) {
        const auto file =
            directory_ / plan_.points[point].runs[k].name / "run" / (observable.table + ".csv");
        if (std::filesystem::exists(file)) columns.push_back(read_column(file, observable.below));
      } else if (const auto* number = outcome.find(observable.name);
                 number && std::isfinite(number->mean)) {
        values.push_back({number->mean, number->standard_error});
      }
    }
    measured.seeds = static_cast<int>(values.size() + columns.size());
    measured.value = averaged(values);
    if (columns.empty()) return measured;
    measured.column.x = columns.front().x;
    for (std::size_t row = 0; row < measured.column.x.size(); ++row) {
      std::vector<Estimate> runs;
      for (const TableColumn& column : columns) runs.push_back(column.y.at(row));
      measured.column.y.push_back(averaged(runs));
    }
    return measured;
  }

 private:
  const StudyPlan& plan_;
  const std::vector<std::vector<RunOutcome>>& outcomes_;
  const std::filesystem::path& directory_;
};

// The rms difference, and as its standard error the rms that noise alone would give; undefined where a row's is.
Estimate rms_difference(const TableColumn& a, const TableColumn& b) {
  const std::size_t rows = std::min(a.y.size(), b.y.size());
  double square = 0.0, noise = 0.0;
  for (std::size_t k = 0; k < rows; ++k) {
    const double d = a.y[k].mean - b.y[k].mean;
    square += d * d;
    for (const Estimate& e : {a.y[k], b.y[k]})
      if (e.mean != 0.0) noise += e.standard_error * e.standard_error;  // an empty bin has none
  }
  if (rows == 0) return {nan, nan};
  return {std::sqrt(square / static_cast<double>(rows)),
          std::sqrt(noise / static_cast<double>(rows))};
}

void compare(const Reader& reader, const StudyObservable& observable, std::size_t reference,
             Finding& f) {
  const Measured own = reader.read(f.point, observable);
  const bool fixed = observable.kind == ReferenceKind::number;
  const Measured other =
      fixed ? Measured{1, {observable.number, 0.0}, {}} : reader.read(reference, observable);
  f.seeds = own.seeds;
  f.is_reference = !fixed && reference == f.point;
  f.bias = f.sigma = nan;
  if (!observable.table.empty()) {
    const Estimate rms = rms_difference(own.column, other.column);
    f.value = rms;
    f.reference = {0.0, 0.0};
    f.bias = rms.mean;
    f.sigma = rms.standard_error;
    return;
  }
  f.value = own.value;
  f.reference = other.value;
  const double scale = f.reference.mean != 0.0 ? std::abs(f.reference.mean) : 1.0;
  f.bias = (f.value.mean - f.reference.mean) / scale;
  f.sigma = std::hypot(f.value.standard_error, f.reference.standard_error) / scale;
}

void read_runs(const std::vector<RunOutcome>& outcomes, Finding& f) {
  double seconds = 0.0, time = 0.0;
  f.blew_up_at = nan;
  bool missing = false;
  for (const RunOutcome& outcome : outcomes) {
    if (outcome.status == RunStatus::missing) missing = true;
    if (outcome.ended_with_error()) {
      // One seed that blew up tells more than another that failed.
      if (f.verdict != Verdict::blew_up) {
        f.verdict = outcome.status == RunStatus::blew_up ? Verdict::blew_up : Verdict::failed;
        f.failure = outcome.failure;
        f.message = outcome.message;
      }
      f.blew_up_at = std::fmin(f.blew_up_at, outcome.time);
      continue;
    }
    f.out_of_time = f.out_of_time || outcome.status == RunStatus::out_of_time;
    seconds += outcome.step_seconds;
    time += outcome.time;
    f.wall_seconds += outcome.wall_seconds;
  }
  f.cost = time > 0.0 ? seconds / time : nan;
  if (missing && f.message.empty()) f.message = "not run yet";
}

void mark_front(const StudySettings& study, const StudyPlan& plan, std::vector<Finding>& all,
                std::size_t first) {
  // Of each finding: those of the same chart before and after it.
  for (std::size_t k = first; k < all.size(); ++k) {
    std::vector<std::size_t> group;
    for (std::size_t j = first; j < all.size(); ++j)
      if (same_chart(study, plan.points[all[k].point], plan.points[all[j].point]) &&
          !all[j].is_reference && !all[j].ended_with_error() && std::isfinite(all[j].sigma))
        group.push_back(j);
    if (group.empty() || group.front() != k) continue;  // each group once
    std::vector<double> cost, error;
    for (const std::size_t j : group) {
      cost.push_back(all[j].cost);
      error.push_back(all[j].shown_error());
    }
    for (const std::size_t j : pareto_front(cost, error)) all[group[j]].on_front = true;
  }
}

}  // namespace

Estimate averaged(const std::vector<Estimate>& runs) {
  if (runs.empty()) return {nan, nan};
  const double n = static_cast<double>(runs.size());
  double sum = 0.0, squares = 0.0, scatter = 0.0;
  for (const Estimate& run : runs) {
    sum += run.mean;
    squares += run.standard_error * run.standard_error;
  }
  const double mean = sum / n, from_runs = std::sqrt(squares) / n;
  if (runs.size() < 3) return {mean, from_runs};
  for (const Estimate& run : runs) scatter += (run.mean - mean) * (run.mean - mean);
  // fmax passes over an undefined error of a run.
  return {mean, std::fmax(from_runs, std::sqrt(scatter / (n * (n - 1.0))))};
}

const char* verdict_name(Verdict verdict) {
  switch (verdict) {
    case Verdict::ok:
      return "ok";
    case Verdict::biased:
      return "biased";
    case Verdict::unclear:
      return "unclear";
    case Verdict::blew_up:
      return "blew up";
    case Verdict::failed:
      return "failed";
    case Verdict::missing:
      break;
  }
  return "missing";
}

Verdict classify(double bias, double sigma, double tolerance) {
  if (std::isnan(bias)) return Verdict::missing;
  if (std::isnan(sigma)) return Verdict::unclear;
  if (2.0 * sigma > tolerance && std::abs(bias) <= 2.0 * sigma) return Verdict::unclear;
  return std::abs(bias) <= tolerance ? Verdict::ok : Verdict::biased;
}

std::vector<std::size_t> pareto_front(const std::vector<double>& cost,
                                      const std::vector<double>& error) {
  std::vector<std::size_t> order;
  for (std::size_t k = 0; k < cost.size(); ++k)
    if (std::isfinite(cost[k]) && std::isfinite(error[k])) order.push_back(k);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return cost[a] != cost[b] ? cost[a] < cost[b] : error[a] < error[b];
  });
  std::vector<std::size_t> front;
  for (const std::size_t k : order)
    if (front.empty() || error[k] < error[front.back()]) front.push_back(k);
  return front;
}

double Finding::shown_error() const { return below_noise ? 2.0 * sigma : std::abs(bias); }

bool same_chart(const StudySettings& study, const StudyPoint& a, const StudyPoint& b) {
  for (std::size_t k = 0; k < study.axes.size(); ++k)
    if (k != study.method && k != study.sweep && a.at[k] != b.at[k]) return false;
  return true;
}

void tell_numbers_from_tables(StudySettings& study,
                              const std::vector<std::vector<RunOutcome>>& outcomes) {
  for (StudyObservable& observable : study.observables)
    for (const std::vector<RunOutcome>& runs : outcomes)
      for (const RunOutcome& outcome : runs)
        if (outcome.find(observable.name)) observable.table.clear();
}

std::vector<Finding> findings(const StudySettings& study, const StudyPlan& plan,
                              const std::vector<std::vector<RunOutcome>>& outcomes,
                              const std::filesystem::path& directory) {
  const Reader reader(plan, outcomes, directory);
  std::vector<Finding> all;
  for (std::size_t o = 0; o < study.observables.size(); ++o) {
    const std::size_t first = all.size();
    for (std::size_t p = 0; p < plan.points.size(); ++p) {
      if (plan.points[p].monte_carlo) continue;
      Finding f;
      f.point = p;
      f.observable = o;
      read_runs(outcomes[p], f);
      compare(reader, study.observables[o], plan.reference[p][o], f);
      f.below_noise = std::abs(f.bias) < 2.0 * f.sigma;
      if (!f.ended_with_error())
        f.verdict = classify(f.bias, f.sigma, study.observables[o].tolerance);
      all.push_back(std::move(f));
    }
    mark_front(study, plan, all, first);
  }
  return all;
}

}  // namespace odpd
