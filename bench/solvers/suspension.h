#pragma once
// The suspensions of the benchmark, and what is written of them.
#include <filesystem>
#include <string>
#include <vector>

#include "benchmark.h"

namespace bench {

inline constexpr double suspension_tolerance = 1e-7;
inline constexpr std::int64_t aged_steps = 50;

/// What iterations with bodies may be over those of the fluid: sites nearer to each other than 0.4 are harder.
double allowed_ratio(double spacing);

struct SuspensionTables {
  explicit SuspensionTables(const std::filesystem::path& out);
  Results scenes;      ///< suspension.csv: iterations and seconds of a solve; radius 0: the fluid
  Results steps;       ///< suspension_steps.csv: the step by phase, with bodies and of the fluid
  Results backends;    ///< suspension_backends.csv: as results.csv
  Results robustness;  ///< suspension_robustness.csv
};

/// The name of a scene in the place of `geometry`.
std::string suspension_name(const std::string& share, const std::string& radius);

void run_suspension_robustness(const Options& options, Results& results);
/// suspension.md and charts.
void write_suspension(const SuspensionTables& tables, const std::filesystem::path& out);

}  // namespace bench
