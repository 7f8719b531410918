#pragma once
// Private to io: runs gnuplot on a script text, and words that scripts share.
#include <filesystem>
#include <string>

namespace odpd {

/// `text` as a gnuplot string on one line: no substitution of commands or variables in it.
std::string gnuplot_quoted(const std::string& text);
/// The end of a script: draws `plot` (a plot command) as NAME.svg and NAME.png of the given size in
/// pixels. In `plot` the variable `pixel` is the point size (ps) of a circle of radius one pixel.
std::string gnuplot_outputs(const std::string& name, const std::string& plot, int width,
                            int height);
/// Writes `<stem>.gp`, runs it in its directory and checks both pictures. See draw_chart.
bool run_gnuplot(const std::filesystem::path& stem, const std::string& script);

}  // namespace odpd
