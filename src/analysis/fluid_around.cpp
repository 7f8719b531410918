#include "odpd/analysis/fluid_around.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "odpd/analysis/observer_keys.h"
#include "odpd/core/index.h"
#include "odpd/core/parallel.h"
#include "odpd/geometry/pair_list.h"

namespace odpd {

namespace {

// Volume between the radii a and b, in D dimensions.
template <int D>
double shell(double a, double b) {
  return unit_ball_volume<D> * (std::pow(b, D) - std::pow(a, D));
}

}  // namespace

template <int D>
FluidAroundSettings read_fluid_around(const ObserverEntry<D>& entry) {
  const Config& config = entry.config;
  FluidAroundSettings s;
  s.r_max = read_r_max(entry);
  s.bin = config.positive("bin", s.bin);
  if (s.bin > s.r_max)
    config.fail(config.has("bin") ? "bin" : "r_max",
                fmt::format("bin = {} must be at most r_max = {}", s.bin, s.r_max));
  s.empty = config.positive("empty", s.empty);
  if (s.empty >= 1.0) config.fail("empty", "must be below 1, the mean density of the fluid");
  return s;
}

template <int D>
FluidAround<D>::FluidAround(FluidAroundSettings settings, std::vector<std::string> names,
                            std::vector<std::size_t> kind)
    : settings_(settings),
      names_(std::move(names)),
      kind_(std::move(kind)),
      share_(names_.size(), 0.0),
      bins_(static_cast<std::size_t>(std::llround(settings.r_max / settings.bin))),
      density_(names_.size() * bins_) {
  for (const std::size_t k : kind_) share_[k] += 1.0;
  for (double& s : share_) s = 1.0 / s;
}

// Cells as wide as g(q) reaches say which particles may be near a centre. Under shear these are cells along the edges of the
// sheared cell, in which a distance along the flow may be longer.
template <int D>
void FluidAround<D>::add(const Stage<D>& stage, std::span<const Vec<D>> centres,
                         std::span<const std::int32_t> fluid, double per_particle,
                         const Communicator& ranks) {
  const double reach = (1.0 + 1e-9) * settings_.bin * static_cast<double>(bins_);
  Box<D> straight = stage.box;
  double tilt = 0.0;
  if (straight.shear) tilt = std::abs(straight.offset) / straight.size[straight.shear->gradient];
  straight.shear.reset();
  std::vector<Vec<D>> places;
  for (const std::int32_t i : fluid)
    places.push_back(stage.box.straightened(stage.position[index(i)]));
  const CellList<D> cells(straight, std::hypot(1.0, tilt) * reach, places);
  const std::size_t pieces = std::min<std::size_t>(kind_.size(), 16);
  std::vector<double> g(density_.width(), 0.0);
  std::vector<std::int64_t> counts(pieces * g.size(), 0);
  parallel_blocks(static_cast<std::int64_t>(pieces), [&](std::int64_t piece) {
    std::int64_t* const count = &counts[index(piece) * g.size()];
    std::vector<std::int64_t> near;
    for (std::size_t b = index(piece); b < kind_.size(); b += pieces) {
      Vec<D> centre = centres[b];
      stage.box.wrap(centre);
      cells.neighbourhood(cells.cell_of(stage.box.straightened(centre)), near);
      for (const std::int64_t cell : near)
        for (const std::int32_t k : cells.members(cell)) {
          const Vec<D>& r = stage.position[index(fluid[index(k)])];
          const double q = norm(stage.box.separation(r, centre));
          const auto bin = static_cast<std::size_t>(q / settings_.bin);
          if (bin < bins_) ++count[kind_[b] * bins_ + bin];
        }
    }
  });
  for (std::size_t at = 0; at < g.size(); ++at) {
    const double inner = settings_.bin * static_cast<double>(at % bins_);
    const double each = share_[at / bins_] * per_particle /
                        shell<D>(inner, settings_.bin * (static_cast<double>(at % bins_) + 1.0));
    // One by one: a sum has the same bits however the particles were found.
    for (std::size_t piece = 0; piece < pieces; ++piece)
      for (std::int64_t k = counts[piece * g.size() + at]; k > 0; --k) g[at] += each;
  }
  ranks.sum(std::span(g));
  density_.add(g);
}

template <int D>
double FluidAround<D>::exclusion_radius(std::size_t kind) const {
  // What the ball holds beyond its share, at the bins' edges; the crossing farthest out counts.
  double radius = std::nan(""), beyond = 0.0;
  for (std::size_t k = 0; k < bins_; ++k) {
    const double r = settings_.bin * static_cast<double>(k);
    const double more =
        (density_.mean(kind * bins_ + k) - settings_.empty) * shell<D>(r, r + settings_.bin);
    if (beyond <= 0.0 && beyond + more > 0.0) radius = r - settings_.bin * beyond / more;
    beyond += more;
  }
  return beyond > 0.0 ? radius : std::nan("");  // the largest ball does not end within r_max
}

template <int D>
void FluidAround<D>::add_table(const std::string& name, const std::string& title,
                               Results& results) const {
  if (density_.samples() == 0) return;
  Table table;
  table.columns = {"q"};
  Chart chart{.title = title, .x_label = "q / r_c", .y_label = "g(q)", .curves = {}};
  for (std::size_t k = 0; k < bins_; ++k)
    table.rows.push_back({settings_.bin * (static_cast<double>(k) + 0.5)});
  for (std::size_t kind = 0; kind < names_.size(); ++kind) {
    table.columns.insert(table.columns.end(),
                         {"g_" + names_[kind], "g_" + names_[kind] + "_error"});
    Curve curve{
        .title = names_[kind], .x = {}, .y = {}, .error = {}, .line = true, .points = false};
    for (std::size_t k = 0; k < bins_; ++k) {
      const std::size_t at = kind * bins_ + k;
      table.rows[k].insert(table.rows[k].end(), {density_.mean(at), density_.standard_error(at)});
      curve.x.push_back(table.rows[k][0]);
      curve.y.push_back(density_.mean(at));
    }
    chart.curves.push_back(std::move(curve));
  }
  results.tables.emplace_back(name, std::move(table));
  results.charts.emplace_back(name, std::move(chart));
}

template FluidAroundSettings read_fluid_around<2>(const ObserverEntry<2>&);
template FluidAroundSettings read_fluid_around<3>(const ObserverEntry<3>&);
template class FluidAround<2>;
template class FluidAround<3>;

}  // namespace odpd
