#pragma once
// What measurements hand to files: tables of numbers and charts of curves.
#include <string>
#include <vector>

namespace odpd {

/// A table with named columns; `comment` lines are written first, each behind "# ".
struct Table {
  std::vector<std::string> comment;
  std::vector<std::string> columns;
  std::vector<std::vector<double>> rows;
};

/// One curve: points with optional error bars (empty: none), drawn as points, as a line, or both.
struct Curve {
  std::string title;
  std::vector<double> x, y, error;
  bool line = false;
  bool points = true;
  std::vector<bool> limit = {};  ///< true: an upper limit, drawn hollow with its bar downwards
  std::vector<std::string> label = {};  ///< words beside the points
  bool backdrop = false;                ///< a wide grey line behind the curves
};

struct Chart {
  std::string title, x_label, y_label;
  bool log_x = false, log_y = false;
  std::vector<Curve> curves;
};

/// Panels of coloured cells with words in them.
struct CellMap {
  struct Kind {
    std::string name, colour;  ///< colour as "#rrggbb"
  };
  struct Cell {
    std::size_t kind = 0;  ///< index in `kinds`; beyond them: left blank
    std::string text;
  };
  struct Panel {
    std::string title;
    std::vector<std::vector<Cell>> rows;  ///< [y][x], from below
  };
  std::string title, x_label, y_label;
  std::vector<std::string> x_ticks, y_ticks;
  std::vector<Kind> kinds;
  std::vector<Panel> panels;
};

}  // namespace odpd
