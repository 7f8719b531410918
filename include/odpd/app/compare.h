#pragma once
// `odpd compare`: one frozen configuration and right-hand side of a case, solved by every backend over a sweep of
// tolerances; error in v against the tightest solution of the same problem, against seconds.
#include <filesystem>
#include <string>
#include <vector>

namespace odpd {

struct CompareOptions {
  std::filesystem::path case_path;
  std::filesystem::path out;  ///< empty: runs/<case>-compare
  std::vector<std::string> overrides;
  std::vector<std::string> solvers;  ///< empty: all that this build has
  std::vector<double> tolerances;    ///< empty: 1e-2 to 1e-10
  bool increment_rule = false;       ///< the Picard schemes stop by the paper's eq. 27
  std::int64_t steps = 50;  ///< of the case's own integrator before the configuration is frozen
  int threads = 1;
};

/// Returns 0, or 2 when some solve did not converge. Throws Error.
int compare_solvers(const CompareOptions& options);

}  // namespace odpd
