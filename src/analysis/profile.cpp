#include "odpd/analysis/profile.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "odpd/analysis/least_squares.h"
#include "odpd/analysis/observer_keys.h"
#include "odpd/analysis/thermo.h"
#include "odpd/core/index.h"

namespace odpd {

template <int D>
Profile<D>::Profile(ObserverSettings settings, ProfileSettings profile, const Scene<D>& scene)
    : Observer<D>(std::move(settings),
                  (plain_width + (scene.particles().spin_of_species.empty() ? 0 : 1 + turns)) *
                      index(profile.bins)),
      profile_(profile),
      scene_(scene),
      spinning_(!scene.particles().spin_of_species.empty()),
      low_(scene.fluid_low()[profile.axis]),
      high_(scene.fluid_high()[profile.axis]) {}

template <int D>
std::int64_t fitted_bins(const ProfileSettings& p, const Scene<D>& scene) {
  const double low = scene.fluid_low()[p.axis];
  const double bin_width = (scene.fluid_high()[p.axis] - low) / static_cast<double>(p.bins);
  std::int64_t count = 0;
  for (std::int64_t b = 0; b < p.bins; ++b) {
    const double centre = low + bin_width * (static_cast<double>(b) + 0.5);
    if (centre >= p.fit_from && centre <= p.fit_to) ++count;
  }
  return count;
}

namespace {

// An empty range is an error of who gives it. Where nobody does and nothing is fitted, no range is needed.
void check_range(const Config& config, const ProfileSettings& p) {
  if (p.fit_from < p.fit_to) return;
  const bool from = config.has("fit_from"), to = config.has("fit_to");
  if (from || to)
    config.fail(from ? "fit_from" : "fit_to",
                fmt::format("fit_from = {}{} must be less than fit_to = {}{}", p.fit_from,
                            from ? "" : " (the default)", p.fit_to, to ? "" : " (the default)"));
  if (p.fit != ProfileFit::none)
    config.fail("fit",
                "the surfaces are at most two cutoffs apart, so no part of the profile is one "
                "cutoff clear of both: give fit_from and fit_to, or leave out the fit");
}

}  // namespace

template <int D>
std::unique_ptr<Observer<D>> Profile<D>::make(const ObserverEntry<D>& entry) {
  ObserverSettings settings = entry.settings();
  const Config& config = entry.config;
  const Scene<D>& scene = entry.scene;
  ProfileSettings p;
  p.axis = read_axis(entry);
  p.bins = config.positive_integer("bins", 20);
  const std::string fit = config.choice("fit", {"none", "linear", "parabola", "sine"}, "none");
  p.fit = fit == "linear"     ? ProfileFit::linear
          : fit == "parabola" ? ProfileFit::parabola
          : fit == "sine"     ? ProfileFit::sine
                              : ProfileFit::none;
  const FlowWave& wave = scene.settings().force_wave;
  if (p.fit == ProfileFit::sine &&
      (wave.number == 0 || wave.along != p.axis || wave.shape != FlowWave::Shape::sine))
    config.fail("fit", "a sine needs body_force.wave along the profile's axis");
  p.component =
      read_direction<D>(config, "component", scene.box().shear ? scene.box().shear->flow : 0);
  // By default the fit keeps one cutoff clear of the surfaces, where walls order the fluid.
  const double margin = scene.box().is_periodic(p.axis) ? 0.0 : scene.model().cutoff();
  p.fit_from = config.number("fit_from", scene.fluid_low()[p.axis] + margin);
  p.fit_to = config.number("fit_to", scene.fluid_high()[p.axis] - margin);
  check_range(config, p);
  const std::int64_t needed = p.fit == ProfileFit::none ? 0 : p.fit == ProfileFit::parabola ? 4 : 3;
  if (fitted_bins(p, scene) < needed)
    config.fail("fit",
                fmt::format("needs at least {} bins with centres between fit_from = {} and fit_to "
                            "= {}: use more bins or a wider range",
                            needed, p.fit_from, p.fit_to));
  return std::make_unique<Profile<D>>(std::move(settings), p, scene);
}

template <int D>
std::int64_t Profile<D>::bin_of(const Vec<D>& r) const {
  const double x = (r[profile_.axis] - low_) / (high_ - low_) * static_cast<double>(profile_.bins);
  // A particle pressed behind a wall's surface belongs to no bin.
  return x >= 0.0 && x < static_cast<double>(profile_.bins) ? static_cast<std::int64_t>(x) : -1;
}

template <int D>
double Profile<D>::centre(std::size_t bin) const {
  return low_ +
         (high_ - low_) * (static_cast<double>(bin) + 0.5) / static_cast<double>(profile_.bins);
}

template <int D>
void Profile<D>::measure(const Clock&, const Particles<D>& particles, const StepRecord<D>& record) {
  std::vector<double> force_squared, laplacian;
  double wall_energy = 0.0;
  configurational_terms(scene_, particles, record.start, force_squared, laplacian, wall_energy);
  std::vector<double> sample(this->average().width(), 0.0);
  const Box<D> box = scene_.box().at(record.start.time + 0.5 * record.dt);
  const Share own = particles.owned();
  for (std::size_t i = 0; i < record.v_mid.size(); ++i) {
    if (!particles.is_free(i) || !own.owns(i)) continue;
    Vec<D> middle = record.start.position[i] + (0.5 * record.dt) * record.v_mid[i];
    Vec<D> velocity = record.v_mid[i];
    std::array<std::int32_t, index(D)> image{};
    box.wrap(middle, image);
    if (box.shear) velocity[box.shear->flow] -= image[index(box.shear->gradient)] * box.sliding;
    if (const std::int64_t bin = bin_of(middle); bin >= 0) {
      sample[column(index(bin), 0)] += 1.0;
      for (int c = 0; c < D; ++c) sample[column(index(bin), index(c) + 1)] += velocity[c];
      if (!record.w_mid.empty() && particles.spins(i)) {
        sample[column(index(bin), plain_width)] += 1.0;
        for (std::size_t c = 0; c < turns; ++c)
          sample[column(index(bin), plain_width + 1 + c)] += record.w_mid[i].x[c];
      }
    }
    if (const std::int64_t bin = bin_of(record.start.position[i]); bin >= 0) {
      sample[column(index(bin), D + 1)] += force_squared[i];
      sample[column(index(bin), D + 2)] += laplacian[i];
    }
  }
  own.ranks->sum(std::span(sample));
  this->add(std::move(sample));
}

template <int D>
Table Profile<D>::table() const {
  const BlockAverage& average = this->average();
  Table t;
  t.comment = {"bins between the wall surfaces; standard errors by block averaging"};
  t.columns = {std::string(1, "xyz"[profile_.axis]), "density", "density_error"};
  for (int c = 0; c < D; ++c) {
    t.columns.push_back(fmt::format("v_{}", "xyz"[c]));
    t.columns.push_back(fmt::format("v_{}_error", "xyz"[c]));
  }
  t.columns.insert(t.columns.end(), {"config_temperature", "config_temperature_error"});
  const double bin_volume = scene_.fluid_volume() / static_cast<double>(profile_.bins);
  for (std::size_t b = 0; b < index(profile_.bins); ++b) {
    std::vector<double> row{centre(b), average.mean(column(b, 0)) / bin_volume,
                            average.standard_error(column(b, 0)) / bin_volume};
    for (std::size_t c = 1; c <= D; ++c) {
      const std::vector<BlockAverage::RatioTerm> term{{1.0, column(b, c), column(b, 0)}};
      row.insert(row.end(), {average.ratio(column(b, c), column(b, 0)), average.ratio_error(term)});
    }
    const std::vector<BlockAverage::RatioTerm> term{{1.0, column(b, D + 1), column(b, D + 2)}};
    if (some_force_jumps(scene_.pair_moments())) {
      row.insert(row.end(), 2, std::nan(""));  // as in thermo
    } else {
      row.insert(row.end(),
                 {average.ratio(column(b, D + 1), column(b, D + 2)), average.ratio_error(term)});
    }
    t.rows.push_back(std::move(row));
  }
  if (spinning_) add_spin_columns(t);
  return t;
}

template <int D>
void Profile<D>::add_spin_columns(Table& t) const {
  const BlockAverage& average = this->average();
  for (std::size_t c = 0; c < turns; ++c) {
    const std::string name = fmt::format("w_{}", D == 2 ? 'z' : "xyz"[c]);
    t.columns.insert(t.columns.end(), {name, name + "_error"});
    for (std::size_t b = 0; b < t.rows.size(); ++b) {
      const std::size_t sum = column(b, plain_width + 1 + c), count = column(b, plain_width);
      const std::vector<BlockAverage::RatioTerm> term{{1.0, sum, count}};
      t.rows[b].insert(t.rows[b].end(), {average.ratio(sum, count), average.ratio_error(term)});
    }
  }
}

// The component about the axis that the profile's component of the velocity turns particles about.
template <int D>
void Profile<D>::add_spin_chart(const Table& t, Results& results) const {
  if (profile_.component == profile_.axis) return;
  // Half the curl of g v, with v a function of x: 1/2 e_axis x e_component dv/dx.
  Vec<D> axis{}, component{};
  axis[profile_.axis] = component[profile_.component] = 1.0;
  const Vec<D> about = torque(axis, component);
  std::size_t c = 0;
  while (about.x[c] == 0.0) ++c;
  const auto w = index(6 + 2 * D) - 1 + 2 * c, v = index(3 + 2 * profile_.component);
  Chart chart{.title = fmt::format("Angular velocity w_{}", D == 2 ? 'z' : "xyz"[c]),
              .x_label = fmt::format("{} / r_c", "xyz"[profile_.axis]),
              .y_label = "w",
              .curves = {}};
  Curve spin{.title = "of the particles", .x = {}, .y = {}, .error = {}};
  Curve curl{.title = "half the curl of the velocity",
             .x = {},
             .y = {},
             .error = {},
             .line = true,
             .points = false};
  for (std::size_t b = 0; b < t.rows.size(); ++b) {
    spin.x.push_back(t.rows[b][0]);
    spin.y.push_back(t.rows[b][w]);
    spin.error.push_back(t.rows[b][w + 1]);
    if (b == 0 || b + 1 == t.rows.size()) continue;
    const auto &before = t.rows[b - 1], &after = t.rows[b + 1];
    curl.x.push_back(t.rows[b][0]);
    curl.y.push_back(0.5 * about.x[c] * (after[v] - before[v]) / (after[0] - before[0]));
  }
  chart.curves = {std::move(spin), std::move(curl)};
  results.charts.emplace_back(this->settings().name + "_spin", std::move(chart));
}

template <int D>
void Profile<D>::add_results(Results& results) const {
  const std::string& name = this->settings().name;
  const Table t = table();
  Chart velocity;
  velocity.title =
      fmt::format("Velocity v_{} across {}", "xyz"[profile_.component], "xyz"[profile_.axis]);
  velocity.x_label = fmt::format("{} / r_c", "xyz"[profile_.axis]);
  velocity.y_label = fmt::format("v_{}", "xyz"[profile_.component]);
  Curve measured{.title = "measured", .x = {}, .y = {}, .error = {}};
  const auto v = index(3 + 2 * profile_.component);
  for (const auto& row : t.rows) {
    measured.x.push_back(row[0]);
    measured.y.push_back(row[v]);
    measured.error.push_back(row[v + 1]);
  }
  velocity.curves.push_back(std::move(measured));
  if (profile_.fit != ProfileFit::none) add_fit(results, velocity);
  Chart density{
      .title = "Number density", .x_label = velocity.x_label, .y_label = "n r_c^d", .curves = {}};
  Curve n{.title = "measured", .x = {}, .y = {}, .error = {}, .line = true};
  for (const auto& row : t.rows) {
    n.x.push_back(row[0]);
    n.y.push_back(row[1]);
    n.error.push_back(row[2]);
  }
  density.curves.push_back(std::move(n));
  if (this->average().samples() == 0) return;
  if (!(profile_.fit_from < profile_.fit_to))
    results.notes.push_back(
        fmt::format("{}: the surfaces are at most two cutoffs apart, so walls order the fluid "
                    "everywhere between them; a fit would need fit_from and fit_to",
                    name));
  results.tables.emplace_back(name, t);
  results.charts.emplace_back(name + "_velocity", std::move(velocity));
  results.charts.emplace_back(name + "_density", std::move(density));
  if (spinning_) add_spin_chart(t, results);
}

// What the fit is a polynomial in, averaged over a bin of this width.
template <int D>
double Profile<D>::abscissa(double x, double bin_width) const {
  if (profile_.fit != ProfileFit::sine) return x - 0.5 * (low_ + high_);
  const double k = 2.0 * std::numbers::pi *
                   static_cast<double>(scene_.settings().force_wave.number) / (high_ - low_);
  const double half = 0.5 * k * bin_width;
  return std::sin(k * x) * (half > 0.0 ? std::sin(half) / half : 1.0);
}

// Driving force along the component where it is the same in all fitted bins, else 0.
template <int D>
double Profile<D>::fitted_force() const {
  const SceneSettings<D>& s = scene_.settings();
  for (const auto& region : s.force_regions)
    if (region.axis != profile_.axis) return 0.0;
  const double half = 0.499 * (high_ - low_) / static_cast<double>(profile_.bins);
  std::optional<double> force;
  for (std::size_t b = 0; b < index(profile_.bins); ++b) {
    if (centre(b) < profile_.fit_from || centre(b) > profile_.fit_to) continue;
    for (const double x : {centre(b) - half, centre(b) + half}) {
      Vec<D> r{};
      r[profile_.axis] = x;
      const double here = s.force_at(r)[profile_.component];
      if (force && here != *force) return 0.0;
      force = here;
    }
  }
  return force.value_or(0.0);
}

template <int D>
typename Profile<D>::FittedBins Profile<D>::fit_bins() const {
  const BlockAverage& average = this->average();
  const auto component = index(profile_.component) + 1;
  const int degree = profile_.fit == ProfileFit::parabola ? 2 : 1;
  const double nan = std::nan("");
  FittedBins fitted{.found = true, .fit = {}, .bins = {}};
  std::vector<double> x, y, error;
  for (std::size_t b = 0; b < index(profile_.bins); ++b) {
    if (centre(b) < profile_.fit_from || centre(b) > profile_.fit_to) continue;
    const std::vector<BlockAverage::RatioTerm> term{{1.0, column(b, component), column(b, 0)}};
    const double e = average.ratio_error(term);
    if (!(e > 0.0)) {
      fitted.found = false;
      fitted.density = nan;
      fitted.fit.coefficient.assign(index(degree) + 1, nan);
      fitted.fit.reduced_chi_square = nan;
      return fitted;
    }
    x.push_back(abscissa(centre(b), (high_ - low_) / static_cast<double>(profile_.bins)));
    y.push_back(average.ratio(column(b, component), column(b, 0)));
    error.push_back(e);
    fitted.bins.push_back(term[0]);
    fitted.density += average.mean(column(b, 0));
  }
  fitted.fit = fit_polynomial(degree, x, y, error);
  fitted.density *=
      static_cast<double>(profile_.bins) / scene_.fluid_volume() / static_cast<double>(x.size());
  return fitted;
}

template <int D>
double Profile<D>::coefficient_error(const FittedBins& fitted, std::size_t power) const {
  if (!fitted.found) return std::nan("");
  std::vector<BlockAverage::RatioTerm> terms = fitted.bins;
  for (std::size_t k = 0; k < terms.size(); ++k) terms[k].weight = fitted.fit.weight[power][k];
  return this->average().ratio_error(terms);
}

template <int D>
void Profile<D>::add_fit(Results& results, Chart& chart) const {
  const FittedBins fitted = fit_bins();
  if (!fitted.found)
    results.notes.push_back(fmt::format("{}: too few samples for errors, so no fit: run longer",
                                        this->settings().name));
  results.scalars.push_back(
      without_error(this->named("reduced_chi_square"), fitted.fit.reduced_chi_square));
  results.scalars.push_back(without_error(this->named("bulk_density"), fitted.density));
  const bool linear = profile_.fit == ProfileFit::linear, sine = profile_.fit == ProfileFit::sine;
  Curve line{.title = linear ? "linear fit"
                      : sine ? "sine fit"
                             : "parabola fit",
             .x = {},
             .y = {},
             .error = {},
             .line = true,
             .points = false};
  for (int k = 0; k <= 50 && fitted.found; ++k) {
    line.x.push_back(low_ + (high_ - low_) * k / 50.0);
    line.y.push_back(fitted.fit(abscissa(line.x.back(), 0.0)));
  }
  if (fitted.found) chart.curves.push_back(std::move(line));
  const int below = scene_.settings().wall_at(profile_.axis, false);
  const int above = scene_.settings().wall_at(profile_.axis, true);
  std::optional<WallSpeeds> walls;
  if (below >= 0 && above >= 0)
    walls = WallSpeeds{scene_.known_velocity(Group::wall(below), 0.0)[profile_.component],
                       scene_.known_velocity(Group::wall(above), 0.0)[profile_.component]};
  if (linear) {
    add_linear(fitted, walls, results, chart);
  } else if (sine) {
    add_sine(fitted, results);
  } else {
    add_parabola(fitted, walls, results);
  }
}

template <int D>
void Profile<D>::add_linear(const FittedBins& fitted, const std::optional<WallSpeeds>& walls,
                            Results& results, Chart& chart) const {
  const double slope = fitted.fit.coefficient[1];
  const double error = coefficient_error(fitted, 1);
  results.scalars.push_back({this->named("slope"), slope, error});
  if (!walls || walls->high == walls->low) return;
  const double h = high_ - low_;
  const double expected = (walls->high - walls->low) / h;
  results.scalars.push_back(
      {this->named("slope_ratio"), slope / expected, error / std::abs(expected)});
  results.scalars.push_back({this->named("slip_length"), 0.5 * h * (expected / slope - 1.0),
                             0.5 * h * std::abs(expected / (slope * slope)) * error});
  if (!fitted.found) return;
  results.notes.push_back(
      fmt::format("{}: H_eff = {} is the distance between the wall surfaces; slope_ratio "
                  "compares with (U_high - U_low)/H_eff",
                  this->settings().name, h));
  chart.curves.push_back({.title = "no slip at the surfaces",
                          .x = {low_, high_},
                          .y = {walls->low, walls->high},
                          .error = {},
                          .line = true,
                          .points = false});
}

template <int D>
void Profile<D>::add_parabola(const FittedBins& fitted, const std::optional<WallSpeeds>& walls,
                              Results& results) const {
  const std::vector<double>& c = fitted.fit.coefficient;
  const double error = coefficient_error(fitted, 2);
  results.scalars.push_back({this->named("curvature"), c[2], error});
  const double f = fitted_force();
  if (f == 0.0) return;
  const double viscosity = fitted.density * f / (-2.0 * c[2]);
  results.scalars.push_back(
      {this->named("viscosity"), viscosity, std::abs(viscosity / c[2]) * error});
  if (!walls) return;
  const double top = c[0] - c[1] * c[1] / (4.0 * c[2]);
  results.scalars.push_back({this->named("maximum"), top, coefficient_error(fitted, 0)});
  const double half_width = std::sqrt((0.5 * (walls->low + walls->high) - top) / c[2]);
  results.scalars.push_back(
      without_error(this->named("slip_length"), half_width - 0.5 * (high_ - low_)));
}

template <int D>
void Profile<D>::add_sine(const FittedBins& fitted, Results& results) const {
  const double amplitude = fitted.fit.coefficient[1], error = coefficient_error(fitted, 1);
  const double length = (high_ - low_) / (2.0 * std::numbers::pi *
                                          static_cast<double>(scene_.settings().force_wave.number));
  const double viscosity = fitted.density * scene_.settings().body_force[profile_.component] *
                           length * length / amplitude;
  results.scalars.push_back({this->named("amplitude"), amplitude, error});
  results.scalars.push_back(
      {this->named("viscosity"), viscosity, std::abs(viscosity / amplitude) * error});
}

template <int D>
std::vector<std::string> Profile<D>::series_columns() const {
  std::vector<std::string> columns;
  for (std::int64_t b = 0; b < profile_.bins; ++b)
    for (const char* what : {"count", "v_sum"}) columns.push_back(fmt::format("{}_{}", what, b));
  return columns;
}

template <int D>
std::vector<double> Profile<D>::series_row() const {
  std::vector<double> row;
  const std::vector<double>& newest = this->newest();
  if (newest.empty()) return row;
  for (std::size_t b = 0; b < index(profile_.bins); ++b) {
    row.push_back(newest[column(b, 0)]);
    row.push_back(newest[column(b, index(profile_.component) + 1)]);
  }
  return row;
}

template std::int64_t fitted_bins<2>(const ProfileSettings&, const Scene<2>&);
template std::int64_t fitted_bins<3>(const ProfileSettings&, const Scene<3>&);
template class Profile<2>;
template class Profile<3>;

}  // namespace odpd
