// draw_particles of gnuplot.h.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "gnuplot_run.h"
#include "odpd/core/error.h"
#include "odpd/core/index.h"
#include "odpd/io/gnuplot.h"

namespace odpd {

namespace {

constexpr std::size_t most_circles = 50000;
// Pixels: the longer side of the box, and the margins around it.
constexpr double drawn_pixels = 760.0;
constexpr double left = 85.0, right = 150.0, bottom = 75.0, top = 55.0;

/// The drawn region: the box, or what the particles fill where there is none.
struct Region {
  double x0 = 0.0, x1 = 1.0, y0 = 0.0, y1 = 1.0;
};

double coordinate(const Frame& frame, std::size_t particle, int component) {
  return frame.position[particle * index(frame.dimension) + index(component)];
}

Region drawn_region(const Frame& frame) {
  if (frame.box_size.size() >= 2) return {0.0, frame.box_size[0], 0.0, frame.box_size[1]};
  Region region;
  for (std::size_t p = 0; p < frame.id.size(); ++p) {
    const double x = coordinate(frame, p, 0), y = coordinate(frame, p, 1);
    region.x0 = p == 0 ? x : std::min(region.x0, x);
    region.x1 = p == 0 ? x : std::max(region.x1, x);
    region.y0 = p == 0 ? y : std::min(region.y0, y);
    region.y1 = p == 0 ? y : std::max(region.y1, y);
  }
  if (region.x1 <= region.x0) region.x1 = region.x0 + 1.0;
  if (region.y1 <= region.y0) region.y1 = region.y0 + 1.0;
  return region;
}

/// Circles that nearly touch at the mean distance of neighbours.
double circle_radius(const Frame& frame, const Region& region, std::size_t drawn) {
  const double area = (region.x1 - region.x0) * (region.y1 - region.y0);
  double volume = area;
  double particles = static_cast<double>(std::max<std::size_t>(frame.id.size(), 1));
  if (frame.dimension == 3 && frame.box_size.size() == 3) volume *= frame.box_size[2];
  if (frame.dimension == 3 && frame.box_size.size() != 3) particles = std::pow(particles, 2.0 / 3);
  const double exponent = frame.box_size.size() == 3 ? 1.0 / 3.0 : 0.5;
  const double thinning = std::sqrt(static_cast<double>(frame.id.size()) /
                                    static_cast<double>(std::max<std::size_t>(drawn, 1)));
  return 0.42 * std::pow(volume / particles, exponent) * std::max(1.0, thinning);
}

/// Colours and their range. Both signs: blue - grey - red around zero, else dark to bright.
std::string palette(std::vector<double> values) {
  double low = 0.0, high = 0.0;
  if (!values.empty()) {
    // A hundredth at each end is left to the end colours, so that a few fast ones do not
    // take all the contrast.
    std::sort(values.begin(), values.end());
    const std::size_t cut = values.size() / 100;
    low = values[cut];
    high = values[values.size() - 1 - cut];
  }
  if (std::min(-low, high) > 0.05 * std::max(-low, high)) {
    high = std::max(-low, high);
    return fmt::format(
        "set palette defined (0 '#053061', 1 '#2166ac', 2 '#67a9cf', 3 '#dddddd', "
        "4 '#ef8a62', 5 '#b2182b', 6 '#67001f')\nset cbrange [{}:{}]\n",
        -high, high);
  }
  if (low >= high) {
    const double room = low == 0.0 ? 1.0 : 0.5 * std::abs(low);
    low -= room;
    high += room;
  }
  return fmt::format(
      "set palette defined (0 '#440154', 1 '#3b528b', 2 '#21918c', 3 '#5ec962', "
      "4 '#fde725')\nset cbrange [{}:{}]\n",
      low, high);
}

/// Which particles are drawn, back to front.
std::vector<std::size_t> drawing_order(const Frame& frame) {
  const std::size_t stride = (frame.id.size() + most_circles - 1) / most_circles;
  std::vector<std::size_t> order;
  for (std::size_t p = 0; p < frame.id.size(); p += stride) order.push_back(p);
  if (frame.dimension == 3) {
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return coordinate(frame, a, 2) < coordinate(frame, b, 2);
    });
  }
  return order;
}

