#pragma once
// Particles for ParaView: XML PolyData (.vtp) per frame and a .pvd collection with times. ASCII,
// 3 components (z = 0 in 2D, as VTK demands).
#include <filesystem>
#include <utility>
#include <vector>

#include "odpd/io/frame.h"

namespace odpd {

/// One frame: points, velocity, id, species, group, through write_file_atomically.
void write_vtp(const std::filesystem::path& file, const Frame& frame);
/// The collection: (time, file name relative to it) per frame.
void write_pvd(const std::filesystem::path& file,
               const std::vector<std::pair<double, std::string>>& frames);

}  // namespace odpd
