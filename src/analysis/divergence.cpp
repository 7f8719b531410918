#include "odpd/analysis/divergence.h"

#include <fmt/format.h>

#include <cmath>

#include "odpd/analysis/observer_keys.h"
#include "odpd/core/index.h"

namespace odpd {

template <int D>
Divergence<D>::Divergence(ObserverSettings settings, const typename Grid<D>::Counts& cells,
                          const Scene<D>& scene)
    : Observer<D>(std::move(settings), Grid<D>(cells, scene).cells() * (D + 1)),
      scene_(scene),
      grid_(cells, scene) {}

template <int D>
std::unique_ptr<Observer<D>> Divergence<D>::make(const ObserverEntry<D>& entry) {
  ObserverSettings settings = entry.settings();
  if (entry.scene.box().shear)
    entry.config.fail("kind",
                      "under [shear] neighbouring cells of two images slide past each other: use "
                      "walls, or a profile");
  const auto cells = read_cells(entry, 3.0);
  for (const std::int64_t count : cells)
    if (count < 3)
      entry.config.fail("bins", "differences need at least 3 cells in every direction");
  return std::make_unique<Divergence<D>>(std::move(settings), cells, entry.scene);
}

template <int D>
void Divergence<D>::measure(const Clock&, const Particles<D>& particles,
                            const StepRecord<D>& record) {
  std::vector<double> sample(this->average().width(), 0.0);
  const Share own = particles.owned();
  for (std::size_t i = 0; i < record.v_mid.size(); ++i) {
    if (!particles.is_free(i) || !own.owns(i)) continue;
    Vec<D> middle = record.start.position[i] + (0.5 * record.dt) * record.v_mid[i];
    scene_.box().wrap(middle);
    const std::size_t cell = grid_.cell_of(middle);
    sample[column(cell, 0)] += 1.0;
    for (std::size_t c = 0; c < D; ++c) sample[column(cell, c + 1)] += record.v_mid[i].x[c];
  }
  own.ranks->sum(std::span(sample));
  this->add(std::move(sample));
}

template <int D>
void Divergence<D>::add_derivative(std::size_t cell, int a, int b, Terms& terms) const {
  const std::int64_t n = grid_.count(a), at = grid_.coordinate(cell, a);
  std::int64_t below = at - 1, above = at + 1;
  double width = 2.0 * grid_.spacing(a);
  if (scene_.box().is_periodic(a)) {
    below = (below + n) % n;
    above %= n;
  } else if (below < 0 || above >= n) {
    below = std::max<std::int64_t>(below, 0);
    above = std::min(above, n - 1);
    width = grid_.spacing(a);
  }
  const auto neighbour = [&](std::int64_t place) {
    return index(static_cast<std::int64_t>(cell) + (place - at) * grid_.stride(a));
  };
  const auto k = index(b) + 1;
  terms.push_back({1.0 / width, column(neighbour(above), k), column(neighbour(above), 0)});
  terms.push_back({-1.0 / width, column(neighbour(below), k), column(neighbour(below), 0)});
}

template <int D>
auto Divergence<D>::divergence_at(std::size_t cell) const -> Terms {
  Terms terms;
  for (int c = 0; c < D; ++c) add_derivative(cell, c, c, terms);
  return terms;
}

template <int D>
bool Divergence<D>::every_cell_was_visited() const {
  for (std::size_t cell = 0; cell < grid_.cells(); ++cell)
    if (this->average().mean(column(cell, 0)) == 0.0) return false;
  return true;
}

template <int D>
void Divergence<D>::add_results(Results& results) const {
  const BlockAverage& average = this->average();
  const std::size_t cells = grid_.cells();
  if (!every_cell_was_visited())
    results.notes.push_back(
        fmt::format("{}: a cell never held a particle, so no divergence: use fewer bins",
                    this->settings().name));
  const auto value = [&](const Terms& terms, const auto& mean) {
    double sum = 0.0;
    for (const auto& t : terms) sum += t.weight * mean(t.numerator) / mean(t.denominator);
    return sum;
  };
  const auto measured = [&](std::size_t k) { return average.mean(k); };
  double rms = 0.0, noise = 0.0, gradient = 0.0;
  for (std::size_t cell = 0; cell < cells; ++cell) {
    const Terms divergence = divergence_at(cell);
    rms += std::pow(value(divergence, measured), 2) / static_cast<double>(cells);
    noise += std::pow(average.ratio_error(divergence), 2) / static_cast<double>(cells);
    for (int a = 0; a < D; ++a)
      for (int b = 0; b < D; ++b) {
        Terms terms;
        add_derivative(cell, a, b, terms);
        gradient +=
            (std::pow(value(terms, measured), 2) - std::pow(average.ratio_error(terms), 2)) /
            static_cast<double>(cells);
      }
  }
  const double error = average.jackknife_error([&](const std::vector<double>& means) {
    double sum = 0.0;
    for (std::size_t cell = 0; cell < cells; ++cell)
      sum += std::pow(value(divergence_at(cell), [&](std::size_t k) { return means[k]; }), 2);
    return std::sqrt(sum / static_cast<double>(cells));
  });
  const double nan = std::nan("");
  // Without a flow there is nothing to compare with.
  const double norm = gradient > 0.0 ? std::sqrt(gradient) : nan;
  results.scalars.push_back({this->named("rms"), std::sqrt(rms), error});
  results.scalars.push_back(without_error(this->named("noise"), std::sqrt(noise)));
  results.scalars.push_back(without_error(this->named("gradient"), norm));
  results.scalars.push_back({this->named("relative"),
                             std::isnan(noise) ? nan : std::sqrt(std::max(rms - noise, 0.0)) / norm,
                             error / norm});
}

template <int D>
std::vector<std::string> Divergence<D>::series_columns() const {
  std::vector<std::string> columns;
  for (std::size_t cell = 0; cell < grid_.cells(); ++cell) {
    columns.push_back(fmt::format("count_{}", cell));
    for (int c = 0; c < D; ++c) columns.push_back(fmt::format("v_{}_sum_{}", "xyz"[c], cell));
  }
  return columns;
}

template class Divergence<2>;
template class Divergence<3>;

}  // namespace odpd
