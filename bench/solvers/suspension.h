#pragma once
// The suspensions of the benchmark, and what is written of them.
#include <filesystem>
#include <string>
#include <vector>

#include "benchmark.h"
#include "configuration.h"

namespace bench {

inline constexpr double suspension_tolerance = 1e-7;
inline constexpr std::int64_t aged_steps = 50;
inline constexpr std::int64_t largest_aged = 200000;  // a run of 50 steps is too long above

/// What iterations with bodies may be over those of the fluid: sites nearer to each other than 0.4 are harder.
double allowed_ratio(double spacing);

struct SuspensionTables {
  explicit SuspensionTables(const std::filesystem::path& out);
  Results scenes;      ///< suspension.csv: iterations and seconds of a solve; radius 0: the fluid
  Results steps;       ///< suspension_steps.csv: the step by phase, with bodies and of the fluid
  Results backends;    ///< suspension_backends.csv: as results.csv
  Results robustness;  ///< suspension_robustness.csv
};

struct Aged {
  std::int64_t last = -1;       ///< iterations of the first solve of the last step
  std::int64_t most = -1;       ///< of any solve
  std::int64_t fallbacks = -1;  ///< solves whose preconditioner was given up
};

/// `aged_steps` trapezoidal steps with one solver object, to 1e-7.
template <int D>
Aged aged(const FluidSpec& spec, const Start<D>& start);

/// The name of a scene in the place of `geometry`.
std::string suspension_name(const std::string& share, const std::string& radius);

void run_suspension_robustness(const Options& options, Results& results);
/// Walls and shear at this number of particles, of a solver made anew and, where that ends, 50 steps old.
void run_suspension_growth(const Options& options, std::int64_t size, Results& results);
/// suspension.md and charts.
void write_suspension(const SuspensionTables& tables, const std::filesystem::path& out);

}  // namespace bench
