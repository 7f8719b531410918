#include "odpd/analysis/msd.h"

#include <fmt/format.h>

#include <cmath>

namespace odpd {

template <int D>
Msd<D>::Msd(ObserverSettings settings, MsdSettings msd, const Scene<D>& scene, double dt)
    : Observer<D>(std::move(settings)),
      msd_(std::move(msd)),
      scene_(scene),
      species_(scene.settings().species.size()),
      displacements_(this->settings().name, msd_.window, msd_.fit_from,
                     dt * static_cast<double>(this->settings().every), species_) {}

template <int D>
void Msd<D>::measure(const Clock&, const Particles<D>& particles, const StepRecord<D>&) {
  // Unwrapped positions by identity, so that reordering of memory does not matter.
  std::vector<double> now(particles.position.size() * D);
  std::vector<std::int32_t> kind(particles.position.size(), -1);
  for (std::size_t i = 0; i < particles.position.size(); ++i) {
    const auto id = static_cast<std::size_t>(particles.id[i]);
    if (particles.is_free(i)) kind[id] = particles.species[i];
    for (std::size_t c = 0; c < D; ++c)
      now[id * D + c] = particles.position[i].x[c] + particles.image[i][c] * scene_.box().size.x[c];
  }
  displacements_.add(std::move(now), kind, D, msd_.directions);
}

template <int D>
std::vector<std::string> Msd<D>::series_columns() const {
  std::vector<std::string> columns;
  for (const auto& species : scene_.settings().species)
    columns.push_back("diffusion_" + species.name);
  columns.push_back("diffusion");
  return columns;
}

template <int D>
void Msd<D>::add_results(Results& results) const {
  const std::string prefix = this->settings().name == "msd" ? "" : this->settings().name + ".";
  if (displacements_.windows() == 0) {
    results.scalars.push_back({prefix + "diffusion", std::nan(""), std::nan("")});
    results.notes.push_back(
        fmt::format("{}: the measured part is shorter than the window of {}, so no diffusion "
                    "coefficient",
                    this->settings().name, msd_.window));
    return;
  }
  const BlockAverage& diffusion = displacements_.diffusion();
  const BlockAverage& msd = displacements_.curve();
  results.scalars.push_back(
      {prefix + "diffusion", diffusion.mean(species_), diffusion.standard_error(species_)});
  const auto& species = scene_.settings().species;
  Table table;
  table.columns = {"lag"};
  Chart chart{.title = "Mean-square displacement",
              .x_label = "lag",
              .y_label = "msd / r_c^2",
              .curves = {}};
  for (std::int64_t lag = 0; lag < displacements_.lags(); ++lag)
    table.rows.push_back({displacements_.lag(lag)});
  for (std::size_t a = 0; a < species_; ++a) {
    if (species_ > 1)
      results.scalars.push_back({prefix + "diffusion." + species[a].name, diffusion.mean(a),
                                 diffusion.standard_error(a)});
    table.columns.insert(table.columns.end(),
                         {"msd_" + species[a].name, "msd_" + species[a].name + "_error"});
    Curve curve{.title = species[a].name, .x = {}, .y = {}, .error = {}};
    for (std::size_t lag = 0; lag < static_cast<std::size_t>(displacements_.lags()); ++lag) {
      const std::size_t column = lag * species_ + a;
      table.rows[lag].insert(table.rows[lag].end(), {msd.mean(column), msd.standard_error(column)});
      curve.x.push_back(table.rows[lag][0]);
      curve.y.push_back(msd.mean(column));
    }
    chart.curves.push_back(std::move(curve));
  }
  results.tables.emplace_back(this->settings().name, std::move(table));
  results.charts.emplace_back(this->settings().name, std::move(chart));
}

template <int D>
void Msd<D>::save(StateWriter& out) const {
  displacements_.save(out, "");
}

template <int D>
void Msd<D>::load(const StateReader& in) {
  // The particles of the checkpoint are in the scene already.
  displacements_.load(in, "", scene_.particles().position.size() * D);
}

template class Msd<2>;
template class Msd<3>;

}  // namespace odpd
