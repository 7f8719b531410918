#pragma once
// calibration.json: what was to be calibrated, every measurement, and the result.
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "odpd/app/calibration.h"
#include "odpd/app/calibration_run.h"
#include "odpd/core/config.h"
#include "odpd/pairs/calibration.h"

namespace odpd {

struct CalibrationRecord {
  MeasuredFluid fluid;
  double eta = 0.0;              ///< asked for; 0: only measure, at the friction of the case
  double relative_error = 0.02;  ///< asked for
  std::vector<ViscosityMeasurement> measurements;
  std::optional<FrictionEstimate> result;  ///< once the error is reached
};

/// Writes the whole file. Throws IoError.
void write_calibration(const std::filesystem::path& file, const CalibrationRecord& record);

/// Takes the measurements of an earlier file into `record` when it was of the same fluid, eta and scene, whatever the
/// error then; else says in words what differs. "" for neither (no file, or the same).
std::string continue_calibration(const std::filesystem::path& file, CalibrationRecord& record);

/// The file that fluid.calibration of a case names (relative to the case), for read_scene_settings; nothing without that
/// key. Throws ConfigError where it cannot be read or has no result.
std::optional<Calibration> read_calibration(const Config& config);

}  // namespace odpd
