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
};

struct Chart {
  std::string title, x_label, y_label;
  bool log_x = false, log_y = false;
  std::vector<Curve> curves;
};

}  // namespace odpd
