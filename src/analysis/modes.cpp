#include "odpd/analysis/modes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>

#include "odpd/analysis/least_squares.h"
#include "odpd/core/index.h"

namespace odpd {

namespace {

template <int D>
ModeGrowth::Settings growth_settings(const ModeSettings& modes, const Waves<D>& waves, double dt,
                                     double kT) {
  return {.window = modes.window,
          .fit_from = modes.fit_from,
          .dt = dt,
          .kT = kT,
          .waves = waves.count(),
          .modes_per_wave = waves.modes_per_wave(),
          .control_every = modes.control_every};
}

// What keeps a run from showing eta(k) by the spread along waves.
template <int D>
void refuse_other_runs(const ObserverEntry<D>& entry) {
  const Scene<D>& scene = entry.scene;
  const SceneSettings<D>& s = scene.settings();
  const auto fail = [&](const std::string& why) { entry.config.fail("kind", "'modes' " + why); };
  if (s.mass > 0.0) fail("measures particles without mass: set fluid.mass = 0");
  if (!(scene.largest_kT() > 0.0)) fail("measures by thermal motion: kT must be positive");
  for (const PairMoments& pair : scene.pair_moments())
    if (pair.kT != scene.largest_kT())
      fail("measures an equilibrium: all pairs of species must have the same kT");
  if (!entry.two_stages)
    fail(
        "integrates along the path of each step, of which schemes of one stage know the start "
        "only: "
        "use the integrator 'trapezoidal' or 'midpoint'");
  if (s.zeta_0 > 0.0)
    fail("needs a fluid that keeps its momentum, which a drag takes up: leave out fluid.zeta_0");
  if (s.box.shear) fail("measures at rest: leave out [shear]");
  if (s.box.periodic_directions() < D || s.held())
    fail(
        "needs waves that nothing stops: a box that is periodic in all directions, without walls, "
        "obstacles or bodies of known motion");
  if (s.driven()) fail("measures at rest: no force or torque may drive anything");
}

// `axes`: by default those of the longest edges of the box.
template <int D>
std::vector<int> read_axes(const ObserverEntry<D>& entry) {
  const Vec<D>& size = entry.scene.box().size;
  const double longest = *std::max_element(size.x.begin(), size.x.end());
  std::vector<int> axes;
  if (!entry.config.has("axes")) {
    for (int c = 0; c < D; ++c)
      if (size[c] == longest) axes.push_back(c);
    return axes;
  }
  for (const std::string& name : entry.config.texts("axes")) {
    const int axis = name.size() == 1 ? name[0] - 'x' : -1;
    if (axis < 0 || axis >= D || std::find(axes.begin(), axes.end(), axis) != axes.end())
      entry.config.fail("axes",
                        fmt::format("'{}' is no direction, or given twice: use a list of {}", name,
                                    D == 2 ? "x, y" : "x, y, z"));
    axes.push_back(axis);
    if (size[axis] != size[axes.front()])
      entry.config.fail("axes",
                        fmt::format("the box has edges {} and {} along them, so that their wave "
                                    "numbers differ: use an observer for each",
                                    size[axes.front()], size[axis]));
  }
  if (axes.empty()) entry.config.fail("axes", "at least one direction is needed");
  return axes;
}

// `numbers`, or 1 to `count`.
std::vector<std::int64_t> read_numbers(const Config& config) {
  std::vector<std::int64_t> numbers;
  if (!config.has("numbers")) {
    const std::int64_t count = config.positive_integer("count", 8);
    for (std::int64_t number = 1; number <= count; ++number) numbers.push_back(number);
    return numbers;
  }
  if (config.has("count")) config.fail("count", "give either count or numbers");
  for (const double number : config.numbers("numbers")) {
    const auto whole = static_cast<std::int64_t>(number);
    if (static_cast<double>(whole) != number || whole <= (numbers.empty() ? 0 : numbers.back()))
      config.fail("numbers", "must be whole, positive and ascending: waves in the edge of the box");
    numbers.push_back(whole);
  }
  if (numbers.empty()) config.fail("numbers", "at least one is needed");
  return numbers;
}

}  // namespace

template <int D>
Modes<D>::Modes(ObserverSettings settings, const ModeSettings& modes, const Scene<D>& scene,
                double dt)
    : Observer<D>(std::move(settings)),
      scene_(scene),
      dt_(dt),
      window_(modes.window),
      extrapolate_(std::min(index(modes.extrapolate), modes.numbers.size())),
      waves_(modes.numbers, modes.axes, scene.box().size[modes.axes.front()]),
      growth_(growth_settings(modes, waves_, dt, scene.largest_kT())),
      friction_(waves_.count()),
      steps_per_window_(std::max<std::int64_t>(1, std::llround(modes.window / dt))) {}

template <int D>
std::unique_ptr<Observer<D>> Modes<D>::make(const ObserverEntry<D>& entry) {
  const Config& config = entry.config;
  ObserverSettings settings = entry.settings();
  if (settings.every != 1)
    config.fail("every", "must be 1: the displacement is integrated over every step");
  if (entry.in_time) refuse_other_runs(entry);
  ModeSettings modes;
  modes.axes = read_axes(entry);
  modes.numbers = read_numbers(config);
  modes.window = config.positive("window", modes.window);
  modes.fit_from = config.non_negative("fit_from", 0.4 * modes.window);
  if (modes.fit_from >= modes.window) config.fail("fit_from", "must be less than window");
  modes.extrapolate = config.positive_integer("extrapolate", modes.extrapolate);
  if (config.boolean("control", false))
    modes.control_every = config.positive_integer("control_every", 1);
  if (static_cast<double>(modes.control_every) * entry.clock.dt > 0.25 * modes.window)
    config.fail("control_every", "the window must hold four controlled steps");
  return std::make_unique<Modes<D>>(std::move(settings), modes, entry.scene, entry.clock.dt);
}

template <int D>
void Modes<D>::measure(const Clock&, const Particles<D>& particles, const StepRecord<D>& record) {
  std::vector<double> growth(waves_.modes().size(), 0.0), made, response;
  const auto add_stage = [&](const Stage<D>& stage, double weight) {
    if (weight == 0.0) return;
    const std::vector<double> sums = waves_.sums(particles, stage.position, stage.velocity);
    for (std::size_t m = 0; m < growth.size(); ++m) growth[m] += dt_ * weight * sums[m];
  };
  add_stage(record.start, record.start_weight);
  add_stage(record.corrector, 1.0 - record.start_weight);
  if (growth_.control_is_due()) solve_modes(particles, record, made, response);
  growth_.add(growth, made, response);
  // Configurations change little within a window.
  if (steps_++ % steps_per_window_ == 0)
    friction_.add(waves_.friction(particles, record.start.network));
}

template <int D>
void Modes<D>::solve_modes(const Particles<D>& particles, const StepRecord<D>& record,
                           std::vector<double>& made, std::vector<double>& response) const {
  const Share own = particles.owned();
  const PairNetwork<D>& network = record.start.network;
  for (const auto& mode : waves_.modes()) {
    const std::vector<Vec<D>> phi = waves_.shape(mode, record.start.position);
    const std::vector<Vec<D>> w = record.respond(phi);
    double along_noise = 0.0, along_phi = 0.0;
    for (std::size_t edge = 0; edge < record.edge_noise.size(); ++edge)
      if (network.counts(edge))
        along_noise +=
            dot(record.edge_noise[edge], w[index(network.i[edge])] - w[index(network.j[edge])]);
    for (auto i = index(own.first); i < index(own.end(std::ssize(w))); ++i)
      along_phi += dot(phi[i], w[i]);
    made.push_back(dt_ * along_noise);
    response.push_back(along_phi);
  }
  own.ranks->sum(made);
  own.ranks->sum(response);
}

template <int D>
double Modes<D>::viscosity(std::size_t wave, double chi) const {
  const auto n = static_cast<double>(scene_.particles().size());
  const double k = waves_.k(wave);
  return n * n / (2.0 * scene_.box().volume() * k * k * chi);
}

template <int D>
Scalar Modes<D>::viscosity(const std::string& what, std::size_t wave,
                           const ModeGrowth::Estimate& chi) const {
  const double eta = viscosity(wave, chi.mean);
  return {this->named(fmt::format("{}.{}", what, wave + 1)), eta,
          std::abs(eta / chi.mean) * chi.error};
}

template <int D>
void Modes<D>::add_results(Results& results) const {
  for (std::size_t wave = 0; wave < waves_.count(); ++wave) {
    results.scalars.push_back(viscosity("eta", wave, growth_.chi(wave)));
    if (growth_.controlled()) {
      results.scalars.push_back(viscosity("plain", wave, growth_.plain(wave)));
      results.scalars.push_back(viscosity("frozen", wave, growth_.frozen(wave)));
      const ModeGrowth::Estimate tau = growth_.memory_time(wave);
      results.scalars.push_back(
          {this->named(fmt::format("tau.{}", wave + 1)), tau.mean, tau.error});
    }
    Scalar affine{this->named(fmt::format("eta_inf.{}", wave + 1))};
    if (friction_.samples() > 0) {
      const double scale = 2.0 / (scene_.box().volume() * waves_.k(wave) * waves_.k(wave));
      affine.mean = scale * friction_.mean(wave);
      affine.standard_error = scale * friction_.standard_error(wave);
    }
    results.scalars.push_back(std::move(affine));
  }
  add_extrapolation(results);
  if (growth_.samples() == 0) return;
  const std::string& name = this->settings().name;
  const Table by_k = table(results), by_lag = lag_table();
  results.charts.emplace_back(name, chart(results, by_k));
  results.charts.emplace_back(name + "_lags", lag_chart(by_lag));
  results.tables.emplace_back(name, by_k);
  results.tables.emplace_back(name + "_lags", by_lag);
  if (!growth_.controlled()) return;
  const Table by_omega = modulus_table();
  results.charts.emplace_back(name + "_moduli", modulus_chart(by_omega));
  results.tables.emplace_back(name + "_moduli", by_omega);
}

// Least squares with the errors of eta(k) as weights.
template <int D>
void Modes<D>::add_extrapolation(Results& results) const {
  Scalar zero{this->named("eta_0")}, curvature{this->named("curvature")};
  std::vector<double> x, y, error;
  for (std::size_t wave = 0; wave < extrapolate_; ++wave) {
    const Scalar eta = viscosity("eta", wave, growth_.chi(wave));
    if (!(eta.standard_error > 0.0)) break;
    x.push_back(waves_.k(wave) * waves_.k(wave));
    y.push_back(eta.mean);
    error.push_back(eta.standard_error);
  }
  if (x.size() == extrapolate_ && extrapolate_ >= 2) {
    const PolynomialFit fit = fit_polynomial(1, x, y, error);
    for (std::size_t p = 0; p < 2; ++p) {
      Scalar& scalar = p == 0 ? zero : curvature;
      scalar.mean = fit.coefficient[p];
      // All k see the same configurations, so that their errors do not simply add up.
      scalar.standard_error = growth_.error_of([&](const std::vector<double>& chi) {
        double sum = 0.0;
        for (std::size_t wave = 0; wave < extrapolate_; ++wave)
          sum += fit.weight[p][wave] * viscosity(wave, chi[wave]);
        return sum;
      });
    }
    results.notes.push_back(
        fmt::format("{}: eta_0 + {} k^2 fitted up to k = {:.4g}, reduced chi^2 {:.2g}", zero.name,
                    curvature.name, waves_.k(extrapolate_ - 1), fit.reduced_chi_square));
  }
  results.scalars.push_back(std::move(zero));
  results.scalars.push_back(std::move(curvature));
}

template <int D>
Table Modes<D>::table(const Results& results) const {
  Table table;
  table.comment = {"viscosity at wave numbers k = 2 pi number/(edge of the box)"};
  table.columns = {"number", "k"};
  std::vector<std::string> names{"eta", "eta_inf"};
  if (growth_.controlled()) names.insert(names.end(), {"plain", "frozen"});
  for (const std::string& name : names) {
    table.columns.push_back(name);
    table.columns.push_back(name + "_error");
  }
  for (std::size_t wave = 0; wave < waves_.count(); ++wave) {
    std::vector<double> row{static_cast<double>(waves_.number(wave)), waves_.k(wave)};
    for (const std::string& name : names) {
      const Scalar* scalar = results.find(this->named(fmt::format("{}.{}", name, wave + 1)));
      row.push_back(scalar->mean);
      row.push_back(scalar->standard_error);
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

template <int D>
Table Modes<D>::lag_table() const {
  Table table;
  table.comment = {"eta(t; k) = N^2/(2 V k^2 chi(t)), which tends to eta(k) beyond the memory"};
  table.columns = {"lag"};
  for (std::size_t wave = 1; wave <= waves_.count(); ++wave) {
    table.columns.push_back(fmt::format("eta_{}", wave));
    table.columns.push_back(fmt::format("eta_{}_error", wave));
  }
  for (std::size_t lag = 1; lag <= growth_.lags(); ++lag) {
    std::vector<double> row{growth_.lag_time(lag)};
    for (std::size_t wave = 0; wave < waves_.count(); ++wave) {
      const Scalar eta = viscosity("eta", wave, growth_.at_lag(wave, lag));
      row.push_back(eta.mean);
      row.push_back(eta.standard_error);
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

// G' and eta' of a Jeffreys fluid, of frequencies that the window and the step allow.
template <int D>
Table Modes<D>::modulus_table() const {
  constexpr double per_decade = 10.0;
  Table table;
  table.comment = {"storage modulus G' and dynamic viscosity eta' with one time of the memory"};
  table.columns = {"omega"};
  for (std::size_t wave = 1; wave <= waves_.count(); ++wave) {
    table.columns.push_back(fmt::format("storage_{}", wave));
    table.columns.push_back(fmt::format("viscosity_{}", wave));
  }
  const double lowest = 0.1 / window_;
  const auto points = static_cast<int>(per_decade * std::log10(1.0 / (dt_ * lowest)));
  for (int n = 0; n <= points; ++n) {
    const double omega = lowest * std::pow(10.0, n / per_decade);
    std::vector<double> row{omega};
    for (std::size_t wave = 0; wave < waves_.count(); ++wave) {
      const double chi = growth_.chi(wave).mean, chi_0 = growth_.frozen(wave).mean;
      const double turn = omega * growth_.memory_time(wave).mean;
      const std::complex<double> response = chi_0 - (chi_0 - chi) / std::complex(1.0, turn);
      const std::complex<double> eta = viscosity(wave, 1.0) / response;
      row.push_back(-omega * eta.imag());
      row.push_back(eta.real());
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

template <int D>
Chart Modes<D>::modulus_chart(const Table& by_omega) const {
  Chart chart{.title = "Storage modulus",
              .x_label = "omega",
              .y_label = "G'",
              .log_x = true,
              .log_y = true,
              .curves = {}};
  for (std::size_t wave = 0; wave < waves_.count(); ++wave) {
    Curve curve{.title = fmt::format("k = {:.4g}", waves_.k(wave)),
                .x = {},
                .y = {},
                .error = {},
                .line = true,
                .points = false};
    for (const auto& row : by_omega.rows) {
      if (!(row[1 + 2 * wave] > 0.0)) continue;  // a memory lost in the errors
      curve.x.push_back(row[0]);
      curve.y.push_back(row[1 + 2 * wave]);
    }
    if (!curve.x.empty()) chart.curves.push_back(std::move(curve));
  }
  return chart;
}

template <int D>
Chart Modes<D>::chart(const Results& results, const Table& by_k) const {
  Chart chart{
      .title = "Viscosity by wave number", .x_label = "k", .y_label = "eta(k)", .curves = {}};
  Curve eta{.title = "measured", .x = {}, .y = {}, .error = {}};
  Curve affine{.title = "eta_inf(k)", .x = {}, .y = {}, .error = {}, .line = true};
  for (const auto& row : by_k.rows) {
    eta.x.push_back(row[1]);
    eta.y.push_back(row[2]);
    eta.error.push_back(row[3]);
    affine.x.push_back(row[1]);
    affine.y.push_back(row[4]);
  }
  chart.curves = {std::move(eta), std::move(affine)};
  const double zero = results.find(this->named("eta_0"))->mean;
  const double curvature = results.find(this->named("curvature"))->mean;
  if (std::isnan(zero)) return chart;
  Curve fit{.title = "eta_0 + a k^2", .x = {}, .y = {}, .error = {}, .line = true, .points = false};
  constexpr int points = 20;
  for (int n = 0; n <= points; ++n) {
    const double k = waves_.k(extrapolate_ - 1) * n / points;
    fit.x.push_back(k);
    fit.y.push_back(zero + curvature * k * k);
  }
  chart.curves.push_back(std::move(fit));
  return chart;
}

template <int D>
Chart Modes<D>::lag_chart(const Table& by_lag) const {
  Chart chart{.title = "Viscosity by lag", .x_label = "t", .y_label = "eta(t; k)", .curves = {}};
  for (std::size_t wave = 0; wave < waves_.count(); ++wave) {
    Curve curve{.title = fmt::format("k = {:.4g}", waves_.k(wave)), .x = {}, .y = {}, .error = {}};
    for (const auto& row : by_lag.rows) {
      curve.x.push_back(row[0]);
      curve.y.push_back(row[1 + 2 * wave]);
    }
    chart.curves.push_back(std::move(curve));
  }
  return chart;
}

template <int D>
std::vector<std::string> Modes<D>::series_columns() const {
  std::vector<std::string> columns;
  for (const auto& mode : waves_.modes())
    columns.push_back(fmt::format("phi_{}_{}{}_{}", waves_.number(mode.wave), "xyz"[mode.axis],
                                  "xyz"[mode.component], mode.sine ? "sin" : "cos"));
  return columns;
}

template <int D>
void Modes<D>::save(StateWriter& out) const {
  out.write("sampled_steps", std::vector<std::int64_t>{steps_});
  friction_.save(out, "friction");
  growth_.save(out);
}

template <int D>
void Modes<D>::load(const StateReader& in) {
  steps_ = in.read_integers("sampled_steps").at(0);
  friction_.load(in, "friction");
  growth_.load(in);
}

template class Modes<2>;
template class Modes<3>;

}  // namespace odpd
