#pragma once
// The files of a run, in one directory:
//
//   case.toml            the resolved case           summary.json       numbers, checks, timings
//   <observer>.csv       tables                      <observer>_series.csv   time series on request
//   *.svg, *.png, *.gp   pictures and their gnuplot scripts
//   trajectory.NNNN.h5   H5MD segments               particles.pvd, frames/*.vtp   for ParaView
//   checkpoint.h5        everything needed to continue, bit for bit
//   last_good.h5         after a blow-up: the last configuration that was judged sound
//
// A kill loses nothing but what came after the last checkpoint: files are written whole and renamed, and series are cut
// back to the checkpoint at a restart.
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "odpd/app/simulation.h"
#include "odpd/io/csv.h"
#include "odpd/io/run_lock.h"
#include "odpd/io/trajectory.h"
#include "odpd/io/vtk.h"

namespace odpd {

/// Makes `directory` ready for a new run and locks it: an earlier run there is moved aside to `<directory>.N`. Throws
/// IoError when a file, a running odpd, or a directory that is no run of odpd and not empty, is in the way.
RunLock prepare_run_directory(const std::filesystem::path& directory);

template <int D>
class RunOutput {
 public:
  RunOutput(std::filesystem::path directory, const Config& config, Simulation<D>& simulation);

  /// Starts all files anew and writes case.toml.
  void begin();
  /// Throws IoError where the files of this directory cannot go on from the checkpoint; touches nothing.
  void check(CheckpointReader& in);
  /// Continues the files of this directory from what the checkpoint says of them.
  void resume(CheckpointReader& in);
  /// Series, trajectory, VTK and checkpoint as they are due after the step just done.
  void after_step();
  /// A checkpoint of this moment, with all files flushed up to it first. Throws BlowUpError instead where the state has
  /// blown up. `ends_segment`: of the trajectory; the end of a run does not, as it may go on.
  void checkpoint(bool ends_segment = false);
  /// Writes what is buffered, as far as possible: for the way out after an error.
  void salvage() noexcept;
  /// After a step that failed or a state that has blown up: a checkpoint of this moment where its state is sound, and
  /// the last sound configuration in last_good.h5, as far as possible.
  void leave_last_good() noexcept;
  /// The last frame for ParaView and the last checkpoint.
  void close();
  /// Tables and pictures.
  void write_results(const Results& results);
  /// summary.json, in place of that of an earlier part.
  void write_summary(const std::string& text);

  const std::filesystem::path& directory() const { return directory_; }

 private:
  std::filesystem::path series_path(std::size_t k) const;
  void first_frame();

  std::filesystem::path directory_;
  const Config& config_;
  Simulation<D>& simulation_;
  TrajectorySegments trajectory_;
  std::vector<std::unique_ptr<SeriesFile>>
      series_;  // one per observer, null where none was asked for
  VtkFrames vtk_;
};

}  // namespace odpd
