#include "odpd/analysis/msd.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "odpd/analysis/observer_keys.h"
#include "odpd/core/index.h"

namespace odpd {

template <int D>
MsdSettings read_msd(const ObserverEntry<D>& entry) {
  const Config& config = entry.config;
  const Scene<D>& scene = entry.scene;
  MsdSettings m;
  const LagRange lags = read_lags(config);
  m.window = lags.window;
  m.fit_from = lags.fit_from;
  // Along a bounded direction displacements saturate; along a moving wall or a force they are advection.
  std::vector<int> fallback;
  for (int c = 0; c < D; ++c)
    if (!flows_along(scene, c) && scene.box().is_periodic(c)) fallback.push_back(c);
  if (fallback.empty())
    for (int c = 0; c < D; ++c)
      if (!scene.box().is_periodic(c)) fallback.push_back(c);
  if (fallback.empty())
    for (int c = 0; c < D; ++c)
      if (!scene.box().shear || scene.box().shear->flow != c) fallback.push_back(c);
  m.directions = read_directions<D>(config, fallback);
  for (const int c : m.directions)
    if (scene.box().shear && scene.box().shear->flow == c)
      config.fail("directions",
                  fmt::format("{} is the flow direction of [shear]: displacements along it are "
                              "advection, and jump where a particle crosses a sliding face",
                              "xyz"[c]));
  return m;
}

std::int64_t msd_interval(const Clock& clock) {
  return std::max<std::int64_t>(1, std::llround(0.05 / clock.dt));
}

template <int D>
Msd<D>::Msd(ObserverSettings settings, MsdSettings msd, const Scene<D>& scene, double dt)
    : Observer<D>(std::move(settings)),
      msd_(std::move(msd)),
      scene_(scene),
      species_(scene.settings().species.size()),
      displacements_(this->settings().name, msd_.window, msd_.fit_from,
                     dt * static_cast<double>(this->settings().every), species_) {
  scene.particles().carry(column());
}

template <int D>
std::unique_ptr<Observer<D>> Msd<D>::make(const ObserverEntry<D>& entry) {
  return std::make_unique<Msd<D>>(entry.settings(msd_interval(entry.clock)), read_msd(entry),
                                  entry.scene, entry.clock.dt);
}

template <int D>
void Msd<D>::measure(const Clock&, const Particles<D>& particles, const StepRecord<D>&) {
  std::vector<Vec<D>>& origin = particles.carry(column());
  const auto unwrapped = [&](std::size_t i, std::size_t c) {
    return particles.position[i].x[c] + particles.image[i][c] * scene_.box().size.x[c];
  };
  std::vector<double> sums(2 * species_, 0.0);  // of the squares, and how many
  for (const std::int32_t particle : particles.owned_by_identity()) {
    const auto i = index(particle);
    if (!particles.is_free(i) || !displacements_.begun()) continue;
    const auto kind = index(particles.species[i]);
    sums[species_ + kind] += 1.0;
    for (const int c : msd_.directions) {
      const double path = unwrapped(i, index(c)) - origin[i][c];
      sums[kind] += path * path;
    }
  }
  particles.ranks().sum(std::span(sums));
  const std::span<const double> all(sums);
  if (!displacements_.add_sums(all.first(species_), all.last(species_), msd_.directions.size()))
    return;
  for (std::size_t i = 0; i < origin.size(); ++i)
    for (std::size_t c = 0; c < D; ++c) origin[i].x[c] = unwrapped(i, c);
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
  // The default observer's names carry no prefix: every run has them.
  const std::string prefix = this->settings().name == "msd" ? "" : this->named("");
  const BlockAverage& diffusion = displacements_.diffusion();
  const auto& species = scene_.settings().species;
  results.scalars.push_back(
      {prefix + "diffusion", diffusion.mean(species_), diffusion.standard_error(species_)});
  for (std::size_t a = 0; a < species_ && species_ > 1; ++a)
    results.scalars.push_back(
        {prefix + "diffusion." + species[a].name, diffusion.mean(a), diffusion.standard_error(a)});
  if (displacements_.windows() == 0) {
    results.notes.push_back(
        fmt::format("{}: the measured part is shorter than the window of {}, so no diffusion "
                    "coefficient",
                    this->settings().name, msd_.window));
    return;
  }
  for (std::size_t a = 0; a < species_; ++a)
    if (std::isnan(diffusion.mean(a)))
      results.notes.push_back(fmt::format(
          "{}: displacements and diffusion of '{}' are undefined: it has no free particles",
          this->settings().name, species[a].name));
  std::vector<std::string> names;
  for (const auto& s : species) names.push_back(s.name);
  Table table = displacements_.table(names);
  Chart chart{.title = "Mean-square displacement",
              .x_label = "lag",
              .y_label = "msd / r_c^2",
              .curves = {}};
  for (std::size_t a = 0; a < species_; ++a) {
    Curve curve{.title = names[a], .x = {}, .y = {}, .error = {}};
    for (const std::vector<double>& row : table.rows) {
      curve.x.push_back(row[0]);
      curve.y.push_back(row[1 + 2 * a]);
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
  displacements_.load(in, "", 0);
}

template MsdSettings read_msd<2>(const ObserverEntry<2>&);
template MsdSettings read_msd<3>(const ObserverEntry<3>&);
template class Msd<2>;
template class Msd<3>;

}  // namespace odpd
