// draw_map of gnuplot.h. Coordinates are pixels.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "gnuplot_run.h"
#include "odpd/core/index.h"
#include "odpd/io/gnuplot.h"

namespace odpd {

namespace {

constexpr double cell_width = 96.0, cell_height = 52.0;
constexpr double above = 74.0, below = 84.0;  // around a panel
constexpr double title_height = 50.0, legend_height = 60.0;

constexpr double legend_left = 40.0, letter_width = 10.5;

double legend_width(const CellMap::Kind& kind) {
  return 60.0 + letter_width * static_cast<double>(kind.name.size());
}

struct Layout {
  std::size_t columns = 1, rows = 1;
  double left, right, panel_width, panel_height, width, height, first_x;

  explicit Layout(const CellMap& map) {
    std::size_t letters = map.y_label.size();
    for (const std::string& tick : map.y_ticks) letters = std::max(letters, tick.size());
    const double cells = cell_width * static_cast<double>(map.x_ticks.size());
    double beside = 20.0;  // of a panel's title, centred over the cells
    for (const CellMap::Panel& panel : map.panels)
      beside = std::max(
          beside, 0.5 * (letter_width * static_cast<double>(panel.title.size()) - cells) + 20.0);
    left = std::max(30.0 + letter_width * static_cast<double>(letters), beside);
    right = beside;
    panel_width = left + cells + right;
    panel_height = above + cell_height * static_cast<double>(map.y_ticks.size()) + below;
    const std::size_t panels = std::max<std::size_t>(map.panels.size(), 1);
    // As wide as about 1900 pixels allow.
    columns = std::clamp<std::size_t>(static_cast<std::size_t>(1900.0 / panel_width), 1, panels);
    rows = (panels + columns - 1) / columns;
    columns = (panels + rows - 1) / rows;
    double legend = legend_left;
    for (const CellMap::Kind& kind : map.kinds) legend += legend_width(kind);
    const double title = letter_width * static_cast<double>(map.title.size());
    width = std::max({title, panel_width * static_cast<double>(columns), 640.0, legend});
    first_x = 0.5 * (width - panel_width * static_cast<double>(columns)) + left;
    height = title_height + panel_height * static_cast<double>(rows) + legend_height;
  }
  double x(std::size_t panel) const {
    return first_x + panel_width * static_cast<double>(panel % columns);
  }
  /// Of the lower edge of the cells.
  double y(std::size_t panel) const {
    return height - title_height - panel_height * static_cast<double>(panel / columns + 1) + below;
  }
};

std::string label(const std::string& text, double x, double y, const char* how) {
  return fmt::format("set label {} at {},{} {} noenhanced\n", gnuplot_quoted(text), x, y, how);
}

std::string box(double x, double y, double width, double height, const std::string& colour) {
  return fmt::format(
      "set object rectangle from {},{} to {},{} fs solid noborder fc rgb '{}' behind\n", x, y,
      x + width, y + height, colour);
}

std::string panel_text(const CellMap& map, const Layout& layout, std::size_t number) {
  const CellMap::Panel& panel = map.panels[number];
  const double x0 = layout.x(number), y0 = layout.y(number);
  const double nx = static_cast<double>(map.x_ticks.size()),
               ny = static_cast<double>(map.y_ticks.size());
  std::string text =
      label(panel.title, x0 + 0.5 * nx * cell_width, y0 + ny * cell_height + 50.0, "center");
  for (std::size_t i = 0; i < map.x_ticks.size(); ++i)
    text += label(map.x_ticks[i], x0 + (static_cast<double>(i) + 0.5) * cell_width, y0 - 16.0,
                  "center");
  for (std::size_t j = 0; j < map.y_ticks.size(); ++j)
    text += label(map.y_ticks[j], x0 - 10.0, y0 + (static_cast<double>(j) + 0.5) * cell_height,
                  "right");
  text += label(map.x_label, x0 + 0.5 * nx * cell_width, y0 - 44.0, "center");
  text += label(map.y_label, x0 - 10.0, y0 + ny * cell_height + 22.0, "right");
  for (std::size_t j = 0; j < panel.rows.size(); ++j)
    for (std::size_t i = 0; i < panel.rows[j].size(); ++i) {
      const CellMap::Cell& cell = panel.rows[j][i];
      if (cell.kind >= map.kinds.size()) continue;
      const double x = x0 + static_cast<double>(i) * cell_width,
                   y = y0 + static_cast<double>(j) * cell_height;
      text +=
          box(x + 1.0, y + 1.0, cell_width - 2.0, cell_height - 2.0, map.kinds[cell.kind].colour);
      text += label(cell.text, x + 0.5 * cell_width, y + 0.5 * cell_height, "center");
    }
  return text;
}

}  // namespace

bool draw_map(const std::filesystem::path& stem, const CellMap& map) {
  const Layout layout(map);
  std::string script = "# Run: gnuplot " + stem.filename().string() + ".gp\n";
  script += fmt::format(
      "set lmargin at screen 0\nset rmargin at screen 1\nset bmargin at screen 0\nset tmargin at "
      "screen 1\n"
      "set xrange [0:{}]\nset yrange [0:{}]\nunset border\nunset tics\nunset key\n",
      layout.width, layout.height);
  script += label(map.title, 0.5 * layout.width, layout.height - 26.0, "center");
  for (std::size_t k = 0; k < map.panels.size(); ++k) script += panel_text(map, layout, k);
  double x = legend_left;
  for (const CellMap::Kind& kind : map.kinds) {
    script += box(x, 20.0, 26.0, 22.0, kind.colour) + label(kind.name, x + 34.0, 31.0, "left");
    x += legend_width(kind);
  }
  script += gnuplot_outputs(stem.filename().string(), "plot NaN notitle",
                            static_cast<int>(std::lround(layout.width)),
                            static_cast<int>(std::lround(layout.height)));
  return run_gnuplot(stem, script);
}

}  // namespace odpd
