#pragma once
// Particles for ParaView: XML PolyData (.vtp) per frame and a .pvd collection with times. ASCII,
// 3 components (z = 0 in 2D, as VTK demands).
#include <cstdint>
#include <filesystem>
#include <utility>
#include <vector>

#include "odpd/io/frame.h"

namespace odpd {

/// One frame: points, velocity, angular velocity and density where it has them, id, species, group, through write_file_atomically.
void write_vtp(const std::filesystem::path& file, const Frame& frame);
/// The collection: (time, file name relative to it) per frame.
void write_pvd(const std::filesystem::path& file,
               const std::vector<std::pair<double, std::string>>& frames);

/// The frames of a run, frames/<step>.vtp, and particles.pvd, which lists them with their times.
class VtkFrames {
 public:
  explicit VtkFrames(std::filesystem::path directory);
  void append(const Frame& frame);
  /// The last configuration of a run, unless it was appended. A run that goes on later does not keep it.
  void append_last(const Frame& frame);
  /// After a restart: these frames stay, and those of later steps, or of an end before the end, are deleted.
  void resume_at(const std::vector<double>& times, const std::vector<std::int64_t>& steps);
  // State for a restart.
  const std::vector<double>& times() const { return times_; }
  const std::vector<std::int64_t>& steps() const { return steps_; }

 private:
  void write(const Frame& frame) const;
  void write_collection(std::vector<double> times, std::vector<std::int64_t> steps) const;
  std::filesystem::path directory_;
  std::vector<double> times_;
  std::vector<std::int64_t> steps_;
};

}  // namespace odpd
