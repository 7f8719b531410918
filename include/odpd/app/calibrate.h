#pragma once
// `odpd calibrate`: the friction that gives a fluid the viscosity asked for, by measurements.
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace odpd {

struct CalibrateOptions {
  std::filesystem::path case_path;
  std::filesystem::path out;  ///< empty: runs/<case>-calibrate
  std::vector<std::string> overrides;
  double eta = 0.0;             ///< 0: that of the case
  double relative_error = 0.0;  ///< standard error of the viscosity, over it; 0: 0.02
  double shear_rate = 0.0;      ///< 0: in proportion to 1/gamma
  std::int64_t particles = 0;   ///< of the measuring scene; 0: a cube of 8 (2D), 6 (3D) cutoffs
  double limit_seconds = 0.0;   ///< of the whole; 0: none
  int threads = 1;
  bool measure_only = false;  ///< one measurement at the friction of the case
};

/// Returns the exit code: 0, 130 when interrupted. Throws Error (exit code 4) where the error is not reached within the
/// limit; what was measured is in calibration.json of the output directory, from where the same command goes on.
int calibrate(const CalibrateOptions& options);

}  // namespace odpd
