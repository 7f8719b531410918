#include "odpd/analysis/rdf.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "odpd/analysis/observer_keys.h"
#include "odpd/core/index.h"
#include "odpd/geometry/pair_list.h"
#include "odpd/particles/constituents.h"

namespace odpd {

namespace {
// Volume of a ball of radius r.
template <int D>
double ball(double r) {
  return unit_ball_volume<D> * std::pow(r, D);
}

template <int D>
std::vector<std::string> kinds_of_points(const Scene<D>& scene, bool of_bodies) {
  std::vector<std::string> names;
  for (const BodySettings<D>& body : scene.settings().bodies)
    if (of_bodies) names.push_back(body.name);
  for (const SpeciesSettings& species : scene.settings().species)
    if (!of_bodies) names.push_back(species.name);
  return names;
}

std::size_t pairs_of(std::size_t kinds) { return kinds * (kinds + 1) / 2; }
}  // namespace

template <int D>
Rdf<D>::Rdf(ObserverSettings settings, RdfSettings rdf, const Scene<D>& scene)
    : Observer<D>(std::move(settings),
                  pairs_of(kinds_of_points(scene, rdf.of_bodies).size()) * index(rdf.bins)),
      rdf_(rdf),
      bins_(index(rdf.bins)),
      scene_(scene),
      names_(kinds_of_points(scene, rdf.of_bodies)) {}

template <int D>
std::unique_ptr<Observer<D>> Rdf<D>::make(const ObserverEntry<D>& entry) {
  ObserverSettings settings = entry.settings(20);
  const Config& config = entry.config;
  RdfSettings rdf;
  rdf.of_bodies = config.choice("of", {"particles", "bodies"}, "particles") == "bodies";
  rdf.r_max = read_r_max(entry, rdf.of_bodies);
  rdf.bins = config.positive_integer("bins", rdf.bins);
  if (rdf.of_bodies && entry.scene.settings().bodies.empty())
    config.fail("of", "the scene has no [[body]] whose centres could count: leave `of` out");
  if (config.has("reference")) {
    std::optional<RdfComparison>& comparison = rdf.comparison;
    comparison = {config.number("reference"), config.non_negative("compare_from", 0.0),
                  config.positive("compare_to", rdf.r_max)};
    if (comparison->to - comparison->from < rdf.r_max / static_cast<double>(rdf.bins) ||
        comparison->to > rdf.r_max)
      config.fail(
          config.has("compare_to") ? "compare_to" : "compare_from",
          fmt::format("compare_from = {} must be at least a bin below compare_to = {}, and that at "
                      "most r_max = {}, its default",
                      comparison->from, comparison->to, rdf.r_max));
  }
  return std::make_unique<Rdf<D>>(std::move(settings), rdf, entry.scene);
}

template <int D>
typename Rdf<D>::Points Rdf<D>::points(const Particles<D>& particles, const Stage<D>& stage) const {
  Points points;
  if (rdf_.of_bodies) {
    const Constituents members(particles);
    for (std::size_t b = 0; b < particles.bodies.size(); ++b) {
      const auto first = index(members[b][0]);
      points.place.push_back(stage.position[first] - stage.arms[first]);
      stage.box.wrap(points.place.back());
      points.kind.push_back(static_cast<std::int32_t>(scene_.body_kind(b)));
    }
    // Every rank knows all centres.
    points.counted_to = particles.ranks().rank() == 0 ? std::ssize(points.place) : 0;
    return points;
  }
  points.place = stage.position;
  for (std::size_t i = 0; i < stage.position.size(); ++i)
    points.kind.push_back(particles.is_free(i) ? particles.species[i] : -1);
  const Share own = particles.owned();
  points.counted_from = own.first;
  points.counted_to = own.end(std::ssize(points.place));
  return points;
}

template <int D>
std::vector<double> Rdf<D>::factors(const Points& points, const Communicator& ranks) const {
  const std::size_t kinds = names_.size();
  std::vector<double> count(kinds, 0.0);
  for (std::int64_t i = points.counted_from; i < points.counted_to; ++i)
    if (points.kind[index(i)] >= 0) count[index(points.kind[index(i)])] += 1.0;
  ranks.sum(std::span(count));
  const double dr = rdf_.r_max / static_cast<double>(bins_);
  std::vector<double> factor;
  for (std::size_t a = 0; a < kinds; ++a)
    for (std::size_t b = a; b < kinds; ++b) {
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
  return low * names_.size() - low * (low + 1) / 2 + high;  // row-major upper triangle
}

template <int D>
void Rdf<D>::measure(const Clock&, const Particles<D>& particles, const StepRecord<D>& record) {
  const Box<D> box = scene_.box().at(record.start.time);
  // Of the particles given: a restart may bring others than the scene began with.
  const Points points = this->points(particles, record.start);
  PairList<D> list(box, rdf_.r_max, 0.0);
  list.update(points.place);
  std::vector<double> sample(this->average().width(), 0.0);
  for (std::int64_t row = points.counted_from; row < std::min(points.counted_to, list.rows());
       ++row) {
    const std::int32_t a = points.kind[index(row)];
    if (a < 0) continue;
    for (const std::int32_t partner : list.partners(row)) {
      const std::int32_t b = points.kind[index(partner)];
      if (b < 0) continue;
      const double distance =
          norm(box.separation(points.place[index(row)], points.place[index(partner)]));
      const auto bin = static_cast<std::size_t>(distance / rdf_.r_max * static_cast<double>(bins_));
      if (bin < bins_) sample[pair_index(a, b) * bins_ + bin] += 1.0;
    }
  }
  particles.ranks().sum(std::span(sample));
  const std::vector<double> factor = factors(points, particles.ranks());
  for (std::size_t k = 0; k < sample.size(); ++k) sample[k] *= factor[k];
  this->add(std::move(sample));
}

template <int D>
std::vector<std::string> Rdf<D>::series_columns() const {
  std::vector<std::string> columns;
  for (std::size_t a = 0; a < names_.size(); ++a)
    for (std::size_t b = a; b < names_.size(); ++b)
      for (std::size_t k = 0; k < bins_; ++k)
        columns.push_back(fmt::format("g_{}_{}_{}", names_[a], names_[b], k));
  return columns;
}

template <int D>
void Rdf<D>::add_results(Results& results) const {
  if (rdf_.comparison) add_deviations(results);
  const BlockAverage& average = this->average();
  if (average.samples() == 0) return;
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
  for (std::size_t a = 0; a < names_.size(); ++a)
    for (std::size_t b = a; b < names_.size(); ++b) {
      const std::string pair = names_[a] + "_" + names_[b];
      if (std::isnan(average.mean(column)))
        results.notes.push_back(
            fmt::format("{}: g of {} is undefined: there is no pair of {}", this->settings().name,
                        pair, rdf_.of_bodies ? "these bodies" : "free particles of these species"));
      table.columns.insert(table.columns.end(), {"g_" + pair, "g_" + pair + "_error"});
      Curve curve{.title = names_[a] + " - " + names_[b],
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
    if (r < rdf_.comparison->from || r > rdf_.comparison->to) continue;
    const double deviation = std::abs(average.mean(column) - rdf_.comparison->value);
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
