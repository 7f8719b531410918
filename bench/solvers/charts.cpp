// Seconds and iterations against N, error against seconds.
#include <fmt/format.h>

#include <functional>

#include "backends.h"
#include "benchmark.h"
#include "odpd/io/gnuplot.h"

namespace bench {

namespace {

constexpr const char* shown_tolerance = "1e-05";

using Point = std::function<void(std::size_t row, odpd::Curve& curve)>;

/// One curve per backend through its rows that `chosen` picks.
std::vector<odpd::Curve> curves(const Results& solves,
                                const std::function<bool(std::size_t)>& chosen, const Point& add) {
  std::vector<odpd::Curve> all;
  for (const Backend& backend : backends()) {
    odpd::Curve curve{.title = backend.name, .x = {}, .y = {}, .error = {}, .line = true};
    for (std::size_t row = 0; row < solves.size(); ++row)
      if (solves.word(row, "backend") == backend.name && solves.word(row, "status") == "ok" &&
          chosen(row))
        add(row, curve);
    if (!curve.x.empty()) all.push_back(std::move(curve));
  }
  return all;
}

void draw_against_size(const Results& solves, const std::filesystem::path& out,
                       const std::string& dimension, const std::string& geometry) {
  const auto chosen = [&](std::size_t row) {
    return solves.word(row, "dimension") == dimension && solves.word(row, "geometry") == geometry &&
           solves.word(row, "tolerance") == shown_tolerance;
  };
  const std::string where = fmt::format("{}D, {}, tolerance 1e-5", dimension, geometry);
  odpd::Chart chart{.title = "Set-up and solve: " + where,
                    .x_label = "particles N",
                    .y_label = "seconds",
                    .log_x = true,
                    .log_y = true,
                    .curves = {}};
  chart.curves = curves(solves, chosen, [&](std::size_t row, odpd::Curve& curve) {
    curve.x.push_back(solves.number(row, "N"));
    curve.y.push_back(solves.number(row, "setup_s") + solves.number(row, "solve_s"));
  });
  if (chart.curves.empty()) return;  // nothing at this tolerance
  odpd::draw_chart(out / fmt::format("seconds_{}d_{}", dimension, geometry), chart);
  chart.title = "Iterations: " + where;
  chart.y_label = "iterations";
  chart.curves = curves(solves, chosen, [&](std::size_t row, odpd::Curve& curve) {
    curve.x.push_back(solves.number(row, "N"));
    curve.y.push_back(solves.number(row, "iterations"));
  });
  odpd::draw_chart(out / fmt::format("iterations_{}d_{}", dimension, geometry), chart);
}

void draw_errors(const Results& solves, const std::filesystem::path& out,
                 const std::string& dimension, const std::string& geometry,
                 const std::string& size) {
  const auto chosen = [&](std::size_t row) {
    return solves.word(row, "dimension") == dimension && solves.word(row, "geometry") == geometry &&
           solves.word(row, "N") == size;
  };
  odpd::Chart chart{
      .title = fmt::format("Error against cost: {}D, {}, N = {}, one point per tolerance",
                           dimension, geometry, size),
      .x_label = "seconds, set-up and solve",
      .y_label = "relative error in v",
      .log_x = true,
      .log_y = true,
      .curves = {}};
  chart.curves = curves(solves, chosen, [&](std::size_t row, odpd::Curve& curve) {
    curve.x.push_back(solves.number(row, "setup_s") + solves.number(row, "solve_s"));
    curve.y.push_back(solves.number(row, "error"));
  });
  if (!chart.curves.empty())
    odpd::draw_chart(out / fmt::format("error_{}d_{}_{}", dimension, geometry, size), chart);
}

}  // namespace

void draw_comparison(const Results& solves, const std::filesystem::path& out) {
  for (const std::string& dimension : solves.distinct("dimension"))
    for (const std::string& geometry : solves.distinct("geometry")) {
      draw_against_size(solves, out, dimension, geometry);
      for (const std::string& size : solves.distinct("N"))
        draw_errors(solves, out, dimension, geometry, size);
    }
}

}  // namespace bench
