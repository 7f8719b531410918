#pragma once
// `odpd study`: accuracy against cost, and where methods break (docs/study.md).
#include <filesystem>

namespace odpd {

struct StudyOptions {
  std::filesystem::path study_path;
  /// Empty: runs/study-<name>, of the quick form runs/study-<name>-quick.
  std::filesystem::path out;
  bool quick = false;
  bool dry_run = false;  ///< lists the points with an estimate of the time
  int threads = 1;
};

/// Runs what is not done yet and writes study.csv, runs.csv, the pictures and study.html into the output directory.
/// Returns 0, or 130 when interrupted: the same command goes on from there. Throws Error.
int run_study(const StudyOptions& options);

}  // namespace odpd
