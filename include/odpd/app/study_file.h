#pragma once
// What a study asks, as its file says (docs/study.md): a case, axes over keys of it, seeds, observables with their
// references, and how long each point may run.
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "odpd/core/config.h"

namespace odpd {

/// One value of an axis: what it is called, and the keys of the case it sets.
struct AxisValue {
  std::string label;
  ConfigValues set;
};

struct StudyAxis {
  std::string name;
  std::vector<AxisValue> values;
  /// Index of the value called `label` (numbers by value: 0.010 is 0.01); values.size() when there is none.
  std::size_t find(const std::string& label) const;
};

/// Values along some of the axes: to leave points out, or to name one.
struct AxisMatch {
  std::size_t axis = 0;
  std::vector<std::size_t> values;
};

enum class ReferenceKind { number, monte_carlo, point };

struct StudyObservable {
  /// As in a [[check]]; "<table>.rms": rms difference of a table's second column.
  std::string name;
  std::string table;  ///< file stem, for ".rms"
  double below =
      std::numeric_limits<double>::infinity();  ///< of a table: rows whose first column is less
  ReferenceKind kind = ReferenceKind::monte_carlo;
  double number = 0.0;
  std::vector<AxisMatch> at;  ///< of a reference point: one value for each axis named
  double tolerance =
      0.01;  ///< bias that still counts as none, relative to |reference| (of a table: absolute)
};

struct StudyBudget {
  double duration = 0.0;      ///< time units; 0: the case's
  double equilibrate = -1.0;  ///< time units; < 0: the case's
  double standard_error =
      0.0;               ///< of the first observable, where the run may stop; 0: runs its duration
  double seconds = 0.0;  ///< wall time of a run, which is then stopped and kept; 0: no limit
};

struct StudySettings {
  std::string name;  ///< of the directory, or of the file without .toml
  std::string title;
  std::filesystem::path file, case_path;
  std::int64_t seeds = 1;
  ConfigValues set;
  std::vector<StudyAxis> axes;
  std::vector<std::vector<AxisMatch>> skip;  ///< points that match all of one entry are left out
  std::vector<StudyObservable> observables;
  StudyBudget budget;
  ConfigValues monte_carlo;  ///< keys of the Monte Carlo runs

  // Roles of the axes by their order: the one named "method" gives the lines of a chart and the panels of a map, the
  // first other one is swept along a line (x of a map), the second is y of a map; for each value of further ones
  // charts are drawn anew. axes.size() stands for none.
  std::size_t method = 0, sweep = 0, across = 0;
};

/// Reads study.toml, or the one in a directory; `quick`: with the values of its quick form. Throws ConfigError.
StudySettings read_study(const std::filesystem::path& path, bool quick);

}  // namespace odpd
