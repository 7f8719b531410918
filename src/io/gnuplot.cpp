// draw_chart of gnuplot.h.
#include "odpd/io/gnuplot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>

#include "gnuplot_run.h"
#include "odpd/core/error.h"

namespace odpd {

namespace {

// Okabe and Ito 2008: told apart by colour-blind readers. Their yellow is too faint on white.
constexpr std::array<const char*, 7> colours{"#0072B2", "#D55E00", "#009E73", "#CC79A7",
                                             "#E69F00", "#56B4E9", "#000000"};
constexpr std::array<int, 6> symbols{7, 5, 9, 13, 11, 15};
constexpr std::array<int, 6> hollow_symbols{6, 4, 8, 12, 10, 14};
constexpr int width = 960;
constexpr int height = 640;

struct Point {
  double x, y, low, high;
  bool limit = false;
  std::string label;
};
using Points = std::vector<Point>;

/// The part of one axis that holds all points.
struct Span {
  bool log = false;
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  void include(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  bool empty() const { return low > high; }
  /// 0 at the low end, 1 at the high end.
  double fraction(double value) const {
    if (low == high) return 0.5;
    if (!log) return (value - low) / (high - low);
    return (std::log(value) - std::log(low)) / (std::log(high) - std::log(low));
  }
};

constexpr const char* limit_title = "below the noise: upper limit";

bool has_limits(const Points& points) {
  return std::any_of(points.begin(), points.end(), [](const Point& p) { return p.limit; });
}

/// A word in a data block.
std::string data_word(const std::string& text) {
  std::string word = "\"";
  for (const char c : text) word += c == '"' || c == '\\' || c == '\n' ? ' ' : c;
  return word + "\"";
}

Points drawable(const Curve& curve, const Chart& chart, const std::filesystem::path& stem) {
  const bool bars = !curve.error.empty();
  if (curve.x.size() != curve.y.size() || (bars && curve.error.size() != curve.x.size())) {
    throw IoError(fmt::format(
        "{}: curve '{}' has {} x, {} y and {} error values; give as many of "
        "each",
        stem.string(), curve.title, curve.x.size(), curve.y.size(), curve.error.size()));
  }
  Points points;
  for (std::size_t i = 0; i < curve.x.size(); ++i) {
    const double x = curve.x[i], y = curve.y[i];
    if (!std::isfinite(x) || !std::isfinite(y)) continue;
    if ((chart.log_x && x <= 0.0) || (chart.log_y && y <= 0.0)) continue;
    const double error = bars && std::isfinite(curve.error[i]) ? std::abs(curve.error[i]) : 0.0;
    const bool limit = i < curve.limit.size() && curve.limit[i];
    points.push_back({x, y, y - error, limit ? y : y + error, limit,
                      i < curve.label.size() ? curve.label[i] : ""});
  }
  return points;
}

/// Round numbers between two positive ends: 1, 2, 5 of each decade, or all digits, or even steps,
/// whichever first gives three.
std::vector<double> log_ticks(double low, double high) {
  std::vector<double> ticks;
  for (const bool all_digits : {false, true}) {
    ticks.clear();
    for (double decade = std::floor(std::log10(low)); decade <= std::log10(high); ++decade) {
      for (int digit = 1; digit < 10; ++digit) {
        if (!all_digits && digit != 1 && digit != 2 && digit != 5) continue;
        const double tick = digit * std::pow(10.0, decade);
        if (tick >= low && tick <= high) ticks.push_back(tick);
      }
    }
    if (ticks.size() >= 3) return ticks;
  }
  ticks.clear();
  const double step = std::pow(10.0, std::floor(std::log10((high - low) / 2.0)));
  const double wide = (high - low) / step > 6.0 ? 5.0 * step : step;
  for (double k = std::ceil(low / wide); k * wide <= high; ++k) ticks.push_back(k * wide);
  return ticks;
}

/// A logarithmic axis over the points: powers of ten, or round numbers where those are too few.
std::string log_axis(char axis, Span span) {
  if (span.empty()) return fmt::format("set logscale {0}\nset {0}range [1:10]\n", axis);
  const double decades = std::log10(span.high) - std::log10(span.low);
  const double margin = std::max(1.05, std::pow(10.0, 0.04 * decades));
  span.low /= margin;
  span.high *= margin;
  const std::string text =
      fmt::format("set logscale {0}\nset {0}range [{1}:{2}]\n", axis, span.low, span.high);
  if (std::floor(std::log10(span.high)) - std::ceil(std::log10(span.low)) >= 2.0) {
    return text + fmt::format("set format {0} '10^{{%L}}'\n", axis);
  }
  std::string list;
  for (const double tick : log_ticks(span.low, span.high)) {
    list += fmt::format("{}'{:g}' {}", list.empty() ? "" : ", ", tick, tick);
  }
  return text + fmt::format("set {}tics ({})\n", axis, list);
}

std::string linear_axis(char axis, const Span& span) {
  if (span.empty()) return fmt::format("set {}range [0:1]\n", axis);
  if (span.low < span.high) return "";
  // A single value: some room around it.
  const double room = span.low == 0.0 ? 1.0 : 0.5 * std::abs(span.low);
  return fmt::format("set {}range [{}:{}]\n", axis, span.low - room, span.high + room);
}

struct Legend {
  std::string text;
  int room = 0;  ///< pixels that it makes the picture wider
};

/// Where the curves leave room for the legend: a corner, or below the picture, or, where it is long, beside it.
Legend legend(const Chart& chart, const std::vector<Points>& curves, const Span& x, const Span& y) {
  std::size_t letters = 0, entries = 0;
  for (const Curve& curve : chart.curves) {
    letters = std::max(letters, curve.title.size());
    if (!curve.title.empty()) ++entries;
  }
  if (entries == 0) return {"set key off\n"};
  if (std::any_of(curves.begin(), curves.end(), has_limits)) {
    letters = std::max(letters, std::string(limit_title).size());
    ++entries;
  }
  const double wide = 0.11 + 0.0125 * static_cast<double>(letters);
  const double high = 0.06 + 0.05 * static_cast<double>(entries);
  std::array<int, 4> covered{};  // left top, right top, left bottom, right bottom
  const auto visit = [&](double fx, double fy) {
    for (std::size_t corner = 0; corner < 4; ++corner) {
      const double from_side = corner % 2 == 0 ? fx : 1.0 - fx;
      const double from_edge = corner < 2 ? 1.0 - fy : fy;
      if (from_side < wide && from_edge < high) ++covered[corner];
    }
  };
  for (std::size_t k = 0; k < curves.size(); ++k) {
    const Points& points = curves[k];
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double fx = x.fraction(points[i].x);
      for (const double value : {points[i].low, points[i].y, points[i].high}) {
        visit(fx, y.fraction(value));
      }
      if (!chart.curves[k].line || i == 0) continue;
      const double before_x = x.fraction(points[i - 1].x), before_y = y.fraction(points[i - 1].y);
      const double after_y = y.fraction(points[i].y);
      for (double t = 0.05; t < 1.0; t += 0.05) {
        visit(before_x + t * (fx - before_x), before_y + t * (after_y - before_y));
      }
    }
  }
  constexpr std::array<const char*, 4> places{"left top", "right top", "left bottom",
                                              "right bottom"};
  constexpr std::array<std::size_t, 4> order{1, 0, 3, 2};
  // Labels reach further than their points.
  const bool labelled = std::any_of(chart.curves.begin(), chart.curves.end(),
                                    [](const Curve& curve) { return !curve.label.empty(); });
  for (const std::size_t corner : order) {
    if (labelled || covered[corner] > 0 || wide > 0.6 || high > 0.5) continue;
    return {
        fmt::format("set key inside {} Left reverse noenhanced box lc '#bbbbbb' opaque "
                    "samplen 2 spacing 1.15 width 1 height 0.4\n",
                    places[corner])};
  }
  const std::string style = "Left reverse noenhanced samplen 2 spacing 1.15\n";
  if (entries <= 4) return {"set key below height 1 " + style};
  return {"set key outside right top " + style, 80 + 10 * static_cast<int>(letters)};
}

/// The plot elements of one curve, the `place`-th of the palette, whose data block is `data`.
std::string elements(const Curve& curve, const std::string& data, std::size_t place) {
  const std::size_t style = place % colours.size(), round = place / colours.size();
  const std::size_t mark = place % symbols.size();
  const bool points = curve.points || !curve.line;
  const bool bars = !curve.error.empty();
  const std::string look = fmt::format("lc '{}'", colours[style]);
  const std::string title =
      curve.title.empty() ? "notitle" : "title " + gnuplot_quoted(curve.title);
  if (curve.backdrop) {
    std::string text = fmt::format("{} using 1:2 with lines lc '#c8c8c8' lw 9 {}", data, title);
    if (!curve.label.empty())
      text += fmt::format(
          ", {} using 1:2:6 with labels noenhanced offset 0,-1.1 tc '#606060' notitle", data);
    return text;
  }
  std::string text;
  if (bars && !points) {
    text += fmt::format("{} using 1:3:4 with filledcurves {} fs transparent solid 0.2 notitle, ",
                        data, look);
  }
  // Second time round the palette lines are dashed.
  if (!points)
    return text +
           fmt::format("{} using 1:2 with lines {} lw 2.5 dt {} {}", data, look, round + 1, title);
  if (curve.line)
    text += fmt::format("{} using 1:2 with lines {} lw 2 dt {} notitle, ", data, look, round + 1);
  const char* columns = bars ? "3:4" : "";
  const char* with = bars ? "yerrorbars" : "points";
  const bool limits = std::find(curve.limit.begin(), curve.limit.end(), true) != curve.limit.end();
  if (limits)
    text +=
        fmt::format("{} using 1:($5 == 1 ? $2 : NaN){}{} with {} {} pt {} ps 1.3 lw 2 notitle, ",
                    data, bars ? ":" : "", columns, with, look, hollow_symbols[mark]);
  return text + fmt::format("{} using 1:($5 == 0 ? $2 : NaN){}{} with {} {} pt {} ps 1.1 lw 2 {}",
                            data, bars ? ":" : "", columns, with, look, symbols[mark], title);
}

/// The palette's place of each curve; a backdrop takes none.
std::vector<std::size_t> places(const Chart& chart) {
  std::vector<std::size_t> list;
  std::size_t next = 0;
  for (const Curve& curve : chart.curves) list.push_back(curve.backdrop ? 0 : next++);
  return list;
}

}  // namespace

bool draw_chart(const std::filesystem::path& stem, const Chart& chart) {
  std::vector<Points> curves;
  Span x{chart.log_x}, y{chart.log_y};
  std::string data, plot;
  const std::vector<std::size_t> place = places(chart);
  for (std::size_t k = 0; k < chart.curves.size(); ++k) {
    Points& points = curves.emplace_back(drawable(chart.curves[k], chart, stem));
    if (points.empty()) continue;
    data += fmt::format("$curve{} << EOD\n", k);
    for (Point& point : points) {
      // A bar that reaches zero has no lower end on a logarithmic axis: it runs out of the picture.
      const bool endless = chart.log_y && point.low <= 0.0;
      if (endless) point.low = std::numeric_limits<double>::min();
      x.include(point.x);
      y.include(endless ? 0.5 * point.y : point.low);
      y.include(point.high);
      data += fmt::format("{} {} {} {} {:d} {}\n", point.x, point.y, point.low, point.high,
                          point.limit, data_word(point.label));
    }
    data += "EOD\n";
    plot += (plot.empty() ? "plot " : ", \\\n     ") +
            elements(chart.curves[k], fmt::format("$curve{}", k), place[k]);
  }
  if (std::any_of(curves.begin(), curves.end(), has_limits) && !plot.empty())
    plot += fmt::format(", \\\n     NaN with points pt {} ps 1.3 lw 2 lc '#444444' title {}",
                        hollow_symbols[0], gnuplot_quoted(limit_title));
  std::string script = "# Run: gnuplot " + stem.filename().string() + ".gp\n" + data;
  script += fmt::format("set title {} noenhanced\nset xlabel {}\nset ylabel {}\n",
                        gnuplot_quoted(chart.title), gnuplot_quoted(chart.x_label),
                        gnuplot_quoted(chart.y_label));
  script +=
      "set border lw 1.2 lc '#444444'\nset tics textcolor '#000000'\n"
      "set grid lt 1 lw 1 lc '#d8d8d8'\n";
  script += chart.log_x ? log_axis('x', x) : linear_axis('x', x);
  script += chart.log_y ? log_axis('y', y) : linear_axis('y', y);
  const Legend key = legend(chart, curves, x, y);
  script += key.text;
  if (plot.empty()) {
    script += "set label 'no data' at graph 0.5, 0.5 center\n";
    plot = "plot NaN notitle";
  }
  script += gnuplot_outputs(stem.filename().string(), plot, width + key.room, height);
  return run_gnuplot(stem, script);
}

}  // namespace odpd
