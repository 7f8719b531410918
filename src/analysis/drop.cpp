#include "odpd/analysis/drop.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "odpd/core/index.h"
#include "odpd/core/parallel.h"

namespace odpd {

namespace {

// Of the line x - s arm, 0 <= s <= 1, the part within this radius of the origin.
template <int D>
double part_inside(const Vec<D>& x, const Vec<D>& arm, double radius) {
  const double along = dot(x, arm), length2 = dot(arm, arm);
  const double root = along * along - length2 * (dot(x, x) - radius * radius);
  if (!(root > 0.0) || length2 == 0.0) return 0.0;
  const double from = std::max(0.0, (along - std::sqrt(root)) / length2),
               to = std::min(1.0, (along + std::sqrt(root)) / length2);
  return std::max(0.0, to - from);
}

}  // namespace

template <int D>
Vec<D> centre_of_mass(const Box<D>& box, const Particles<D>& particles,
                      const std::vector<Vec<D>>& positions) {
  const Share own = particles.owned();
  const auto sum_of = [&](auto&& value) {
    Vec<D> sum{};
    for (std::size_t i = 0; i < positions.size(); ++i)
      if (particles.is_free(i) && own.owns(i)) sum += value(positions[i]);
    own.ranks->sum(std::span(sum.x));
    return sum;
  };
  Vec<D> turn{}, sines{}, cosines{}, centre{};
  for (int c = 0; c < D; ++c) turn[c] = 2.0 * std::numbers::pi / box.size[c];
  sines = sum_of([&](Vec<D> r) {
    for (int c = 0; c < D; ++c) r[c] = std::sin(turn[c] * r[c]);
    return r;
  });
  cosines = sum_of([&](Vec<D> r) {
    for (int c = 0; c < D; ++c) r[c] = std::cos(turn[c] * r[c]);
    return r;
  });
  for (int c = 0; c < D; ++c) centre[c] = std::atan2(sines[c], cosines[c]) / turn[c];
  const double share = 1.0 / static_cast<double>(particles.free_count());
  constexpr int rounds = 5;  // each moves it by what nearest images changed in the last
  for (int round = 0; round < rounds; ++round) {
    box.wrap(centre);
    const Vec<D> from = centre;
    centre += share * sum_of([&](const Vec<D>& r) { return box.separation(r, from); });
  }
  box.wrap(centre);
  return centre;
}

template <int D>
Drop<D>::Drop(ObserverSettings settings, DropSettings drop, const Scene<D>& scene)
    : Observer<D>(std::move(settings),
                  first_bin + static_cast<std::size_t>(std::llround(drop.r_max / drop.bin))),
      drop_(drop),
      scene_(scene),
      bins_(this->average().width() - first_bin) {}

template <int D>
std::unique_ptr<Observer<D>> Drop<D>::make(const ObserverEntry<D>& entry) {
  const Box<D>& box = entry.scene.box();
  const Config& config = entry.config;
  if (box.periodic_directions() < D || box.shear)
    config.fail("kind",
                "takes a drop in a periodic box at rest; one on a wall is for contact-angle");
  ObserverSettings settings = entry.settings(5);
  const double most = 0.5 * *std::min_element(box.size.x.begin(), box.size.x.end());
  DropSettings drop;
  drop.core = config.positive("core");
  drop.r_max = config.positive("r_max", most);
  if (drop.r_max > most)
    config.fail("r_max",
                fmt::format("must be at most half the shortest edge of the box, {}", most));
  if (drop.core > 0.75 * drop.r_max)
    config.fail("core", fmt::format("must end within the drop, before {}, 3/4 of r_max, from where "
                                    "on there is vapour",
                                    0.75 * drop.r_max));
  drop.bin = config.positive("bin", drop.bin);
  if (drop.bin > 0.25 * drop.r_max)
    config.fail("bin", fmt::format("must be at most a quarter of r_max = {}", drop.r_max));
  return std::make_unique<Drop<D>>(std::move(settings), drop, entry.scene);
}

template <int D>
double Drop<D>::shell(std::size_t bin) const {
  return unit_ball_volume<D> * (std::pow(edge(bin + 1), D) - std::pow(edge(bin), D));
}

template <int D>
void Drop<D>::measure(const Clock&, const Particles<D>& particles, const StepRecord<D>& record) {
  const Stage<D>& stage = record.start;
  const PairNetwork<D>& network = stage.network;
  const Share own = particles.owned();
  const Vec<D> centre = centre_of_mass(stage.box, particles, stage.position);
  std::vector<double> sample(first_bin + bins_, 0.0), virial(index(network.size()));
  std::vector<Vec<D>> from_centre(stage.position.size());
  for (std::size_t i = 0; i < from_centre.size(); ++i) {
    from_centre[i] = stage.box.separation(stage.position[i], centre);
    if (!particles.is_free(i) || !own.owns(i)) continue;
    const double q = norm(from_centre[i]);
    if (q < drop_.core) sample[core_density] += 1.0;
    if (const auto bin = static_cast<std::size_t>(q / drop_.bin); bin < bins_)
      sample[first_bin + bin] += 1.0;
  }
  for (std::size_t k = 0; k < virial.size(); ++k) {
    if (!network.counts(k)) continue;
    const Vec<D> arm = network.r[k] * network.e[k];
    virial[k] =
        part_inside(from_centre[index(network.i[k])], arm, drop_.core) * dot(arm, network.push(k));
  }
  sample[core_pressure] = fixed_sum(virial) / D;
  own.ranks->sum(std::span(sample));
  sample[core_pressure] += sample[core_density] * scene_.largest_kT();
  sample[core_density] /= core_volume();
  sample[core_pressure] /= core_volume();
  for (std::size_t b = 0; b < bins_; ++b) sample[first_bin + b] /= shell(b);
  this->add(std::move(sample));
}

template <int D>
double Drop<D>::vapour(const std::vector<double>& means) const {
  double count = 0.0, volume = 0.0;
  for (std::size_t b = 0; b < bins_; ++b) {
    if (edge(b) < 0.75 * edge(bins_)) continue;
    count += means[first_bin + b] * shell(b);
    volume += shell(b);
  }
  return count / volume;
}

template <int D>
double Drop<D>::radius(const std::vector<double>& means) const {
  const double outside = vapour(means);
  double excess = 0.0;
  for (std::size_t b = 0; b < bins_; ++b) excess += (means[first_bin + b] - outside) * shell(b);
  return std::pow(excess / (unit_ball_volume<D> * (means[core_density] - outside)), 1.0 / D);
}

template <int D>
double Drop<D>::laplace(const std::vector<double>& means) const {
  return radius(means) * (means[core_pressure] - vapour(means) * scene_.largest_kT()) / (D - 1);
}

template <int D>
void Drop<D>::add_results(Results& results) const {
  const BlockAverage& average = this->average();
  std::vector<double> means;
  for (std::size_t k = 0; k < average.width(); ++k) means.push_back(average.mean(k));
  results.scalars.push_back(this->mean_of(core_density, this->named("core_density")));
  results.scalars.push_back(this->mean_of(core_pressure, this->named("core_pressure")));
  const auto add = [&](const char* name, double (Drop::*value)(const std::vector<double>&) const) {
    const auto of = [&](const std::vector<double>& m) { return (this->*value)(m); };
    results.scalars.push_back({this->named(name), of(means), average.jackknife_error(of)});
  };
  add("vapour_density", &Drop::vapour);
  add("equimolar_radius", &Drop::radius);
  add("laplace", &Drop::laplace);
  if (average.samples() == 0) return;
  Table table;
  table.comment = {"density at distance q from the drop's centre of mass"};
  table.columns = {"q", "density", "density_error"};
  Curve curve{.title = "density", .x = {}, .y = {}, .error = {}};
  for (std::size_t b = 0; b < bins_; ++b) {
    table.rows.push_back({0.5 * (edge(b) + edge(b + 1)), means[first_bin + b],
                          average.standard_error(first_bin + b)});
    curve.x.push_back(table.rows.back()[0]);
    curve.y.push_back(table.rows.back()[1]);
    curve.error.push_back(table.rows.back()[2]);
  }
  results.tables.emplace_back(this->settings().name, std::move(table));
  results.charts.emplace_back(this->settings().name, Chart{.title = "Density of the drop",
                                                           .x_label = "q / r_c",
                                                           .y_label = "density",
                                                           .curves = {std::move(curve)}});
}

template <int D>
std::vector<std::string> Drop<D>::series_columns() const {
  return {"core_density", "core_pressure"};
}

template <int D>
std::vector<double> Drop<D>::series_row() const {
  const std::vector<double>& newest = this->newest();
  if (newest.empty()) return {};
  return {newest[core_density], newest[core_pressure]};
}

template Vec<2> centre_of_mass<2>(const Box<2>&, const Particles<2>&, const std::vector<Vec<2>>&);
template Vec<3> centre_of_mass<3>(const Box<3>&, const Particles<3>&, const std::vector<Vec<3>>&);
template class Drop<2>;
template class Drop<3>;

}  // namespace odpd
