#include "odpd/analysis/density_residual.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "odpd/analysis/observer_keys.h"
#include "odpd/core/index.h"

namespace odpd {

namespace {

constexpr auto no_column = index(-1);

// The column of each cell of the grid; none for cells whose centre is nearer than `clear` to that of a body.
template <int D>
std::vector<std::size_t> columns_clear_of_bodies(const Grid<D>& grid, const Scene<D>& scene,
                                                 double clear) {
  std::vector<std::size_t> columns(grid.cells());
  std::size_t next = 0;
  for (std::size_t cell = 0; cell < columns.size(); ++cell) {
    Vec<D> centre;
    for (int c = 0; c < D; ++c)
      centre[c] =
          grid.low[c] + (static_cast<double>(grid.coordinate(cell, c)) + 0.5) * grid.spacing(c);
    bool is_clear = true;
    for (const auto& body : scene.particles().bodies)
      if (norm(scene.box().separation(centre, body.pose.centre)) < clear) is_clear = false;
    columns[cell] = is_clear ? next++ : no_column;
  }
  return columns;
}

}  // namespace

template <int D>
DensityResidual<D>::DensityResidual(ObserverSettings settings, const typename Grid<D>::Counts& bins,
                                    const Scene<D>& scene, double clear_of_bodies)
    : DensityResidual(std::move(settings), Grid<D>(bins, scene),
                      columns_clear_of_bodies(Grid<D>(bins, scene), scene, clear_of_bodies)) {}

template <int D>
DensityResidual<D>::DensityResidual(ObserverSettings settings, Grid<D> grid,
                                    std::vector<std::size_t> column)
    : Observer<D>(std::move(settings),
                  index(std::count_if(column.begin(), column.end(),
                                      [](std::size_t c) { return c != no_column; }))),
      grid_(std::move(grid)),
      column_(std::move(column)) {}

template <int D>
std::unique_ptr<Observer<D>> DensityResidual<D>::make(const ObserverEntry<D>& entry) {
  ObserverSettings settings = entry.settings();
  const Config& config = entry.config;
  const Scene<D>& scene = entry.scene;
  const auto cells = read_cells(entry);
  const double clear = config.non_negative("clear_of_bodies", 0.0);
  auto observer = std::make_unique<DensityResidual<D>>(std::move(settings), cells, scene, clear);
  if (clear == 0.0) return observer;
  const auto& bodies = scene.settings().bodies;
  if (bodies.empty()) config.fail("clear_of_bodies", "the scene has no [[body]]");
  if (scene.box().shear)
    config.fail(
        "clear_of_bodies",
        "under [shear] cells behind a sliding face move past the bodies: leave the key out");
  for (const auto& body : bodies)
    if (body.motion != BodyMotion::fixed)
      config.fail("clear_of_bodies",
                  fmt::format("cells are left out around fixed bodies only, and '{}' moves: give "
                              "it motion = \"fixed\" or leave the key out",
                              body.name));
  if (observer->cells() < 2)
    config.fail("clear_of_bodies", "leaves less than two cells: use a smaller one, or more bins");
  return observer;
}

template <int D>
double DensityResidual<D>::thesis_residual(std::span<const double> counts) const {
  const auto n_bins = static_cast<double>(counts.size());
  const double mean = std::accumulate(counts.begin(), counts.end(), 0.0) / n_bins;
  double sum = 0.0;
  for (const double count : counts) sum += (count - mean) * (count - mean);
  return std::sqrt(sum / n_bins) / grid_.cell_volume();
}

template <int D>
void DensityResidual<D>::measure(const Clock&, const Particles<D>& particles,
                                 const StepRecord<D>& record) {
  std::vector<double> counts(cells(), 0.0);
  const Share own = particles.owned();
  for (std::size_t i = 0; i < record.start.position.size(); ++i)
    if (particles.is_free(i) && own.owns(i)) {
      const std::size_t column = column_[grid_.cell_of(record.start.position[i])];
      if (column != no_column) counts[column] += 1.0;
    }
  own.ranks->sum(std::span(counts));
  const double thesis = thesis_residual(counts);
  instant_ = {thesis / std::sqrt(static_cast<double>(counts.size())), thesis};
  this->add(std::move(counts));
}

template <int D>
void DensityResidual<D>::add_results(Results& results) const {
  const BlockAverage& average = this->average();
  std::vector<double> means(cells());
  for (std::size_t b = 0; b < means.size(); ++b) means[b] = average.mean(b);
  const double thesis = thesis_residual(means);
  const double error =
      average.jackknife_error([this](const std::vector<double>& m) { return thesis_residual(m); });
  const double to_paper = 1.0 / std::sqrt(static_cast<double>(means.size()));
  results.scalars.push_back({this->named("paper"), thesis * to_paper, error * to_paper});
  results.scalars.push_back({this->named("thesis"), thesis, error});
  double noise = 0.0;
  for (std::size_t b = 0; b < means.size(); ++b)
    noise += std::pow(average.standard_error(b) / grid_.cell_volume(), 2) /
             static_cast<double>(means.size());
  results.scalars.push_back(without_error(this->named("noise"), std::sqrt(noise)));
  const double excess =
      std::isnan(noise) ? noise : std::sqrt(std::max(thesis * thesis - noise, 0.0));
  results.scalars.push_back({this->named("excess"), excess, error});
}

template class DensityResidual<2>;
template class DensityResidual<3>;

}  // namespace odpd
