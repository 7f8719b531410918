#include "odpd/analysis/modes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "odpd/analysis/current_modes.h"
#include "odpd/analysis/frozen.h"
#include "odpd/analysis/mode_keys.h"
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
          .control_every = modes.control.every};
}

// What keeps a run from showing eta(k) by the spread along waves.
template <int D>
void refuse_other_runs(const ObserverEntry<D>& entry) {
  if (!entry.two_stages)
    entry.config.fail(
        "kind",
        "'modes' integrates along the path of each step, of which schemes of one stage know the "
        "start only: use the integrator 'trapezoidal' or 'midpoint'");
  refuse_modes_unless_at_rest(entry);
}

}  // namespace

template <int D>
Modes<D>::Modes(ObserverSettings settings, const ModeSettings& modes, const Scene<D>& scene,
                double dt)
    : Observer<D>(std::move(settings)),
      scene_(scene),
      dt_(dt),
      window_(modes.window),
      control_tolerance_(modes.control.tolerance),
      extrapolate_(std::min(index(modes.extrapolate), modes.numbers.size())),
      waves_(modes.numbers, modes.axes, scene.box().size[modes.axes.front()]),
      growth_(growth_settings(modes, waves_, dt, scene.largest_kT())),
      friction_(waves_.count()),
      steps_per_window_(std::max<std::int64_t>(1, std::llround(modes.window / dt))) {}

template <int D>
std::unique_ptr<Observer<D>> Modes<D>::make(const ObserverEntry<D>& entry) {
  if (entry.scene.settings().mass > 0.0) return CurrentModes<D>::make(entry);
  const Config& config = entry.config;
  ObserverSettings settings = entry.settings();
  if (settings.every != 1)
    config.fail("every", "must be 1: the displacement is integrated over every step");
  if (entry.in_time) refuse_other_runs(entry);
  ModeSettings modes;
  modes.axes = read_wave_axes(entry);
  modes.numbers = read_wave_numbers(config);
  modes.window = config.positive("window", modes.window);
  modes.fit_from = config.non_negative("fit_from", 0.4 * modes.window);
  if (modes.fit_from >= modes.window) config.fail("fit_from", "must be less than window");
  require_two_steps(config, modes.window, entry.clock.dt);
  modes.extrapolate = read_extrapolation(config, modes.numbers.size());
  modes.control = read_control(config, modes.window, entry.clock.dt);
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
  for (const auto& mode : waves_.modes()) {
    const ForceAnswer<D> answer = answer_to_force<D>(
        particles, record, {waves_.shape(mode, record.start.position)}, 0.0, control_tolerance_);
    made.push_back(dt_ * answer.noise);
    response.push_back(answer.mobility);
  }
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
  std::vector<std::string> without_tau;
  for (std::size_t wave = 0; wave < waves_.count(); ++wave) {
    results.scalars.push_back(viscosity("eta", wave, growth_.chi(wave)));
    if (growth_.controlled()) {
      results.scalars.push_back(viscosity("plain", wave, growth_.plain(wave)));
      results.scalars.push_back(viscosity("frozen", wave, growth_.frozen(wave)));
      const ModeGrowth::Estimate tau = growth_.memory_time(wave);
      results.scalars.push_back(
          {this->named(fmt::format("tau.{}", wave + 1)), tau.mean, tau.error});
      if (!(tau.mean >= 2.0 * tau.error)) without_tau.push_back(results.scalars.back().name);
    }
    Scalar affine{this->named(fmt::format("eta_inf.{}", wave + 1))};
    if (friction_.samples() > 0) {
      const double scale = 2.0 / (scene_.box().volume() * waves_.k(wave) * waves_.k(wave));
      affine.mean = scale * friction_.mean(wave);
      affine.standard_error = scale * friction_.standard_error(wave);
    }
    results.scalars.push_back(std::move(affine));
  }
  const ModeResults modes = as_results();
  modes.add_extrapolation(results, extrapolate_, [&](const ModeResults::OfViscosities& function) {
    return growth_.error_of([&](const std::vector<double>& chi) {
      std::vector<double> eta;
      for (std::size_t wave = 0; wave < chi.size(); ++wave)
        eta.push_back(viscosity(wave, chi[wave]));
      return function(eta);
    });
  });
  if (growth_.samples() == 0) return;
  if (!without_tau.empty())
    results.notes.push_back(fmt::format(
        "{}: no memory time above two standard errors is in {}, nor in the moduli by it",
        this->settings().name, fmt::join(without_tau, ", ")));
  if (growth_.controlled() && !scene_.bonds().empty())
    results.notes.push_back(control_with_bonds(this->settings().name));
  std::vector<std::string> columns{"eta", "eta_inf"};
  if (growth_.controlled()) columns.insert(columns.end(), {"plain", "frozen"});
  const std::string& name = this->settings().name;
  const Table by_lag = lag_table();
  results.charts.emplace_back(name, modes.chart(results, extrapolate_));
  results.charts.emplace_back(name + "_lags", lag_chart(by_lag));
  results.tables.emplace_back(name, modes.by_k(results, columns));
  results.tables.emplace_back(name + "_lags", by_lag);
  if (!growth_.controlled()) return;
  // Of frequencies that the window and the step allow.
  const Table by_omega =
      modes.moduli(0.1 / window_, 1.0 / dt_, [&](std::size_t wave, double omega) {
        return jeffreys(wave, results.find(modes.scalar("tau", wave))->mean, omega);
      });
  results.charts.emplace_back(name + "_moduli", modes.modulus_chart(by_omega, true));
  results.tables.emplace_back(name + "_moduli", by_omega);
}

template <int D>
ModeResults Modes<D>::as_results() const {
  ModeResults results{.name = this->settings().name, .numbers = {}, .k = {}};
  for (std::size_t wave = 0; wave < waves_.count(); ++wave) {
    results.numbers.push_back(waves_.number(wave));
    results.k.push_back(waves_.k(wave));
  }
  return results;
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

// eta* of a Jeffreys fluid; undefined where errors hide its memory.
template <int D>
std::complex<double> Modes<D>::jeffreys(std::size_t wave, double tau, double omega) const {
  const double chi = growth_.chi(wave).mean, chi_0 = growth_.frozen(wave).mean;
  const double undefined = std::numeric_limits<double>::quiet_NaN();
  if (!(tau > 0.0)) return {undefined, undefined};
  return viscosity(wave, 1.0) / (chi_0 - (chi_0 - chi) / std::complex(1.0, omega * tau));
}

template <int D>
Chart Modes<D>::lag_chart(const Table& by_lag) const {
  Chart chart{.title = "Viscosity by lag", .x_label = "t", .y_label = "eta(t; k)", .curves = {}};
  for (std::size_t wave = 0; wave < waves_.count(); ++wave) {
    Curve curve{.title = fmt::format("k = {:.4g}", waves_.k(wave)),
                .x = {},
                .y = {},
                .error = {},
                .line = true,
                .points = false};
    for (const auto& row : by_lag.rows) {
      curve.x.push_back(row[0]);
      curve.y.push_back(row[1 + 2 * wave]);
    }
    chart.curves.push_back(std::move(curve));
  }
  return chart;
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
