#include "odpd/analysis/current_modes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "odpd/analysis/current_decay.h"
#include "odpd/analysis/mode_keys.h"
#include "odpd/core/error.h"
#include "odpd/core/index.h"

namespace odpd {

namespace {

// The memory goes on for several times m/friction, in which short waves decay more than once.
constexpr double decays_in_window = 5.0, memories_in_window = 10.0;
constexpr double fewest_decays = 2.0, most_decays_before_fit = 8.0;
constexpr std::int64_t fewest_lags = 8, most_lags = 2000;
constexpr std::int64_t samples_per_friction = 100;
constexpr std::size_t lags_in_fit = 100;

template <int D>
std::vector<bool> which_are_longitudinal(const Waves<D>& waves) {
  std::vector<bool> longitudinal;
  for (std::size_t m = 0; m < waves.modes_per_wave(); ++m)
    longitudinal.push_back(waves.modes()[m].component == waves.modes()[m].axis);
  return longitudinal;
}

// Mean over the particles and directions.
template <int D>
double friction_of_a_particle(const Particles<D>& particles, const PairNetwork<D>& network) {
  double sum = 0.0;
  for (std::size_t edge = 0; edge < index(network.size()); ++edge)
    if (network.counts(edge))
      sum +=
          network.zeta_par[edge] + (network.transverse ? (D - 1) * network.zeta_perp[edge] : 0.0);
  particles.ranks().sum(std::span(&sum, 1));
  return 2.0 * sum / (D * static_cast<double>(particles.size()));
}

// Every so many-th value from the first on, for fits: neighbours among many lags say the same.
std::vector<double> thinned(std::span<const double> c, std::size_t stride) {
  std::vector<double> thin;
  for (std::size_t lag = 0; lag < c.size(); lag += stride) thin.push_back(c[lag]);
  return thin;
}

}  // namespace

template <int D>
CurrentModes<D>::CurrentModes(ObserverSettings settings, const CurrentModeSettings& modes,
                              const Scene<D>& scene, double dt)
    : Observer<D>(std::move(settings)),
      scene_(scene),
      modes_(modes),
      dt_(dt),
      extrapolate_(std::min(index(modes.extrapolate), modes.numbers.size())),
      waves_(modes.numbers, modes.axes, scene.box().size[modes.axes.front()], true),
      named_{.name = this->settings().name, .numbers = modes.numbers, .k = {}},
      correlator_({}, which_are_longitudinal(waves_), 1.0),
      friction_(waves_.count()) {
  for (std::size_t wave = 0; wave < waves_.count(); ++wave) named_.k.push_back(waves_.k(wave));
}

template <int D>
std::unique_ptr<Observer<D>> CurrentModes<D>::make(const ObserverEntry<D>& entry) {
  const Config& config = entry.config;
  if (entry.in_time) refuse_modes_unless_at_rest(entry);
  const bool control = config.boolean("control", false);
  for (const char* key : {"control", "control_every", "control_tolerance"})
    if (key == std::string("control") ? control : config.has(key))
      config.fail(key,
                  "is for particles without mass, where a step's noise is all that it moves them "
                  "by. With mass the noise of a step lives on in their momentum: leave it out");
  if (config.has("fit_from"))
    config.fail("fit_from",
                "is for particles without mass. With mass eta is the area under the correlation "
                "of currents from its start: leave it out");
  CurrentModeSettings modes;
  modes.axes = read_wave_axes(entry);
  modes.numbers = read_wave_numbers(config);
  modes.half_way = entry.half_way_velocity;
  modes.extrapolate = read_extrapolation(config, modes.numbers.size());
  ObserverSettings settings = entry.settings();
  if (config.has("window")) {
    modes.window = config.positive("window");
    const double samples = modes.window / (entry.clock.dt * static_cast<double>(settings.every));
    if (samples < static_cast<double>(fewest_lags) - 0.5)
      config.fail("window", fmt::format("must hold {} samples at least", fewest_lags));
    if (samples > static_cast<double>(most_lags) + 0.5)
      config.fail("window",
                  fmt::format("holds {:.0f} samples, but {} at most are kept: take a shorter one "
                              "or a larger every",
                              samples, most_lags));
  }
  return std::make_unique<CurrentModes<D>>(std::move(settings), modes, entry.scene, entry.clock.dt);
}

template <int D>
double CurrentModes<D>::rho() const {
  return static_cast<double>(scene_.particles().size()) * scene_.settings().mass /
         scene_.box().volume();
}

template <int D>
double CurrentModes<D>::eta_inf(std::size_t wave) const {
  return 2.0 * friction_.mean(wave) / (scene_.box().volume() * named_.k[wave] * named_.k[wave]);
}

// By the friction of the first sample where the case does not say.
template <int D>
void CurrentModes<D>::choose_lags(double particle_time) {
  std::vector<std::int64_t> lags;
  for (std::size_t wave = 0; wave < waves_.count(); ++wave) {
    const double rate = eta_inf(wave) * named_.k[wave] * named_.k[wave] / rho();
    const double window = modes_.window > 0.0
                              ? modes_.window
                              : decays_in_window / rate + memories_in_window * particle_time;
    lags.push_back(static_cast<std::int64_t>(std::round(std::clamp(
        window / interval(), static_cast<double>(fewest_lags), static_cast<double>(most_lags)))));
  }
  // The mean of J^2 is N/2 kT/m.
  const double scale = 2.0 * scene_.settings().mass /
                       (static_cast<double>(scene_.particles().size()) * scene_.largest_kT());
  correlator_ = WaveCorrelator(std::move(lags), which_are_longitudinal(waves_), scale);
}

template <int D>
void CurrentModes<D>::measure(const Clock&, const Particles<D>& particles,
                              const StepRecord<D>& record) {
  // Configurations change little between two of these.
  if (samples_++ % samples_per_friction == 0)
    friction_.add(waves_.friction(particles, record.start.network));
  if (correlator_.waves() == 0)
    choose_lags(scene_.settings().mass / friction_of_a_particle(particles, record.start.network));
  current_ = waves_.sums(particles, record.start.position,
                         modes_.half_way ? record.v_mid : record.v_start);
  correlator_.add(current_);
}

template <int D>
double CurrentModes<D>::mean_square(std::span<const double> c) const {
  return modes_.half_way && this->settings().every == 1 ? 0.5 * (c[0] + c[1]) : c[0];
}

template <int D>
std::vector<double> CurrentModes<D>::means() const {
  const BlockAverage& average = correlator_.average();
  std::vector<double> means;
  for (std::size_t column = 0; column < average.width(); ++column)
    means.push_back(average.mean(column));
  return means;
}

template <int D>
std::vector<std::size_t> CurrentModes<D>::joins(const std::vector<double>& means) const {
  std::vector<std::size_t> joins;
  for (std::size_t wave = 0; wave < waves_.count(); ++wave) {
    const std::size_t lags = correlator_.lags(wave);
    const double rate = fit_exponential(
        std::span(means).subspan(correlator_.first_column(wave, false), lags + 1), interval());
    const double join =
        std::min(0.5 * static_cast<double>(lags), most_decays_before_fit / (rate * interval()));
    joins.push_back(std::isnan(join) ? lags
                                     : std::max<std::size_t>(1, static_cast<std::size_t>(join)));
  }
  return joins;
}

template <int D>
auto CurrentModes<D>::estimates(const std::vector<double>& means,
                                const std::vector<std::size_t>& joins) const
    -> std::vector<Estimate> {
  const auto every = static_cast<double>(this->settings().every);
  std::vector<Estimate> estimates;
  for (std::size_t wave = 0; wave < waves_.count(); ++wave) {
    const auto c =
        std::span(means).subspan(correlator_.first_column(wave, false), correlator_.lags(wave) + 1);
    const std::size_t stride = 1 + (c.size() - 1) / lags_in_fit;
    const std::vector<double> thin = thinned(c, stride);
    const double between_fitted = interval() * static_cast<double>(stride);
    const MaxwellFit maxwell = fit_maxwell(thin, between_fitted);
    const bool known_only = has_bodies() || (modes_.half_way && this->settings().every > 1);
    const double norm = known_only ? 1.0 : mean_square(c);
    // Of the area under c/c(0): in steps, by the exponential of this area where some were left out.
    const auto of_area = [&](double area) {
      if (this->settings().every > 1) {
        // Below half an interval, which noise may make of a fast decay, this is not a number.
        const double intervals = area / interval();
        const double q = std::pow((2.0 * intervals - 1.0) / (2.0 * intervals + 1.0), 1.0 / every);
        area = 0.5 * dt_ * (1.0 + q) / (1.0 - q);
      }
      return rho() * norm / (named_.k[wave] * named_.k[wave] * c[0] * area);
    };
    const auto of_rate = [&](double rate) {
      const double q = std::exp(-rate * interval());
      return of_area(0.5 * interval() * (1.0 + q) / (1.0 - q));
    };
    estimates.push_back({of_area(decay_area(c, interval(), joins[wave], maxwell)),
                         of_rate(fit_exponential(thin, between_fitted)), of_rate(maxwell.rate),
                         maxwell.tau, mean_square(c)});
  }
  return estimates;
}

template <int D>
double CurrentModes<D>::memory_time(std::size_t wave, const Estimate& estimate) const {
  return estimate.eta * estimate.tau / (estimate.eta - eta_inf(wave));
}

template <int D>
void CurrentModes<D>::add_results(Results& results) const {
  const BlockAverage& average = correlator_.average();
  const bool measured = average.samples() > 0;
  std::vector<Estimate> all;
  std::vector<std::vector<Estimate>> left_out;
  if (measured) {
    const std::vector<double> c = means();
    const std::vector<std::size_t> join = joins(c);
    all = estimates(c, join);
    left_out = average.left_out(
        [&](const std::vector<double>& without) { return estimates(without, join); });
  }
  const auto error_of = [&](const auto& function) {
    std::vector<double> values;
    for (const auto& without : left_out) values.push_back(function(without));
    return BlockAverage::jackknife_error(std::move(values));
  };
  std::vector<Scalar> taus;
  for (std::size_t wave = 0; wave < waves_.count(); ++wave) {
    const auto add = [&](const char* what, const auto& of_estimate) {
      Scalar scalar{named_.scalar(what, wave)};
      if (measured) {
        scalar.mean = of_estimate(all[wave]);
        scalar.standard_error =
            error_of([&](const std::vector<Estimate>& e) { return of_estimate(e[wave]); });
      }
      results.scalars.push_back(std::move(scalar));
    };
    add("eta", [](const Estimate& e) { return e.eta; });
    add("exp", [](const Estimate& e) { return e.exponential; });
    add("maxwell", [](const Estimate& e) { return e.maxwell; });
    add("tau", [](const Estimate& e) { return e.tau; });
    taus.push_back(results.scalars.back());
    add("memory", [&](const Estimate& e) { return memory_time(wave, e); });
    add("equipartition", [](const Estimate& e) { return e.mean_square; });
    Scalar affine{named_.scalar("eta_inf", wave)};
    if (friction_.samples() > 0) {
      affine.mean = eta_inf(wave);
      affine.standard_error = affine.mean * friction_.standard_error(wave) / friction_.mean(wave);
    }
    results.scalars.push_back(std::move(affine));
  }
  named_.add_extrapolation(results, extrapolate_, [&](const ModeResults::OfViscosities& function) {
    return error_of([&](const std::vector<Estimate>& e) {
      std::vector<double> eta;
      for (const Estimate& of_wave : e) eta.push_back(of_wave.eta);
      return function(eta);
    });
  });
  if (!measured) return;
  add_notes(results, taus);
  add_tables(results);
}

template <int D>
void CurrentModes<D>::add_notes(Results& results, const std::vector<Scalar>& taus) const {
  std::vector<std::string> without_tau, softer, early, coarse, fast;
  for (std::size_t wave = 0; wave < waves_.count(); ++wave) {
    const Scalar& tau = taus[wave];
    const Scalar& of_wave = *results.find(named_.scalar("eta", wave));
    const double eta = of_wave.mean;
    const double decays = eta * named_.k[wave] * named_.k[wave] / rho();
    if (!(tau.mean >= 3.0 * dt_ && tau.mean >= 2.0 * tau.standard_error))
      without_tau.push_back(tau.name);
    if (eta + 2.0 * of_wave.standard_error < eta_inf(wave))
      softer.push_back(fmt::format("{:.4g}", named_.k[wave]));
    if (decays * interval() * static_cast<double>(correlator_.lags(wave)) < fewest_decays)
      early.push_back(fmt::format("{:.4g}", named_.k[wave]));
    if (this->settings().every > 1 && !(decays * interval() < 1.0))
      coarse.push_back(fmt::format("{:.4g}", named_.k[wave]));
    else if (!(decays * dt_ < 1.0))
      fast.push_back(fmt::format("{:.4g}", named_.k[wave]));
  }
  const std::string& name = this->settings().name;
  const auto note = [&](const std::vector<std::string>& of, const char* what) {
    if (!of.empty())
      results.notes.push_back(
          fmt::format("{}: {}", name, fmt::format(fmt::runtime(what), fmt::join(of, ", "))));
  };
  note(without_tau, "no relaxation time above 3 dt and two standard errors is in {}");
  note(softer,
       "eta(k) is below eta_inf(k) at k = {}: particles give way after a time m/friction, and "
       "G' is negative, no storage");
  note(early, "at k = {} the window ends before two decays: take a longer one");
  note(coarse, "at k = {} currents decay between two samples: take a smaller every");
  note(fast,
       "at k = {} currents decay within a step, and fits mean nothing: take a smaller dt, or "
       "mass 0");
}

template <int D>
void CurrentModes<D>::add_tables(Results& results) const {
  const std::string& name = this->settings().name;
  results.charts.emplace_back(name, named_.chart(results, extrapolate_));
  results.tables.emplace_back(name, named_.by_k(results, {"eta", "eta_inf", "exp", "maxwell", "tau",
                                                          "memory", "equipartition"}));
  results.tables.emplace_back(name + "_correlation", correlation_table());
  results.charts.emplace_back(name + "_correlation", correlation_chart(results));
  std::size_t longest = 0;
  for (std::size_t wave = 0; wave < waves_.count(); ++wave)
    longest = std::max(longest, correlator_.lags(wave));
  const Table by_omega =
      named_.moduli(0.1 / (interval() * static_cast<double>(longest)), 1.0 / interval(),
                    [&](std::size_t wave, double omega) {
                      const double eta = results.find(named_.scalar("eta", wave))->mean;
                      const double tau = results.find(named_.scalar("memory", wave))->mean;
                      const double undefined = std::numeric_limits<double>::quiet_NaN();
                      if (!(tau > 0.0)) return std::complex(undefined, undefined);
                      return eta_inf(wave) + (eta - eta_inf(wave)) / std::complex(1.0, omega * tau);
                    });
  results.charts.emplace_back(name + "_moduli", named_.modulus_chart(by_omega, false));
  results.tables.emplace_back(name + "_moduli", by_omega);
}

template <int D>
Table CurrentModes<D>::correlation_table() const {
  const BlockAverage& average = correlator_.average();
  Table table;
  table.comment = {"correlation of currents, transverse and longitudinal, over k^2 kT/m"};
  table.columns = {"number", "t", "c", "c_error", "longitudinal", "longitudinal_error"};
  for (std::size_t wave = 0; wave < waves_.count(); ++wave)
    for (std::size_t lag = 0; lag <= correlator_.lags(wave); ++lag) {
      std::vector<double> row{static_cast<double>(waves_.number(wave)),
                              interval() * static_cast<double>(lag)};
      for (const bool longitudinal : {false, true}) {
        const std::size_t column = correlator_.first_column(wave, longitudinal) + lag;
        row.push_back(average.mean(column));
        row.push_back(average.standard_error(column));
      }
      table.rows.push_back(std::move(row));
    }
  return table;
}

// By reduced time, where all wave numbers of a fluid without memory lie on one line.
template <int D>
Chart CurrentModes<D>::correlation_chart(const Results& results) const {
  const BlockAverage& average = correlator_.average();
  Chart chart{.title = "Correlation of transverse currents",
              .x_label = "eta(k) k^2 t/rho",
              .y_label = "C(k, t)/(k^2 kT/m)",
              .curves = {}};
  for (std::size_t wave = 0; wave < waves_.count(); ++wave) {
    const double rate =
        results.find(named_.scalar("eta", wave))->mean * named_.k[wave] * named_.k[wave] / rho();
    Curve curve{.title = fmt::format("k = {:.4g}", named_.k[wave]),
                .x = {},
                .y = {},
                .error = {},
                .line = true,
                .points = false};
    for (std::size_t lag = 0; lag <= correlator_.lags(wave); ++lag) {
      curve.x.push_back(rate * interval() * static_cast<double>(lag));
      curve.y.push_back(average.mean(correlator_.first_column(wave, false) + lag));
    }
    chart.curves.push_back(std::move(curve));
  }
  Curve line{.title = "exp(-x)",
             .x = {},
             .y = {},
             .error = {},
             .line = true,
             .points = false,
             .backdrop = true};
  constexpr int points = 50;
  for (int n = 0; n <= points; ++n) {
    line.x.push_back(decays_in_window * n / points);
    line.y.push_back(std::exp(-line.x.back()));
  }
  chart.curves.push_back(std::move(line));
  return chart;
}

template <int D>
void CurrentModes<D>::save(StateWriter& out) const {
  out.write("sampled", std::vector<std::int64_t>{samples_});
  out.write("current", current_);
  friction_.save(out, "friction");
  correlator_.save(out);
}

template <int D>
void CurrentModes<D>::load(const StateReader& in) {
  samples_ = in.read_integers("sampled").at(0);
  current_ = in.read_doubles("current");
  if (!current_.empty() && current_.size() != waves_.modes().size())
    throw IoError(
        "the checkpoint's currents do not fit the case's wave numbers: it is damaged or of another "
        "case");
  friction_.load(in, "friction");
  if (samples_ > 0) choose_lags(0.0);  // for the scale: the lags are those of the state
  correlator_.load(in, waves_.count());
}

template class CurrentModes<2>;
template class CurrentModes<3>;

}  // namespace odpd
