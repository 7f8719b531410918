#include "odpd/analysis/stress.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "odpd/analysis/fluid_region.h"
#include "odpd/analysis/force_points.h"
#include "odpd/analysis/observer_keys.h"
#include "odpd/core/index.h"
#include "odpd/core/parallel.h"
#include "odpd/operator/edge_sums.h"

namespace odpd {

// (Captured by lambdas, so not in the anonymous namespace.)
// Adds tensors that live on lines or points to the region and its bins, all as sums of r (x) F (volume not divided out).
template <int D>
class StressGrid {
 public:
  StressGrid(const Scene<D>& scene, const StressBins& bins)
      : box_(scene.box()), region_(scene), bins_(bins) {}

  std::size_t width() const { return (stress_parts + index(bins_.bins)) * D * D; }
  // a (x) b on the line from r to r - arm (r inside the box, arm to the nearest image).
  void add_line(StressPart part, const Vec<D>& r, const Vec<D>& arm, const Vec<D>& a,
                const Vec<D>& b, double* sum) const {
    const auto [from, to] = region_.inside(r, arm);
    if (!(to > from)) return;
    add(part * D * D, to - from, a, b, sum);
    if (bins_.bins == 0) return;
    const double begin = scaled(r) - from * slope(arm), end = scaled(r) - to * slope(arm);
    const double first = std::floor(std::min(begin, end)), last = std::floor(std::max(begin, end));
    if (first == last) {
      add(bin_at(first), to - from, a, b, sum);
      return;
    }
    for (double bin = first; bin <= last; bin += 1.0) {
      const double inside =
          std::min(std::max(begin, end), bin + 1.0) - std::max(std::min(begin, end), bin);
      add(bin_at(bin), (to - from) * inside / std::abs(end - begin), a, b, sum);
    }
  }
  // a (x) b at r.
  void add_point(StressPart part, const Vec<D>& r, const Vec<D>& a, const Vec<D>& b,
                 double* sum) const {
    if (!region_.holds(r)) return;
    add(part * D * D, 1.0, a, b, sum);
    if (bins_.bins > 0) add(bin_at(std::floor(scaled(r))), 1.0, a, b, sum);
  }

 private:
  // Coordinate along the axis in bins.
  double slope(const Vec<D>& arm) const {
    return arm[bins_.axis] / extent() * static_cast<double>(bins_.bins);
  }
  double scaled(const Vec<D>& r) const {
    return (r[bins_.axis] - region_.low()[bins_.axis]) / extent() * static_cast<double>(bins_.bins);
  }
  double extent() const { return region_.high()[bins_.axis] - region_.low()[bins_.axis]; }
  // Lines leave the box by periodic images; rounding may put the end of a clipped one outside.
  std::size_t bin_at(double bin) const {
    auto b = static_cast<std::int64_t>(bin);
    if (box_.is_periodic(bins_.axis)) b = (b % bins_.bins + bins_.bins) % bins_.bins;
    b = std::clamp<std::int64_t>(b, 0, bins_.bins - 1);
    return (stress_parts + index(b)) * D * D;
  }
  void add(std::size_t at, double weight, const Vec<D>& a, const Vec<D>& b, double* sum) const {
    for (int row = 0; row < D; ++row)
      for (int col = 0; col < D; ++col) sum[at++] += weight * a[row] * b[col];
  }

