#pragma once
// The points of a study: every combination of the values of its axes, less those left out, each repeated with the
// seeds 1, 2, ...; and the Monte Carlo runs that its references need, one per distinct
// equilibrium, 20000 sweeps unless [monte_carlo] says otherwise.
#include <cstdint>
#include <string>
#include <vector>

#include "odpd/app/study_file.h"

namespace odpd {

/// One run of the program.
struct StudyRun {
  std::string name;                    ///< of its directory
  std::vector<std::string> overrides;  ///< "key=value", as behind --set, but for `quiet_overrides`
  std::string resolved;                ///< the whole case as TOML
  double dt = 0.0;
  std::int64_t steps = 0;
  double step_seconds = 0.0;  ///< of a few first steps, where asked for
};

struct StudyPoint {
  /// Index along each axis; of a Monte Carlo point those of the first point it serves.
  std::vector<std::size_t> at;
  std::string label;
  bool monte_carlo = false;
  std::vector<StudyRun> runs;  ///< one per seed
};

struct StudyPlan {
  std::vector<StudyPoint> points;  ///< Monte Carlo first
  /// [point][observable]: index of the point it is compared with; points.size() where that is a number.
  std::vector<std::vector<std::size_t>> reference;
};

/// Builds every point's case once, so that a wrong key stops the study here. `measure`: also times a few steps of each.
/// Throws ConfigError.
StudyPlan plan_study(const StudySettings& study, bool measure);

}  // namespace odpd
