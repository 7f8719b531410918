#pragma once
// Pictures through gnuplot: a script is kept beside the picture, so that a user can redraw or
// restyle it.
#include <filesystem>

#include "odpd/core/table.h"
#include "odpd/io/frame.h"

namespace odpd {

/// Writes the self-contained `<stem>.gp` (data inline) and makes `<stem>.svg` and `<stem>.png` with
/// gnuplot. Points that cannot be drawn (NaN, infinity, <= 0 on a logarithmic axis) are left out.
/// Titles and legends are plain text; in axis labels _ and ^ make indices ("v_x", "{/Symbol h}").
/// Returns false, with a warning logged once, when gnuplot is not installed; throws IoError when
/// gnuplot fails or the pictures cannot be written.
bool draw_chart(const std::filesystem::path& stem, const Chart& chart);

/// The same for a map of cells.
bool draw_map(const std::filesystem::path& stem, const CellMap& map);

/// The particles coloured by `component` of velocity (0 = x), walls outlined; 3D: projected on x-y,
/// the highest z in front. Of very many particles only every k-th is drawn, and the title says so.
bool draw_particles(const std::filesystem::path& stem, const Frame& frame, int component);

}  // namespace odpd
