#pragma once
// Trajectory after H5MD 1.1 (de Buyl, Colberg, Hoefling 2014): /h5md, /particles/all/{box/edges,
// position, image, velocity} (and density, where a frame has it) with step, time and value, and {id, species, group} fixed within a
// segment; D = 2 is stored as 2, edges as a matrix with an edge vector per row. Bonds, as pairs of
// ids, under /connectivity/bonds. The case and the names of the species are under /parameters/odpd.
// Written in segments `trajectory.NNNN.h5`, each built in memory and closed (written whole) at a
// checkpoint.
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "odpd/io/frame.h"
#include "odpd/io/h5_file.h"

namespace odpd {

class TrajectorySegments {
 public:
  /// Segments go to `directory`; `case_text` (the resolved case) and `version` become metadata of
  /// each.
  TrajectorySegments(std::filesystem::path directory, std::string case_text, std::string version,
                     std::string title);
  /// All frames of a segment have the same particles.
  void append(const Frame& frame);
  /// Writes one frame by itself, as a file of that name in the directory.
  void write_single(const std::string& name, const Frame& frame) const;
  /// Writes the open segment (nothing when it is empty) as it is now.
  void save_segment() const;
  /// The same, and starts a new one.
  void close_segment();
  // State for a restart: number of the open segment, and its frames so far.
  std::int64_t segment() const { return segment_; }
  std::int64_t frames() const { return frames_; }
  /// After a restart: takes up segment `segment` with its first `frames` frames. Touches no file. Throws IoError when the
  /// segment has fewer.
  void reopen(std::int64_t segment, std::int64_t frames);
  /// Deletes the segments after the open one, and the open one when it has no frames.
  void delete_later() const;

 private:
  void open(const Frame& frame);
  void open_box(const Frame& frame);
  std::filesystem::path directory_;
  std::string case_text_, version_, title_;
  std::int64_t segment_ = 0, frames_ = 0;
  std::unique_ptr<H5Image> image_;
};

/// Last frame of an H5MD file: /particles/all, or else the first particles group. Only the position
/// is needed: arrays of what the file does not have stay empty, but ids then count from 0. Throws
/// IoError.
Frame read_h5md(const std::filesystem::path& file);

}  // namespace odpd
