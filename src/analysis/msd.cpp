#include "odpd/analysis/msd.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "odpd/analysis/least_squares.h"
#include "odpd/core/error.h"

namespace odpd {

template <int D>
Msd<D>::Msd(ObserverSettings settings, MsdSettings msd, const Scene<D>& scene, double dt)
    : Observer<D>(std::move(settings)),
      msd_(std::move(msd)),
      scene_(scene),
      lag_time_(dt * static_cast<double>(this->settings().every)),
      lags_(std::max<std::int64_t>(1, std::llround(msd_.window / lag_time_))),
      species_(scene.settings().species.size()),
      window_(static_cast<std::size_t>(lags_) * species_, 0.0),
      curve_(window_.size()),
      diffusion_(species_ + 1) {}

template <int D>
void Msd<D>::measure(const Clock&, const Particles<D>& particles, const StepRecord<D>&) {
  newest_.clear();
  // Unwrapped positions by identity, so that reordering of memory does not matter.
  std::vector<double> now(particles.position.size() * D);
  std::vector<std::int32_t> kind(particles.position.size(), -1);
  std::vector<double> population(species_, 0.0);
  for (std::size_t i = 0; i < particles.position.size(); ++i) {
    const auto id = static_cast<std::size_t>(particles.id[i]);
    if (particles.is_free(i)) {
      kind[id] = particles.species[i];
      population[static_cast<std::size_t>(kind[id])] += 1.0;
    }
    for (std::size_t c = 0; c < D; ++c)
      now[id * D + c] = particles.position[i].x[c] + particles.image[i][c] * scene_.box().size.x[c];
  }
  if (!origin_.empty()) {
    std::vector<double> sum(species_, 0.0);
    for (std::size_t id = 0; id < kind.size(); ++id) {
      if (kind[id] < 0) continue;
      for (const int c : msd_.directions) {
        const std::size_t at = id * D + static_cast<std::size_t>(c);
        const double path = now[at] - origin_[at];
        sum[static_cast<std::size_t>(kind[id])] += path * path;
      }
    }
    for (std::size_t a = 0; a < species_; ++a)
      window_[static_cast<std::size_t>(lag_) * species_ + a] =
          population[a] > 0.0 ? sum[a] / population[a] : 0.0;
    if (++lag_ < lags_) return;
    finish_window(population);
  }
  origin_ = std::move(now);
  lag_ = 0;
}

template <int D>
void Msd<D>::finish_window(const std::vector<double>& population) {
  curve_.add(window_);
  std::vector<double> value(species_ + 1, 0.0);
  double everyone = 0.0;
  for (std::size_t a = 0; a < species_; ++a) {
    std::vector<double> t, y;
    for (std::int64_t lag = 0; lag < lags_; ++lag) {
      const double time = lag_time_ * static_cast<double>(lag + 1);
      if (time < msd_.fit_from && lag + 2 < lags_) continue;
      t.push_back(time);
      y.push_back(window_[static_cast<std::size_t>(lag) * species_ + a]);
    }
    const std::vector<double> even(t.size(), 1.0);
    const double slope = t.size() > 1 ? fit_polynomial(1, t, y, even).coefficient[1] : y[0] / t[0];
    value[a] = slope / (2.0 * static_cast<double>(msd_.directions.size()));
    value[species_] += population[a] * value[a];
    everyone += population[a];
  }
  value[species_] /= everyone;
  diffusion_.add(value);
  newest_ = value;
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
  if (diffusion_.samples() == 0) {
    results.scalars.push_back({prefix + "diffusion", std::nan(""), std::nan("")});
    results.notes.push_back(
        fmt::format("{}: the measured part is shorter than the window of {}, so no diffusion "
                    "coefficient",
                    this->settings().name, msd_.window));
    return;
  }
  results.scalars.push_back(
      {prefix + "diffusion", diffusion_.mean(species_), diffusion_.standard_error(species_)});
  const auto& species = scene_.settings().species;
  Table table;
  table.columns = {"lag"};
  Chart chart{.title = "Mean-square displacement",
              .x_label = "lag",
              .y_label = "msd / r_c^2",
              .curves = {}};
  for (std::int64_t lag = 0; lag < lags_; ++lag)
    table.rows.push_back({lag_time_ * static_cast<double>(lag + 1)});
  for (std::size_t a = 0; a < species_; ++a) {
    if (species_ > 1)
      results.scalars.push_back({prefix + "diffusion." + species[a].name, diffusion_.mean(a),
                                 diffusion_.standard_error(a)});
    table.columns.insert(table.columns.end(),
                         {"msd_" + species[a].name, "msd_" + species[a].name + "_error"});
    Curve curve{.title = species[a].name, .x = {}, .y = {}, .error = {}};
    for (std::size_t lag = 0; lag < static_cast<std::size_t>(lags_); ++lag) {
      const std::size_t column = lag * species_ + a;
      table.rows[lag].insert(table.rows[lag].end(),
                             {curve_.mean(column), curve_.standard_error(column)});
      curve.x.push_back(table.rows[lag][0]);
      curve.y.push_back(curve_.mean(column));
    }
    chart.curves.push_back(std::move(curve));
  }
  results.tables.emplace_back(this->settings().name, std::move(table));
  results.charts.emplace_back(this->settings().name, std::move(chart));
}

template <int D>
void Msd<D>::save(StateWriter& out) const {
  out.write("lag", std::vector<std::int64_t>{lag_});
  out.write("origin", origin_);
  out.write("window", window_);
  curve_.save(out, "curve");
  diffusion_.save(out, "diffusion");
}

template <int D>
void Msd<D>::load(const StateReader& in) {
  const std::vector<std::int64_t> lag = in.read_integers("lag");
  origin_ = in.read_doubles("origin");
  window_ = in.read_doubles("window");
  // The particles of the checkpoint are in the scene already.
  const bool begun = origin_.size() == scene_.particles().position.size() * D;
  if (lag.size() != 1 || lag[0] < 0 || lag[0] >= lags_ || !(begun || origin_.empty()) ||
      window_.size() != static_cast<std::size_t>(lags_) * species_)
    throw IoError(
        fmt::format("the checkpoint's displacements '{}' do not fit the case's particles and "
                    "window: it is damaged or of another case",
                    this->settings().name));
  lag_ = lag[0];
  curve_.load(in, "curve");
  diffusion_.load(in, "diffusion");
}

template class Msd<2>;
template class Msd<3>;

}  // namespace odpd
