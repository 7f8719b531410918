#pragma once
// `odpd calibrate --radius`: how large a body is to a flow and to the fluid's particles.
#include <filesystem>
#include <string>
#include <vector>

namespace odpd {

struct CalibrateRadiusOptions {
  std::filesystem::path case_path;
  std::filesystem::path out;  ///< empty: runs/<case>-radius
  std::vector<std::string> overrides;
  std::string body;             ///< name of the [[body]]; empty: the only free one
  std::vector<double> edges;    ///< of the cubes (length); empty: three
  double relative_error = 0.0;  ///< standard error of the radius, over it; 0: 0.01
  double limit_seconds = 0.0;   ///< of the whole; 0: none
  int threads = 1;
};

/// Returns the exit code: 0, 130 when interrupted. Throws Error (exit code 4) where the error is not reached within the limit; what was
/// measured is in radius.json and radius.csv of the output directory.
int calibrate_radius(const CalibrateRadiusOptions& options);

}  // namespace odpd
