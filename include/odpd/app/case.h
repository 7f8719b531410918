#pragma once
// A case file as the program sees it: what to integrate, with which solver, for how long, what to write and to check.
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "odpd/core/config.h"
#include "odpd/dynamics/clock.h"
#include "odpd/dynamics/dynamics.h"
#include "odpd/dynamics/integrator.h"
#include "odpd/io/checkpoint_file.h"
#include "odpd/scene/scene_settings.h"
#include "odpd/solvers/solver.h"

namespace odpd {

/// [output]: intervals in steps, 0 for never.
struct OutputSettings {
  std::int64_t checkpoint_every = 1000;
  std::int64_t trajectory_every = 100;
  std::int64_t vtk_every = 0;
  bool pictures = true;
};

/// One [[check]]: an observable against what it should be.
struct CheckSettings {
  std::string name;
  std::string observable;
  double expected = 0.0;
  double tolerance = 0.0;  ///< absolute; the check passes when |measured - expected| <= tolerance
  double standard_error_below = 0;  ///< also asked of the standard error, where > 0
  std::string source;
};

/// [run] until: the run ends once the standard error of an observable is this small.
struct TargetSettings {
  std::string observable;
  double standard_error = 0.0;
};

struct CaseSettings {
  std::string name;  ///< of the case directory or file
  std::string title;
  int dimension = 2;
  IntegratorSettings integrator;
  Clock clock;
  SolverOptions solver;
  DynamicsSettings dynamics;
  OutputSettings output;
  std::vector<CheckSettings> checks;
  std::optional<TargetSettings> until;
  double blow_up = 10.0;  ///< multiple of app/blow_up.h
};

/// Opens a case: a directory that holds case.toml, or a .toml file. Throws ConfigError.
Config open_case(const std::filesystem::path& path, const std::vector<std::string>& overrides);
/// Name for `runs/<name>`: of the directory, or of the file without .toml.
std::string case_name(const std::filesystem::path& path);
/// Reads title, dimension, [integrator], [solver], [neighbours], [run], [output] and [[check]].
CaseSettings read_case(const Config& config, const std::string& name);
/// All that the case says of its scene, with the contents of its files (start, bonds, calibration): of a `restart` from the
/// checkpoint, whose file texts `config` has (`take_file_texts`).
template <int D>
SceneSettings<D> read_scene(const Config& config, CheckpointReader* restart = nullptr);

/// The resolved case as TOML, the files it names absolute: it runs from whatever directory it is put in.
std::string portable_case(const Config& config);

}  // namespace odpd
