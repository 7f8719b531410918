#pragma once
// `odpd calibrate --radius`: how large a body, or a colloid of one particle, is to a flow and to the fluid's particles; and which cutoff, core or
// friction with the fluid gives it a radius that is wanted.
#include <filesystem>
#include <string>
#include <vector>

namespace odpd {

struct CalibrateRadiusOptions {
  std::filesystem::path case_path;
  std::filesystem::path out;  ///< empty: runs/<case>-radius
  std::vector<std::string> overrides;
  std::string
      body;  ///< name of the [[body]], or [[molecule]] of one particle; empty: the only free one
  std::string find;     ///< a key of its [[pair]] with the fluid that is to be chosen; empty: none
  double wanted = 0.0;  ///< radius by drag that it is to give (length)
  std::vector<double> edges;    ///< of the cubes (length); empty: three
  double relative_error = 0.0;  ///< standard error of the radius, over it; 0: 0.01
  double limit_seconds = 0.0;   ///< of the whole; 0: none
  int threads = 1;
};

/// With `find` the key is searched for by secants, in the smallest box, and what is found is then measured in all of them.
/// Returns the exit code: 0, 130 when interrupted. Throws ConfigError where the case has no such [[pair]] or no value gives the radius. Throws Error (exit code 4) where the error is not reached within the limit; what was
/// measured is in radius.json and radius.csv of the output directory.
int calibrate_radius(const CalibrateRadiusOptions& options);

}  // namespace odpd
