#include "odpd/analysis/angular_displacement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "odpd/analysis/msd.h"
#include "odpd/core/index.h"
#include "odpd/core/rotation.h"

namespace odpd {

namespace {

std::vector<std::size_t> spinning(const std::vector<SpeciesSettings>& species) {
  std::vector<std::size_t> found;
  for (std::size_t a = 0; a < species.size(); ++a)
    if (species[a].lever_radius > 0.0) found.push_back(a);
  return found;
}

}  // namespace

template <int D>
AngularDisplacement<D>::AngularDisplacement(ObserverSettings settings, const LagRange& lags,
                                            std::int64_t steps, const Scene<D>& scene, double dt)
    : Observer<D>(std::move(settings)),
      window_(lags.window),
      dt_(dt),
      steps_(steps),
      scene_(scene),
      species_(spinning(scene.settings().species)),
      displacements_(this->settings().name, lags.window, lags.fit_from,
                     dt * static_cast<double>(steps), species_.size()) {
  scene.particles().carry(column());
}

template <int D>
std::unique_ptr<Observer<D>> AngularDisplacement<D>::make(const ObserverEntry<D>& entry) {
  const Config& config = entry.config;
  if (spinning(entry.scene.settings().species).empty())
    config.fail("kind",
                "angular displacements are those of particles that spin, and no species has a "
                "lever_radius");
  ObserverSettings settings = entry.settings();
  if (settings.every != 1)
    config.fail("every", "angular velocities are summed up, so every step counts: leave it out");
  return std::make_unique<AngularDisplacement<D>>(std::move(settings), read_lags(config),
                                                  msd_interval(entry.clock), entry.scene,
                                                  entry.clock.dt);
}

template <int D>
void AngularDisplacement<D>::measure(const Clock&, const Particles<D>& particles,
                                     const StepRecord<D>& record) {
  constexpr auto turns = index(rotation_components<D>);
  std::vector<Vec<D>>& angle = particles.carry(column());
  for (std::size_t i = 0; i < record.w_mid.size(); ++i) angle[i] += dt_ * record.w_mid[i];
  if (++taken_ < steps_ && displacements_.begun()) return;
  taken_ = 0;
  const std::size_t kinds = species_.size();
  std::vector<double> sums(2 * kinds, 0.0);  // of the squares, and how many
  for (const std::int32_t particle : particles.owned_by_identity()) {
    const auto i = index(particle);
    if (!particles.spins(i) || !displacements_.begun()) continue;
    const auto at = std::find(species_.begin(), species_.end(), index(particles.species[i]));
    const auto kind = index(at - species_.begin());
    sums[kinds + kind] += 1.0;
    for (std::size_t c = 0; c < turns; ++c) sums[kind] += angle[i].x[c] * angle[i].x[c];
  }
  particles.ranks().sum(std::span(sums));
  const std::span<const double> all(sums);
  if (displacements_.add_sums(all.first(kinds), all.last(kinds), turns))
    std::fill(angle.begin(), angle.end(), Vec<D>{});
}

template <int D>
std::vector<std::string> AngularDisplacement<D>::series_columns() const {
  std::vector<std::string> columns;
  for (const std::size_t a : species_)
    columns.push_back("diffusion_" + scene_.settings().species[a].name);
  columns.push_back("diffusion");
  return columns;
}

template <int D>
void AngularDisplacement<D>::add_results(Results& results) const {
  const BlockAverage& diffusion = displacements_.diffusion();
  const std::size_t kinds = species_.size();
  results.scalars.push_back(
      {this->named("diffusion"), diffusion.mean(kinds), diffusion.standard_error(kinds)});
  for (std::size_t k = 0; k < kinds && kinds > 1; ++k)
    results.scalars.push_back(
        {this->named("diffusion." + scene_.settings().species[species_[k]].name), diffusion.mean(k),
         diffusion.standard_error(k)});
  if (displacements_.windows() == 0) {
    results.notes.push_back(
        fmt::format("{}: the measured part is shorter than the window of {}, so no rotational "
                    "diffusion coefficient",
                    this->settings().name, window_));
    return;
  }
  std::vector<std::string> names;
  for (const std::size_t a : species_) names.push_back(scene_.settings().species[a].name);
  results.tables.emplace_back(this->settings().name, displacements_.table(names));
}

template <int D>
void AngularDisplacement<D>::save(StateWriter& out) const {
  out.write("taken", std::vector<std::int64_t>{taken_});
  displacements_.save(out, "");
}

template <int D>
void AngularDisplacement<D>::load(const StateReader& in) {
  taken_ = in.read_integers("taken").at(0);
  displacements_.load(in, "", 0);
}

template class AngularDisplacement<2>;
template class AngularDisplacement<3>;

}  // namespace odpd
