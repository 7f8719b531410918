// Pictures of study_report.h.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "odpd/app/study_report.h"

namespace odpd {

namespace {

// In axis labels _ makes indices.
std::string plain(std::string text) {
  std::replace(text.begin(), text.end(), '_', ' ');
  return text;
}

bool is_relative(const StudyObservable& observable) {
  return observable.table.empty() &&
         !(observable.kind == ReferenceKind::number && observable.number == 0.0);
}

// " (a=25, n=4)" of the axes that the picture does not show; empty when it shows all.
std::string rest(const StudySettings& study, const StudyPoint& point,
                 const std::vector<std::size_t>& shown) {
  std::string text;
  for (std::size_t k = 0; k < study.axes.size(); ++k) {
    if (std::find(shown.begin(), shown.end(), k) != shown.end()) continue;
    text += fmt::format("{}{}={}", text.empty() ? "" : ", ", study.axes[k].name,
                        study.axes[k].values[point.at[k]].label);
  }
  return text;
}

std::string stem_of(const std::string& kind, const StudyObservable& observable,
                    const std::string& rest) {
  std::string stem = kind + "_" + observable.name + (rest.empty() ? "" : "_" + rest);
  for (char& c : stem)
    if (!is_plain_name(std::string(1, c)) && c != '=') c = '-';
  return stem;
}

std::string label_at(const StudySettings& study, const StudyPoint& point, std::size_t axis) {
  return axis < study.axes.size() ? study.axes[axis].values[point.at[axis]].label : "";
}

using Findings = std::vector<const Finding*>;

// The curve of one method, and how many of its points ended with an error.
Curve method_curve(const StudyResults& results, const Findings& all, std::size_t method) {
  const StudySettings& study = results.settings;
  Curve curve{.title = "points", .x = {}, .y = {}, .error = {}, .line = true};
  if (study.method < study.axes.size()) curve.title = study.axes[study.method].values[method].label;
  int blew_up = 0, failed = 0;
  for (const Finding* f : all) {
    const StudyPoint& point = results.plan.points[f->point];
    if (study.method < study.axes.size() && point.at[study.method] != method) continue;
    blew_up += f->verdict == Verdict::blew_up ? 1 : 0;
    failed += f->verdict == Verdict::failed ? 1 : 0;
    if (f->is_reference || f->ended_with_error() || !std::isfinite(f->bias)) continue;
    curve.x.push_back(f->cost);
    curve.y.push_back(f->shown_error());
    curve.error.push_back(f->below_noise ? 2.0 * f->sigma - std::abs(f->bias) : f->sigma);
    curve.limit.push_back(f->below_noise);
  }
  if (blew_up > 0) curve.title += fmt::format(" ({} blew up)", blew_up);
  if (failed > 0) curve.title += fmt::format(" ({} failed)", failed);
  return curve;
}

Curve front_curve(const StudyResults& results, Findings all) {
  Curve curve{
      .title = "Pareto front", .x = {}, .y = {}, .error = {}, .line = true, .points = false};
  curve.backdrop = true;
  std::erase_if(all, [](const Finding* f) { return !f->on_front; });
  std::sort(all.begin(), all.end(),
            [](const Finding* a, const Finding* b) { return a->cost < b->cost; });
  for (const Finding* f : all) {
    curve.x.push_back(f->cost);
    curve.y.push_back(f->shown_error());
    curve.label.push_back(
        label_at(results.settings, results.plan.points[f->point], results.settings.sweep));
  }
  return curve;
}

StudyPicture accuracy_chart(const StudyResults& results, const StudyObservable& observable,
                            const Findings& all) {
  const StudySettings& study = results.settings;
  const std::string others =
      rest(study, results.plan.points[all.front()->point], {study.method, study.sweep});
  StudyPicture picture;
  picture.stem = stem_of("accuracy", observable, others);
  picture.heading = fmt::format("Speed and accuracy: {}{}", observable.name,
                                others.empty() ? "" : " at " + others);
  Chart& chart = picture.chart;
  chart.title = study.title + (others.empty() ? "" : ": " + others);
  chart.x_label = fmt::format("seconds per unit of simulated time ({} thread{})", results.threads,
                              results.threads == 1 ? "" : "s");
  chart.y_label =
      (is_relative(observable) ? "relative error of " : "error of ") + plain(observable.name);
  chart.log_x = chart.log_y = true;
  chart.curves.push_back(front_curve(results, all));
  if (study.sweep < study.axes.size())
    chart.curves.front().title += fmt::format(" (with {})", study.axes[study.sweep].name);
  const std::size_t methods =
      study.method < study.axes.size() ? study.axes[study.method].values.size() : 1;
  for (std::size_t m = 0; m < methods; ++m) {
    chart.curves.push_back(method_curve(results, all, m));
    if (const Curve& last = chart.curves.back();
        last.x.empty() && !last.title.ends_with("blew up)") && !last.title.ends_with("failed)"))
      chart.curves.pop_back();
  }
  return picture;
}

// "+0.12 %": with two digits of the tolerance.
std::string cell_text(const Finding& f, double tolerance, bool relative) {
  const double scale = relative ? 100.0 : 1.0;
  const char* unit = relative ? " %" : "";
  const int decimals =
      std::clamp(1 - static_cast<int>(std::floor(std::log10(tolerance * scale))), 0, 6);
  const auto number = [&](double value, const char* sign) {
    const int shown = std::abs(value) >= 99.5   ? 0
                      : std::abs(value) >= 9.95 ? std::min(decimals, 1)
                                                : decimals;
    return fmt::format("{}{:.{}f}{}", sign, std::abs(value), shown, unit);
  };
  if (f.verdict == Verdict::missing) return "";
  if (f.verdict == Verdict::failed) return f.failure;
  if (f.verdict == Verdict::blew_up)
    return std::isfinite(f.blew_up_at) ? fmt::format("t = {:.2g}", f.blew_up_at) : "failed";
  if (f.is_reference) return "reference";
  if (std::isnan(f.sigma)) return number(f.bias * scale, f.bias < 0.0 ? "-" : "+") + "?";
  if (f.verdict == Verdict::unclear) return number(2.0 * f.sigma * scale, "< ");
  return number(f.bias * scale, f.bias < 0.0 ? "-" : "+");
}

StudyPicture stability_map(const StudyResults& results, const StudyObservable& observable,
                           const Findings& all) {
  const StudySettings& study = results.settings;
  const std::size_t none = study.axes.size();
  const bool panels = study.across != none;  // one per method; else the methods are the rows
  const std::size_t across = panels ? study.across : study.method;
  const StudyPoint& first = results.plan.points[all.front()->point];
  const std::string others = rest(study, first, {study.method, study.sweep, study.across});
  StudyPicture picture;
  picture.is_map = true;
  picture.stem = stem_of("stability", observable, others);
  picture.heading =
      fmt::format("Where it holds: {}{}", observable.name, others.empty() ? "" : " at " + others);
  CellMap& map = picture.map;
  const bool relative = is_relative(observable);
  map.title = fmt::format("{}: {} {}{}", study.title, relative ? "bias of" : "error of",
                          observable.name, others.empty() ? "" : ", " + others);
  map.kinds = {{fmt::format("ok: within {:.2g}{}", observable.tolerance * (relative ? 100.0 : 1.0),
                            relative ? " %" : ""),
                "#a8d8b9"},
               {"biased", "#fdc27a"},
               {"unclear: noise (?: unknown)", "#dddddd"},
               {"blew up, at time t, or failed", "#e57368"}};
  const auto ticks = [&](std::size_t axis, std::string& label, std::vector<std::string>& list) {
    if (axis == none) return list.emplace_back("");
    label = study.axes[axis].name;
    for (const AxisValue& value : study.axes[axis].values) list.push_back(value.label);
    return std::string();
  };
  ticks(study.sweep, map.x_label, map.x_ticks);
  ticks(across, map.y_label, map.y_ticks);
  if (!panels) std::reverse(map.y_ticks.begin(), map.y_ticks.end());  // methods read from above
  const std::size_t count =
      panels && study.method != none ? study.axes[study.method].values.size() : 1;
  const CellMap::Cell blank{map.kinds.size(), ""};
  for (std::size_t k = 0; k < count; ++k) {
    map.panels.push_back(
        {panels && study.method != none ? study.axes[study.method].values[k].label : "", {}});
    map.panels.back().rows.assign(map.y_ticks.size(),
                                  std::vector<CellMap::Cell>(map.x_ticks.size(), blank));
  }
  for (const Finding* f : all) {
    const StudyPoint& point = results.plan.points[f->point];
    const auto coordinate = [&](std::size_t axis) { return axis == none ? 0 : point.at[axis]; };
    const std::size_t row =
        panels ? coordinate(across) : map.y_ticks.size() - 1 - coordinate(across);
    const Verdict shown = f->is_reference && !f->ended_with_error() ? Verdict::ok : f->verdict;
    map.panels[panels ? coordinate(study.method) : 0].rows[row][coordinate(study.sweep)] = {
        shown == Verdict::missing   ? map.kinds.size()
        : shown == Verdict::ok      ? 0
        : shown == Verdict::biased  ? 1
        : shown == Verdict::unclear ? 2
                                    : 3,
        cell_text(*f, observable.tolerance, relative)};
  }
  return picture;
}

}  // namespace

std::vector<StudyPicture> study_pictures(const StudyResults& results) {
  const StudySettings& study = results.settings;
  std::vector<StudyPicture> charts, maps;
  for (std::size_t o = 0; o < study.observables.size(); ++o) {
    std::map<std::string, Findings> by_chart, by_map;
    for (const Finding& f : results.findings) {
      if (f.observable != o) continue;
      const StudyPoint& point = results.plan.points[f.point];
      by_chart[rest(study, point, {study.method, study.sweep})].push_back(&f);
      by_map[rest(study, point, {study.method, study.sweep, study.across})].push_back(&f);
    }
    for (const auto& [key, all] : by_chart)
      charts.push_back(accuracy_chart(results, study.observables[o], all));
    for (const auto& [key, all] : by_map)
      maps.push_back(stability_map(results, study.observables[o], all));
  }
  charts.insert(charts.end(), maps.begin(), maps.end());
  return charts;
}

}  // namespace odpd
