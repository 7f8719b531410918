#include "odpd/analysis/mode_growth.h"

#include <algorithm>
#include <cmath>

#include "odpd/analysis/least_squares.h"
#include "odpd/core/error.h"

namespace odpd {

namespace {

constexpr std::int64_t most_growth_lags = 50;

// A multiple of the steps between controlled ones, for about most_growth_lags of them in a window.
std::int64_t steps_between_lags(const ModeGrowth::Settings& s) {
  const std::int64_t together = std::max<std::int64_t>(1, s.control_every);
  return together *
         std::max<std::int64_t>(1, std::llround(s.window / s.dt) / (together * most_growth_lags));
}

// One more of the last lag times.
void keep(std::vector<double>& history, const std::vector<double>& now) {
  history.insert(history.end(), now.begin(), now.end());
}

}  // namespace

ModeGrowth::ModeGrowth(const Settings& settings)
    : settings_(settings),
      steps_per_lag_(steps_between_lags(settings)),
      lags_(static_cast<std::size_t>(std::max<std::int64_t>(
          2, std::llround(settings.window / (settings.dt * static_cast<double>(steps_per_lag_)))))),
      integral_(settings.waves * settings.modes_per_wave, 0.0),
      history_(integral_),
      response_(settings.waves, 0.0),
      near_(settings.waves, 0.0),
      average_(settings.waves * width()) {
  drift_ = square_ = last_ = before_ = drift_history_ = square_history_ = integral_;
  std::vector<double> t;
  for (std::size_t lag = 1; lag <= lags_; ++lag)
    if (lag_time(lag) >= settings.fit_from || lag + 1 >= lags_) t.push_back(lag_time(lag));
  const std::vector<double> even(t.size(), 1.0);
  const PolynomialFit line = fit_polynomial(1, t, even, even);
  weight_.assign(lags_ - t.size(), 0.0);
  offset_weight_ = weight_;
  weight_.insert(weight_.end(), line.weight[1].begin(), line.weight[1].end());
  offset_weight_.insert(offset_weight_.end(), line.weight[0].begin(), line.weight[0].end());
}

double ModeGrowth::lag_time(std::size_t lag) const {
  return settings_.dt * static_cast<double>(steps_per_lag_) * static_cast<double>(lag);
}

void ModeGrowth::add(std::span<const double> growth, std::span<const double> made,
                     std::span<const double> response) {
  if (control_is_due()) control(growth, made, response);
  for (std::size_t m = 0; m < integral_.size(); ++m) integral_[m] += growth[m];
  if (++steps_ % steps_per_lag_ == 0) add_sample();
}

void ModeGrowth::control(std::span<const double> growth, std::span<const double> made,
                         std::span<const double> response) {
  const double share = 1.0 / static_cast<double>(settings_.modes_per_wave);
  // Two steps of the same c are (c + 1)/3 apart in the mean.
  const auto every = static_cast<double>(settings_.control_every);
  const double back = 1.0 - (every + 1.0) / (3.0 * every);
  for (std::size_t m = 0; m < integral_.size(); ++m) {
    const std::size_t wave = m / settings_.modes_per_wave;
    const double d = growth[m] - made[m];
    response_[wave] += share * response[m];
    near_[wave] += share * d * ((1.0 + back) * last_[m] - back * before_[m]);
    drift_[m] += d;
    square_[m] += d * d;
    before_[m] = last_[m];
    last_[m] = d;
  }
}

// At a lag time.
void ModeGrowth::add_sample() {
  const std::size_t n = integral_.size();
  keep(history_, integral_);
  if (controlled()) {
    keep(drift_history_, drift_);
    keep(square_history_, square_);
  }
  std::vector<double> response(settings_.waves, 0.0), near(settings_.waves, 0.0);
  response.swap(response_);
  near.swap(near_);
  if (history_.size() < (lags_ + 1) * n) return;
  std::vector<double> sample(average_.width(), 0.0);
  const double scale = 1.0 / (2.0 * settings_.kT * static_cast<double>(settings_.modes_per_wave));
  const auto every = static_cast<double>(settings_.control_every);
  const double sign = settings_.drift_adds ? 1.0 : -1.0;
  for (std::size_t m = 0; m < n; ++m) {
    double* const of_wave = sample.data() + m / settings_.modes_per_wave * width();
    for (std::size_t lag = 1; lag <= lags_; ++lag) {
      const std::size_t then = (lags_ - lag) * n + m;
      const double growth = integral_[m] - history_[then];
      of_wave[lag - 1] += scale * growth * growth;
      if (!controlled()) continue;
      const double drift = drift_[m] - drift_history_[then];
      const double square = square_[m] - square_history_[then];
      of_wave[lags_ + lag] += sign * scale * every * every * (drift * drift - square);
    }
  }
  for (std::size_t wave = 0; wave < settings_.waves; ++wave) {
    const std::span<double> of_wave(sample.data() + wave * width(), width());
    for (std::size_t lag = 1; lag <= lags_; ++lag)
      of_wave[lags_] += weight_[lag - 1] * of_wave[lag - 1];
    if (controlled()) finish_control(of_wave, response[wave], near[wave]);
  }
  average_.add(sample);
  for (auto* history : {&history_, &drift_history_, &square_history_})
    if (history->size() > lags_ * n)
      history->erase(history->begin(), history->begin() + static_cast<std::ptrdiff_t>(n));
}

// From what pairs of controlled steps give to chi(t), and its slope. response, near: sums since the lag time before.
void ModeGrowth::finish_control(std::span<double> of_wave, double response, double near) const {
  const auto every = static_cast<double>(settings_.control_every);
  const double steps = static_cast<double>(steps_per_lag_) / every;
  const double chi_0 = response / steps;
  // Each of c steps has c - 1 others that no pair of controlled ones stands for.
  const double nearer = (settings_.drift_adds ? 1.0 : -1.0) * (every - 1.0) * near / steps /
                        (2.0 * settings_.kT * settings_.dt);
  for (std::size_t lag = 1; lag <= lags_; ++lag) {
    double& chi = of_wave[lags_ + lag];
    chi = chi_0 + nearer + chi / lag_time(lag);
    of_wave[2 * lags_ + 1] += weight_[lag - 1] * lag_time(lag) * chi;
    of_wave[2 * lags_ + 3] += offset_weight_[lag - 1] * lag_time(lag) * chi;
  }
  of_wave[2 * lags_ + 2] = chi_0;
}

ModeGrowth::Estimate ModeGrowth::estimate(std::size_t column, double scale) const {
  if (samples() == 0) return {};
  return {scale * average_.mean(column), scale * average_.standard_error(column)};
}

ModeGrowth::Estimate ModeGrowth::memory_time(std::size_t wave) const {
  if (samples() == 0) return {};
  const auto tau = [](double chi, double chi_0, double offset) { return offset / (chi_0 - chi); };
  const std::size_t at = best(wave);
  return {tau(average_.mean(at), average_.mean(at + 1), average_.mean(at + 2)),
          average_.jackknife_error([&](const std::vector<double>& means) {
            return tau(means[at], means[at + 1], means[at + 2]);
          })};
}

ModeGrowth::Estimate ModeGrowth::at_lag(std::size_t wave, std::size_t lag) const {
  if (controlled()) return estimate(wave * width() + lags_ + lag, 1.0);
  return estimate(wave * width() + lag - 1, 1.0 / lag_time(lag));
}

double ModeGrowth::error_of(
    const std::function<double(const std::vector<double>&)>& function) const {
  return average_.jackknife_error([&](const std::vector<double>& means) {
    std::vector<double> chi;
    for (std::size_t wave = 0; wave < settings_.waves; ++wave) chi.push_back(means[best(wave)]);
    return function(chi);
  });
}

void ModeGrowth::save(StateWriter& out, const std::string& prefix) const {
  out.write(prefix + "steps", std::vector<std::int64_t>{steps_});
  out.write(prefix + "integral", integral_);
  out.write(prefix + "history", history_);
  average_.save(out, prefix + "growth");
  if (!controlled()) return;
  out.write(prefix + "drift", drift_);
  out.write(prefix + "square", square_);
  out.write(prefix + "last", last_);
  out.write(prefix + "before", before_);
  out.write(prefix + "drift_history", drift_history_);
  out.write(prefix + "square_history", square_history_);
  out.write(prefix + "response", response_);
  out.write(prefix + "near", near_);
}

void ModeGrowth::load(const StateReader& in, const std::string& prefix) {
  const std::size_t n = integral_.size();
  const std::vector<std::int64_t> steps = in.read_integers(prefix + "steps");
  bool fits = steps.size() == 1;
  const auto fill = [&](const std::string& name, std::vector<double>& values, std::size_t size) {
    values = in.read_doubles(prefix + name);
    fits = fits && values.size() == size;
  };
  fill("integral", integral_, n);
  history_ = in.read_doubles(prefix + "history");
  fits = fits && history_.size() % n == 0 && !history_.empty() && history_.size() <= lags_ * n;
  if (controlled()) {
    fill("drift", drift_, n);
    fill("square", square_, n);
    fill("last", last_, n);
    fill("before", before_, n);
    fill("drift_history", drift_history_, history_.size());
    fill("square_history", square_history_, history_.size());
    fill("response", response_, settings_.waves);
    fill("near", near_, settings_.waves);
  }
  if (!fits)
    throw IoError(
        "what the checkpoint has of growing integrals does not fit the case's observers and their "
        "window: it is damaged or of another case");
  steps_ = steps[0];
  average_.load(in, prefix + "growth");
}

}  // namespace odpd