std::string title(const Frame& frame, std::size_t drawn) {
  std::string text = fmt::format("t = {:g}", frame.time);
  if (drawn < frame.id.size()) {
    const std::size_t stride = (frame.id.size() + most_circles - 1) / most_circles;
    text += fmt::format(", every {}th of {} particles", stride, frame.id.size());
  }
  return text;
}

int canvas(double inside, double margins) {
  return static_cast<int>(std::lround(inside + margins));
}

/// Equal scales, and margins that make `inside` pixels of the box, so that circle sizes are right.
std::string frame_layout(const Region& region, double inside_x, double inside_y) {
  const double x = canvas(inside_x, left + right), y = canvas(inside_y, bottom + top);
  return fmt::format(
      "set size ratio -1\nset key off\nset tics out nomirror\nset border lw 1.5\n"
      "set lmargin at screen {}\nset rmargin at screen {}\n"
      "set bmargin at screen {}\nset tmargin at screen {}\n"
      "set xrange [{}:{}]\nset yrange [{}:{}]\n",
      left / x, 1.0 - right / x, bottom / y, 1.0 - top / y, region.x0, region.x1, region.y0,
      region.y1);
}

}  // namespace

bool draw_particles(const std::filesystem::path& stem, const Frame& frame, int component) {
  if (component < 0 || component >= frame.dimension) {
    throw IoError(fmt::format("{}: there is no velocity component {} in {} dimensions",
                              stem.string(), component, frame.dimension));
  }
  const Region region = drawn_region(frame);
  const auto order = drawing_order(frame);
  std::string fluid, walls;
  std::vector<double> values;
  for (const std::size_t p : order) {
    const std::size_t place = p * index(frame.dimension) + index(component);
    const double velocity = place < frame.velocity.size() ? frame.velocity[place] : 0.0;
    const bool wall = p < frame.group.size() && frame.group[p] != 0;
    if (!wall && !std::isfinite(velocity)) continue;
    std::string& block = wall ? walls : fluid;
    block += fmt::format("{} {} {}\n", coordinate(frame, p, 0), coordinate(frame, p, 1),
                         wall ? 0.0 : velocity);
    if (!wall) values.push_back(velocity);
  }
  const double wide = region.x1 - region.x0, high = region.y1 - region.y0;
  const double scale = drawn_pixels / std::max(wide, high);
  const double radius = std::max(0.7, scale * circle_radius(frame, region, order.size()));
  std::string script = "# Run: gnuplot " + stem.filename().string() + ".gp\n";
  std::string plot;
  if (!fluid.empty()) {
    script += "$fluid << EOD\n" + fluid + "EOD\n";
    plot =
        fmt::format("plot $fluid using 1:2:3 with points pt 7 ps {:.4g}*pixel lc palette", radius);
  }
  if (!walls.empty()) {
    script += "$walls << EOD\n" + walls + "EOD\n";
    plot += fmt::format("{} $walls using 1:2 with points pt 6 ps {:.4g}*pixel lc '#777777'",
                        plot.empty() ? "plot" : ", \\\n    ", 0.9 * radius);
  }
  if (plot.empty()) plot = "plot NaN notitle";
  script += fmt::format(
      "set title {} noenhanced\nset xlabel 'x'\nset ylabel 'y'\n"
      "set cblabel 'v_{}'\n",
      gnuplot_quoted(title(frame, order.size())), "xyz"[component]);
  script += palette(std::move(values));
  script += frame_layout(region, wide * scale, high * scale);
  script += gnuplot_outputs(stem.filename().string(), plot, canvas(wide * scale, left + right),
                            canvas(high * scale, bottom + top));
  return run_gnuplot(stem, script);
}

}  // namespace odpd
