#include "odpd/analysis/rdf.h"

#include <fmt/format.h>

#include <cmath>

#include "odpd/analysis/observer_keys.h"
#include "odpd/core/index.h"
#include "odpd/geometry/pair_list.h"

namespace odpd {

namespace {
// Volume of a ball of radius r.
template <int D>
double ball(double r) {
  return unit_ball_volume<D> * std::pow(r, D);
}

// Pairs of species.
template <int D>
std::size_t pairs_of(const Scene<D>& scene) {
  const std::size_t n = scene.settings().species.size();
  return n * (n + 1) / 2;
}
}  // namespace

template <int D>
Rdf<D>::Rdf(ObserverSettings settings, double r_max, std::int64_t bins, const Scene<D>& scene,
            std::optional<RdfComparison> comparison)
    : Observer<D>(std::move(settings), pairs_of(scene) * index(bins)),
      r_max_(r_max),
      bins_(index(bins)),
      scene_(scene),
      species_(scene.settings().species.size()),
      comparison_(comparison) {}

template <int D>
std::unique_ptr<Observer<D>> Rdf<D>::make(const ObserverEntry<D>& entry) {
  ObserverSettings settings = entry.settings(20);
  const Config& config = entry.config;
  const double r_max = read_r_max(entry);
  const std::int64_t bins = config.positive_integer("bins", 100);
  std::optional<RdfComparison> comparison;
  if (config.has("reference")) {
    comparison = {config.number("reference"), config.non_negative("compare_from", 0.0),
                  config.positive("compare_to", r_max)};
    if (comparison->to - comparison->from < r_max / static_cast<double>(bins) ||
        comparison->to > r_max)
      config.fail(
          config.has("compare_to") ? "compare_to" : "compare_from",
          fmt::format("compare_from = {} must be at least a bin below compare_to = {}, and that at "
                      "most r_max = {}, its default",
                      comparison->from, comparison->to, r_max));
  }
  return std::make_unique<Rdf<D>>(std::move(settings), r_max, bins, entry.scene, comparison);
}

template <int D>
std::vector<double> Rdf<D>::factors(const Particles<D>& particles) const {
  const Share own = particles.owned();
  std::vector<double> count(species_, 0.0);
  for (std::size_t i = 0; i < particles.position.size(); ++i)
    if (particles.is_free(i) && own.owns(i)) count[index(particles.species[i])] += 1.0;
  own.ranks->sum(std::span(count));
  const double dr = r_max_ / static_cast<double>(bins_);
  std::vector<double> factor;
  for (std::size_t a = 0; a < species_; ++a)
    for (std::size_t b = a; b < species_; ++b) {
      const double pairs = a == b ? 0.5 * count[a] * (count[a] - 1.0) : count[a] * count[b];
      for (std::size_t k = 0; k < bins_; ++k) {
        const double shell =
            ball<D>(dr * static_cast<double>(k + 1)) - ball<D>(dr * static_cast<double>(k));
        factor.push_back(pairs > 0.0 ? scene_.fluid_volume() / (pairs * shell) : std::nan(""));
      }
    }
  return factor;
}

template <int D>
std::size_t Rdf<D>::pair_index(std::int32_t a, std::int32_t b) const {
  const auto low = index(std::min(a, b));
  const auto high = index(std::max(a, b));
  return low * species_ - low * (low + 1) / 2 + high;  // row-major upper triangle
}

template <int D>
void Rdf<D>::measure(const Clock&, const Particles<D>& particles, const StepRecord<D>& record) {
  const Box<D> box = scene_.box().at(record.start.time);
  PairList<D> list(box, r_max_, 0.0);
  const auto& r = record.start.position;
  list.update(r);
  std::vector<double> sample(this->average().width(), 0.0);
  const Share own = particles.owned();
  for (std::int64_t row = own.first; row < own.end(list.rows()); ++row) {
    const auto i = index(row);
    if (!particles.is_free(i)) continue;
    for (const std::int32_t partner : list.partners(row)) {
      const auto j = index(partner);
      if (!particles.is_free(j)) continue;
      const double distance = norm(box.separation(r[i], r[j]));
      const auto bin = static_cast<std::size_t>(distance / r_max_ * static_cast<double>(bins_));
      if (bin < bins_)
        sample[pair_index(particles.species[i], particles.species[j]) * bins_ + bin] += 1.0;
    }
  }
  own.ranks->sum(std::span(sample));
  // Of the particles given: a restart may bring others than the scene began with.
  const std::vector<double> factor = factors(particles);
  for (std::size_t k = 0; k < sample.size(); ++k) sample[k] *= factor[k];
  this->add(std::move(sample));
}

template <int D>
std::vector<std::string> Rdf<D>::series_columns() const {
  std::vector<std::string> columns;
  const auto& species = scene_.settings().species;
  for (std::size_t a = 0; a < species_; ++a)
    for (std::size_t b = a; b < species_; ++b)
      for (std::size_t k = 0; k < bins_; ++k)
        columns.push_back(fmt::format("g_{}_{}_{}", species[a].name, species[b].name, k));
  return columns;
}

template <int D>
void Rdf<D>::add_results(Results& results) const {
  if (comparison_) add_deviations(results);
  const BlockAverage& average = this->average();
  if (average.samples() == 0) return;
  const auto& species = scene_.settings().species;
  Table table;
  table.comment = {"r: middle of the bin; standard errors by block averaging"};
  if (scene_.box().periodic_directions() < D)
    table.comment.emplace_back(
        "walls: g counts on full shells around every particle, also where a wall cuts them, so it "
        "falls below 1 at large r: compare it with that of the same channel only");
  table.columns = {"r"};
  Chart chart{.title = "Radial distribution function",
              .x_label = "r / r_c",
              .y_label = "g(r)",
              .curves = {}};
  for (std::size_t k = 0; k < bins_; ++k) table.rows.push_back({middle(k)});
  std::size_t column = 0;
  for (std::size_t a = 0; a < species_; ++a)
    for (std::size_t b = a; b < species_; ++b) {
      const std::string pair = species[a].name + "_" + species[b].name;
      if (std::isnan(average.mean(column)))
        results.notes.push_back(fmt::format(
            "{}: g of {} is undefined: there is no pair of free particles of these species",
            this->settings().name, pair));
      table.columns.insert(table.columns.end(), {"g_" + pair, "g_" + pair + "_error"});
      Curve curve{.title = species[a].name + " - " + species[b].name,
                  .x = {},
                  .y = {},
                  .error = {},
                  .line = true,
                  .points = false};
      for (std::size_t k = 0; k < bins_; ++k, ++column) {
        const double g = average.mean(column);
        table.rows[k].insert(table.rows[k].end(), {g, average.standard_error(column)});
        curve.x.push_back(table.rows[k][0]);
        curve.y.push_back(g);
      }
      chart.curves.push_back(std::move(curve));
    }
  results.tables.emplace_back(this->settings().name, std::move(table));
  results.charts.emplace_back(this->settings().name, std::move(chart));
}

template <int D>
void Rdf<D>::add_deviations(Results& results) const {
  const BlockAverage& average = this->average();
  double sum = 0.0, count = 0.0;
  Scalar largest{this->named("largest_deviation"), 0.0};
  for (std::size_t column = 0; column < average.width(); ++column) {
    const double r = middle(column % bins_);
    if (r < comparison_->from || r > comparison_->to) continue;
    const double deviation = std::abs(average.mean(column) - comparison_->value);
    if (std::isnan(deviation)) continue;  // a pair of species that nobody belongs to
    sum += deviation * deviation;
    count += 1.0;
    if (deviation < largest.mean) continue;
    largest.mean = deviation;
    largest.standard_error = average.standard_error(column);
  }
  if (count == 0.0) largest.mean = std::nan("");
  results.scalars.push_back(without_error(this->named("rms_deviation"), std::sqrt(sum / count)));
  results.scalars.push_back(std::move(largest));
}

template class Rdf<2>;
template class Rdf<3>;

}  // namespace odpd