  const Box<D>& box_;
  FluidRegion<D> region_;
  StressBins bins_;
};

namespace {

// sum += item(k, partial sum) over 0 <= k < n, in fixed blocks.
template <class Item>
void add_in_blocks(std::size_t n, std::size_t width, const Item& item, std::vector<double>& sum) {
  constexpr std::int64_t length = 4096;
  const auto count = static_cast<std::int64_t>(n);
  std::vector<double> blocks(index((count + length - 1) / length) * width, 0.0);
  parallel_ranges(count, length, [&](std::int64_t begin, std::int64_t end) {
    double* const block = blocks.data() + index(begin / length) * width;
    for (auto k = index(begin); k < index(end); ++k) item(k, block);
  });
  for (std::size_t k = 0; k < blocks.size(); ++k) sum[k % width] += blocks[k];
}

template <int D>
void add_stage_stress(const StressGrid<D>& grid, const ForcePoints<D>& points,
                      const Stage<D>& stage, double weight, std::vector<double>& sum) {
  const PairNetwork<D>& network = stage.network;
  const auto edge = [&](std::size_t k, double* into) {
    if (!network.counts(k)) return;
    const Vec<D> r = points.at(index(network.i[k]));
    const Vec<D> arm = points.between(network, k);
    const Vec<D> push = network.push(k);
    if (push != Vec<D>{}) grid.add_line(conservative_part, r, arm, arm, weight * push, into);
    grid.add_line(friction_part, r, arm, arm,
                  weight * friction_of<D>(network, k, network.slip(k, stage.velocity, stage.spin)),
                  into);
  };
  add_in_blocks(network.i.size(), grid.width(), edge, sum);
}

// N kT I, or with mass sum m v v; a body is one particle at its centre.
template <int D>
void add_kinetic(const StressGrid<D>& grid, const ForcePoints<D>& points, const Scene<D>& scene,
                 const Particles<D>& particles, const StepRecord<D>& record, double* sum) {
  const double mass = scene.settings().mass;
  const bool moving = mass > 0.0 && !record.v_start.empty();
  const auto add = [&](const Vec<D>& r, double m, Vec<D> v) {
    if (moving) {
      v -= record.start.box.flow_velocity(r);
      grid.add_point(kinetic_part, r, m * v, v, sum);
      return;
    }
    for (int c = 0; c < D; ++c) {
      Vec<D> unit{};
      unit[c] = 1.0;
      grid.add_point(kinetic_part, r, scene.largest_kT() * unit, unit, sum);
    }
  };
  const Share own = particles.owned();
  for (std::size_t i = 0; i < particles.group.size(); ++i)
    if (particles.is_free(i) && own.owns(i))
      add(points.at(i), mass, moving ? record.v_start[i] : Vec<D>{});
  if (particles.bodies.empty()) return;
  const std::vector<std::int32_t> at = particles.index_of_id();
  for (const RigidBody<D>& body : particles.bodies) {
    if (body.known) continue;
    const auto n = static_cast<double>(body.members.size());
    Vec<D> v{};
    for (const std::int64_t id : body.members)
      if (moving) v += (1.0 / n) * record.v_start[index(at[index(id)])];
    const auto first = index(at[index(body.members[0])]);
    if (!own.owns(first)) continue;
    if (const Box<D>& box = record.start.box; moving && box.shear)
      v[box.shear->flow] -= record.start.crossed[first] * box.sliding;
    add(points.at(first), mass * n, v);
  }
}

}  // namespace

template <int D>
std::vector<double> stress_of(const Scene<D>& scene, const Particles<D>& particles,
                              const StepRecord<D>& record, const StressBins& bins) {
  const StressGrid<D> grid(scene, bins);
  std::vector<double> sum(grid.width(), 0.0);
  const Stage<D>& start = record.start;
  const ForcePoints<D> points(particles, start);
  add_kinetic(grid, points, scene, particles, record, sum.data());
  // Monte Carlo has edges and no velocities.
  if (start.velocity.size() == start.position.size() && record.start_weight > 0.0)
    add_stage_stress(grid, points, start, record.start_weight, sum);
  if (record.has_corrector())
    add_stage_stress(grid, ForcePoints<D>(particles, record.corrector), record.corrector,
                     1.0 - record.start_weight, sum);
  const auto noise = [&](std::size_t k, double* into) {
    if (!start.network.counts(k)) return;
    const Vec<D> arm = points.between(start.network, k);
    grid.add_line(noise_part, points.at(index(start.network.i[k])), arm, arm, record.edge_noise[k],
                  into);
  };
  add_in_blocks(record.edge_noise.size(), grid.width(), noise, sum);
  particles.ranks().sum(std::span(sum));

  const double volume = scene.fluid_volume();
  const double per_bin = static_cast<double>(std::max<std::int64_t>(bins.bins, 1)) / volume;
  for (std::size_t k = 0; k < sum.size(); ++k)
    sum[k] *= k < stress_parts * D * D ? -1.0 / volume : -per_bin;
  return sum;
}

template <int D>
Stress<D>::Stress(ObserverSettings settings, StressBins bins, const Scene<D>& scene)
    : Observer<D>(std::move(settings), bin_column + index(bins.bins) * components),
      bins_(bins),
      scene_(scene) {}

template <int D>
std::unique_ptr<Observer<D>> Stress<D>::make(const ObserverEntry<D>& entry) {
  ObserverSettings settings = entry.settings();
  StressBins bins;
  bins.bins = entry.config.integer("bins", 0);
  if (bins.bins < 0) entry.config.fail("bins", "must be zero (none) or positive");
  if (bins.bins > 0) bins.axis = read_axis(entry);
  return std::make_unique<Stress<D>>(std::move(settings), bins, entry.scene);
}

template <int D>
void Stress<D>::measure(const Clock&, const Particles<D>& particles, const StepRecord<D>& record) {
  const std::vector<double> stress = stress_of(scene_, particles, record, bins_);
  one_stage_ = one_stage_ || (scene_.settings().mass == 0.0 && !record.has_corrector() &&
                              !record.edge_noise.empty());
  std::vector<double> sample(this->average().width(), 0.0);
  std::copy(stress.begin(), stress.begin() + total_column, sample.begin());
  for (std::size_t part = 0; part < stress_parts; ++part)
    for (std::size_t k = 0; k < components; ++k) {
      const double value = stress[part * components + k];
      sample[total_column + k] += value;
      if (k % (D + 1) != 0) continue;
      sample[pressure_column] -= value / D;
      sample[pressure_column + 1 + part] -= value / D;
    }
  std::copy(stress.begin() + total_column, stress.end(), sample.begin() + bin_column);
  this->add(std::move(sample));
}

template <int D>
std::vector<std::string> Stress<D>::series_columns() const {
  std::vector<std::string> columns;
  for (int row = 0; row < D; ++row)
    for (int col = 0; col < D; ++col)
      columns.push_back(fmt::format("{}{}", "xyz"[row], "xyz"[col]));
  columns.insert(columns.end(), {"pressure", "pressure_kinetic", "pressure_conservative",
                                 "pressure_friction", "pressure_noise"});
  return columns;
}

template <int D>
std::vector<double> Stress<D>::series_row() const {
  const std::vector<double>& newest = this->newest();
  if (newest.empty()) return {};
  return {newest.begin() + total_column, newest.begin() + bin_column};
}

template <int D>
void Stress<D>::add_profile(Results& results) const {
  Table table;
  table.comment = {"stress by bins, tension positive; standard errors by block averaging"};
  table.columns = {std::string(1, "xyz"[bins_.axis])};
  const std::vector<std::string> names = series_columns();
  for (std::size_t k = 0; k < components; ++k)
    table.columns.insert(table.columns.end(), {"s_" + names[k], "s_" + names[k] + "_error"});
  const double low = scene_.fluid_low()[bins_.axis], high = scene_.fluid_high()[bins_.axis];
  for (std::int64_t b = 0; b < bins_.bins; ++b) {
    std::vector<double> row{low + (high - low) * (static_cast<double>(b) + 0.5) /
                                      static_cast<double>(bins_.bins)};
    for (std::size_t k = 0; k < components; ++k) {
      const std::size_t column = bin_column + index(b) * components + k;
      row.insert(row.end(), {this->average().mean(column), this->average().standard_error(column)});
    }
    table.rows.push_back(std::move(row));
  }
  Chart chart{
      .title = "Stress", .x_label = table.columns[0] + " / r_c", .y_label = "stress", .curves = {}};
  for (std::size_t k = 0; k < components; ++k) {
    if (k / D >= k % D) continue;
    Curve curve{.title = names[k], .x = {}, .y = {}, .error = {}};
    for (const auto& row : table.rows) {
      curve.x.push_back(row[0]);
      curve.y.push_back(row[1 + 2 * k]);
      curve.error.push_back(row[2 + 2 * k]);
    }
    chart.curves.push_back(std::move(curve));
  }
  results.tables.emplace_back(this->settings().name, std::move(table));
  results.charts.emplace_back(this->settings().name, std::move(chart));
}

template <int D>
void Stress<D>::add_results(Results& results) const {
  const std::vector<std::string> names = series_columns();
  for (std::size_t k = 0; k < names.size(); ++k) {
    std::string label = names[k];
    std::replace(label.begin(), label.end(), '_', '.');
    results.scalars.push_back(this->mean_of(total_column + k, this->named(label)));
  }
  if (one_stage_)
    results.notes.push_back(fmt::format(
        "{}: this integrator has no second stage, so the friction stress is that before the motion "
        "alone, some per cent off at any dt: trapezoidal and midpoint give it without bias",
        this->settings().name));
  if (bins_.bins > 0 && this->average().samples() > 0) add_profile(results);
}

template <int D>
void Stress<D>::save(StateWriter& out) const {
  out.write("one_stage", std::vector<std::int64_t>{one_stage_ ? 1 : 0});
  Observer<D>::save(out);
}

template <int D>
void Stress<D>::load(const StateReader& in) {
  one_stage_ = in.read_integers("one_stage").at(0) != 0;
  Observer<D>::load(in);
}

template std::vector<double> stress_of<2>(const Scene<2>&, const Particles<2>&,
                                          const StepRecord<2>&, const StressBins&);
template std::vector<double> stress_of<3>(const Scene<3>&, const Particles<3>&,
                                          const StepRecord<3>&, const StressBins&);
template class Stress<2>;
template class Stress<3>;

}  // namespace odpd
