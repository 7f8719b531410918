#include "odpd/analysis/density_residual.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace odpd {

namespace {

constexpr auto no_column = static_cast<std::size_t>(-1);

// The column of each cell of the grid; none for cells whose centre is nearer than `clear` to that of a body.
template <int D>
std::vector<std::size_t> columns_clear_of_bodies(const Grid<D>& grid, const Scene<D>& scene,
                                                 double clear) {
  std::vector<std::size_t> columns(grid.cells());
  std::size_t next = 0;
  for (std::size_t cell = 0; cell < columns.size(); ++cell) {
    Vec<D> centre;
    for (int c = 0; c < D; ++c)
      centre[c] = grid.low[c] + (static_cast<double>(grid.place(cell, c)) + 0.5) * grid.spacing(c);
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
    : Observer<D>(std::move(settings)),
      grid_(bins, scene),
      column_(columns_clear_of_bodies(grid_, scene, clear_of_bodies)),
      average_(static_cast<std::size_t>(std::count_if(
          column_.begin(), column_.end(), [](std::size_t c) { return c != no_column; }))) {}

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
  std::vector<double> counts(average_.width(), 0.0);
  for (std::size_t i = 0; i < record.start.position.size(); ++i)
    if (particles.is_free(i)) {
      const std::size_t column = column_[grid_.cell_of(record.start.position[i])];
      if (column != no_column) counts[column] += 1.0;
    }
  average_.add(counts);
  const double thesis = thesis_residual(counts);
  newest_ = {thesis / std::sqrt(static_cast<double>(counts.size())), thesis};
}

template <int D>
void DensityResidual<D>::add_results(Results& results) const {
  if (average_.samples() == 0) return;
  std::vector<double> means(average_.width());
  for (std::size_t b = 0; b < means.size(); ++b) means[b] = average_.mean(b);
  const double thesis = thesis_residual(means);
  const double error =
      average_.jackknife_error([this](const std::vector<double>& m) { return thesis_residual(m); });
  const double to_paper = 1.0 / std::sqrt(static_cast<double>(means.size()));
  const std::string& name = this->settings().name;
  results.scalars.push_back({name + ".paper", thesis * to_paper, error * to_paper});
  results.scalars.push_back({name + ".thesis", thesis, error});
  double noise = 0.0;
  for (std::size_t b = 0; b < means.size(); ++b)
    noise += std::pow(average_.standard_error(b) / grid_.cell_volume(), 2) /
             static_cast<double>(means.size());
  results.scalars.push_back({name + ".noise", std::sqrt(noise), std::nan("")});
  const double excess =
      std::isnan(noise) ? noise : std::sqrt(std::max(thesis * thesis - noise, 0.0));
  results.scalars.push_back({name + ".excess", excess, error});
}

template class DensityResidual<2>;
template class DensityResidual<3>;

}  // namespace odpd
