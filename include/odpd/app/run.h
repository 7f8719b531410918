#pragma once
// `odpd run`: one case from start to finish.
#include <filesystem>
#include <string>
#include <vector>

namespace odpd {

struct RunOptions {
  std::filesystem::path case_path;
  std::filesystem::path out;  ///< empty: runs/<case>, or the checkpoint's directory at a restart
  std::vector<std::string> overrides;
  int threads = 0;                ///< 0: chosen by the number of particles
  std::filesystem::path restart;  ///< checkpoint to continue from; empty: a new run
  bool dry_run = false;
};

/// Returns the exit code: 0, 4 when a check failed, 130 when interrupted. Throws Error for everything else.
int run_case(const RunOptions& options);

}  // namespace odpd
