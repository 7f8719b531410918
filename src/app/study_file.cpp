#include "odpd/app/study_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <optional>

#include "odpd/core/error.h"
#include "odpd/core/index.h"

namespace odpd {

namespace {

namespace fs = std::filesystem;

// TOML text as a word: a string without its quotes.
std::string word(const std::string& text) {
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"')
    return text.substr(1, text.size() - 2);
  return text;
}

std::optional<double> as_number(const std::string& text) {
  double value = 0.0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

// Keys may be written dotted, or quoted: "integrator.dt".
void unquote_keys(ConfigValues& values) {
  for (auto& [key, text] : values) std::erase(key, '"');
}

ConfigValues keys_of(const Config& config, const std::string& table) {
  ConfigValues values = config.values(table);
  unquote_keys(values);
  return values;
}

void append(ConfigValues& values, const ConfigValues& more) {
  values.insert(values.end(), more.begin(), more.end());
}

AxisValue read_value(const Config& entry, const std::string& key, ConfigValues element) {
  AxisValue value;
  if (element.size() == 1 && element.front().first.empty()) {
    if (key.empty())
      entry.fail("values",
                 "without `key` each value is a table: { label = \"...\", integrator.dt = 0.01 }");
    value.label = word(element.front().second);
    value.set = {{key, element.front().second}};
    return value;
  }
  unquote_keys(element);
  for (const auto& [path, text] : element) {
    if (path == "label")
      value.label = word(text);
    else
      value.set.emplace_back(path, text);
  }
  if (value.label.empty())
    entry.fail("values", "each table needs a label, as in { label = \"SETD\", ... }");
  return value;
}

// The values called by `labels`; what is missing is named.
std::vector<std::size_t> chosen(const Config& place, const std::string& key, const StudyAxis& axis,
                                const std::vector<ConfigValues>& labels) {
  std::vector<std::size_t> values;
  for (const ConfigValues& label : labels) {
    const std::string name = label.size() == 1 ? word(label.front().second) : "a table";
    values.push_back(axis.find(name));
    if (values.back() < axis.values.size()) continue;
    std::vector<std::string> names;
    for (const AxisValue& value : axis.values) names.push_back(value.label);
    place.fail(key, fmt::format("'{}' is no value of the axis '{}', which has {}", name, axis.name,
                                fmt::join(names, ", ")));
  }
  return values;
}

StudyAxis read_axis(const Config& entry, bool quick) {
  StudyAxis axis;
  const std::string key = entry.text("key", "");
  axis.name = entry.text("name", key.substr(key.rfind('.') + 1));
  if (!is_plain_name(axis.name))
    entry.fail("name", "an axis needs a name of letters, digits, _ and -, or a `key`");
  for (const ConfigValues& element : entry.elements("values")) {
    AxisValue value = read_value(entry, key, element);
    if (axis.find(value.label) < axis.values.size())
      entry.fail("values",
                 fmt::format("'{}' is there twice; give each a label of its own", value.label));
    axis.values.push_back(std::move(value));
  }
  if (axis.values.empty()) entry.fail("values", "at least one is needed");
  if (entry.has("quick")) {
    std::vector<AxisValue> fewer;
    for (const std::size_t k : chosen(entry, "quick", axis, entry.elements("quick")))
      fewer.push_back(axis.values[k]);
    if (quick) axis.values = std::move(fewer);
  }
  return axis;
}

std::size_t axis_named(const std::vector<StudyAxis>& axes, const std::string& name) {
  return index(
      std::find_if(axes.begin(), axes.end(), [&](const auto& a) { return a.name == name; }) -
      axes.begin());
}

// { axis = value or [values], ... }; values that only the whole study has never match in its quick form.
std::vector<AxisMatch> read_match(const Config& place, const std::vector<StudyAxis>& all,
                                  const std::vector<StudyAxis>& axes, const ConfigValues& names) {
  std::vector<AxisMatch> matches;
  for (const auto& [name, text] : names) {
    AxisMatch match{axis_named(axes, name), {}};
    if (match.axis == axes.size()) {
      std::vector<std::string> known;
      for (const StudyAxis& axis : axes) known.push_back(axis.name);
      place.fail(name,
                 fmt::format("is no axis of this study, which has {}", fmt::join(known, ", ")));
    }
    const bool list = !text.empty() && text.front() == '[';
    const std::vector<ConfigValues> labels =
        list ? place.elements(name) : std::vector<ConfigValues>{{{"", text}}};
    for (const std::size_t k : chosen(place, name, all[match.axis], labels)) {
      const std::size_t kept = axes[match.axis].find(all[match.axis].values[k].label);
      if (kept < axes[match.axis].values.size()) match.values.push_back(kept);
    }
    matches.push_back(std::move(match));
  }
  return matches;
}

void roles(StudySettings& study) {
  const std::size_t none = study.axes.size();
  study.method = axis_named(study.axes, "method");
  study.sweep = study.across = none;
  for (std::size_t k = 0; k < none; ++k) {
    if (k == study.method) continue;
    std::size_t& role = study.sweep == none ? study.sweep : study.across;
    if (role == none) role = k;
  }
}

// The smallest value of the swept axis, everything else as in the point itself.
AxisMatch finest(const Config& entry, const StudySettings& study) {
  if (study.sweep == study.axes.size())
    entry.fail("reference", "\"finest\" needs an axis besides the methods");
  const StudyAxis& axis = study.axes[study.sweep];
  std::size_t best = 0;
  for (std::size_t k = 0; k < axis.values.size(); ++k) {
    const auto value = as_number(axis.values[k].label), least = as_number(axis.values[best].label);
    if (!value || !least)
      entry.fail(
          "reference",
          fmt::format("\"finest\" needs numbers along the axis '{}'; name the point instead, as "
                      "in reference = {{ {} = \"{}\" }}",
                      axis.name, axis.name, axis.values[k].label));
    if (*value < *least) best = k;
  }
  return {study.sweep, {best}};
}

void read_reference(const Config& entry, const std::vector<StudyAxis>& all,
                    const StudySettings& study, StudyObservable& observable) {
  const ConfigValues reference = entry.values("reference");
  if (reference.empty())
    entry.fail("reference",
               "a number, \"monte-carlo\", \"finest\" or a point such as { method = "
               "\"trapezoidal\" } is needed");
  const std::string text = reference.front().second;
  if (!reference.front().first.empty()) {
    observable.kind = ReferenceKind::point;
    observable.at = read_match(entry.table("reference"), all, study.axes, reference);
    for (const AxisMatch& match : observable.at)
      if (match.values.size() != 1)
        entry.fail(
            "reference",
            fmt::format("names {} values of the axis '{}'; one is needed, also in the quick form",
                        match.values.size(), study.axes[match.axis].name));
  } else if (const auto number = as_number(text)) {
    observable.kind = ReferenceKind::number;
    observable.number = *number;
  } else if (word(text) == "finest") {
    observable.kind = ReferenceKind::point;
    observable.at = {finest(entry, study)};
  } else if (word(text) != "monte-carlo") {
    entry.fail("reference",
               "must be a number, \"monte-carlo\", \"finest\" or a point such as { method = "
               "\"trapezoidal\" }");
  }
  if (!observable.table.empty() && observable.kind == ReferenceKind::number)
    entry.fail("reference",
               "a table is compared with that of a run: \"monte-carlo\", \"finest\" or a point");
}

StudyObservable read_observable(const Config& entry, const std::vector<StudyAxis>& all,
                                const StudySettings& study) {
  StudyObservable observable;
  observable.name = entry.text("name");
  if (const std::string rms = ".rms"; observable.name.ends_with(rms)) {
    observable.table = observable.name.substr(0, observable.name.size() - rms.size());
    observable.below = entry.positive("below", observable.below);
  }
  read_reference(entry, all, study, observable);
  observable.tolerance = entry.positive("tolerance", observable.tolerance);
  return observable;
}

void read_budget(const Config& config, StudyBudget& budget) {
  if (config.has("duration")) budget.duration = config.positive("duration");
  if (config.has("equilibrate")) budget.equilibrate = config.non_negative("equilibrate");
  if (config.has("standard_error")) budget.standard_error = config.positive("standard_error");
  if (config.has("seconds")) budget.seconds = config.positive("seconds");
}

std::string name_of(const fs::path& file) {
  const fs::path full = fs::absolute(file).lexically_normal();
  return full.filename() == "study.toml" ? full.parent_path().filename().string()
                                         : full.stem().string();
}

}  // namespace

std::size_t StudyAxis::find(const std::string& label) const {
  const auto number = as_number(label);
  const auto same = [&](const AxisValue& value) {
    if (value.label == label) return true;
    const auto other = as_number(value.label);
    return number && other && *number == *other;
  };
  return index(std::find_if(values.begin(), values.end(), same) - values.begin());
}

StudySettings read_study(const fs::path& path, bool quick) {
  std::error_code ignored;
  StudySettings study;
  study.file = fs::is_directory(path, ignored) ? path / "study.toml" : path;
  const Config config = Config::from_file(study.file);
  study.name = name_of(study.file);
  study.title = config.text("title", study.name);
  study.case_path = (config.directory() / config.text("case")).lexically_normal();
  study.seeds = config.positive_integer("seeds", 1);
  study.set = keys_of(config, "set");
  study.monte_carlo = keys_of(config, "monte_carlo");
  read_budget(config.table("budget"), study.budget);
  std::vector<StudyAxis> all;
  for (const Config& entry : config.tables("axis")) {
    all.push_back(read_axis(entry, false));
    study.axes.push_back(read_axis(entry, quick));
    if (axis_named(all, all.back().name) + 1 != all.size())
      entry.fail("name",
                 fmt::format("there are two axes '{}'; give one another name", all.back().name));
  }
  if (study.axes.empty()) config.fail("axis", "a study needs at least one [[axis]]");
  roles(study);
  for (const Config& entry : config.tables("skip")) {
    ConfigValues names;
    for (const StudyAxis& axis : all)
      for (const auto& value : entry.values(axis.name)) names.emplace_back(axis.name, value.second);
    if (names.empty())
      entry.fail("", "[[skip]] needs the name of an axis, as in method = [\"setd\"]");
    study.skip.push_back(read_match(entry, all, study.axes, names));
  }
  for (const Config& entry : config.tables("observable"))
    study.observables.push_back(read_observable(entry, all, study));
  if (study.observables.empty())
    config.fail("observable", "a study needs at least one [[observable]]");
  const Config fast = config.table("quick");
  const ConfigValues quick_set = keys_of(fast, "set"),
                     quick_sampling = keys_of(fast, "monte_carlo");
  StudyBudget quick_budget = study.budget;
  read_budget(fast.table("budget"), quick_budget);
  const std::int64_t quick_seeds = fast.positive_integer("seeds", study.seeds);
  if (quick) {
    append(study.set, quick_set);
    append(study.monte_carlo, quick_sampling);
    study.budget = quick_budget;
    study.seeds = quick_seeds;
  }
  config.reject_unread();
  return study;
}

}  // namespace odpd
