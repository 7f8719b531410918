#include "odpd/analysis/helfand.h"

#include <algorithm>
#include <cmath>

#include "odpd/analysis/least_squares.h"
#include "odpd/core/error.h"

namespace odpd {

Helfand::Helfand(const Settings& settings, std::size_t components)
    : settings_(settings),
      lags_(static_cast<std::size_t>(std::max<std::int64_t>(
          2, std::llround(settings.window /
                          (settings.dt * static_cast<double>(settings.steps_per_lag)))))),
      integral_(components, 0.0),
      history_(components, 0.0),
      weight_(lags_, 0.0),
      average_(lags_ + 1) {
  std::vector<double> t;
  for (std::size_t lag = 1; lag <= lags_; ++lag)
    if (lag_time(lag) >= settings_.fit_from || lag + 1 >= lags_) t.push_back(lag_time(lag));
  const std::vector<double> even(t.size(), 1.0);
  const std::vector<double> weight = fit_polynomial(1, t, even, even).weight[1];
  std::copy(weight.begin(), weight.end(),
            weight_.end() - static_cast<std::ptrdiff_t>(weight.size()));
}

double Helfand::lag_time(std::size_t lag) const {
  return settings_.dt * static_cast<double>(settings_.steps_per_lag) * static_cast<double>(lag);
}

void Helfand::add(std::span<const double> stress) {
  const std::size_t n = integral_.size();
  for (std::size_t c = 0; c < n; ++c) integral_[c] += settings_.volume * settings_.dt * stress[c];
  if (++steps_ < settings_.steps_per_lag) return;
  steps_ = 0;
  history_.insert(history_.end(), integral_.begin(), integral_.end());
  if (history_.size() < (lags_ + 1) * n) return;
  std::vector<double> sample(lags_ + 1, 0.0);
  const double scale = 1.0 / (2.0 * settings_.volume * settings_.kT * static_cast<double>(n));
  for (std::size_t lag = 1; lag <= lags_; ++lag) {
    for (std::size_t c = 0; c < n; ++c) {
      const double growth = integral_[c] - history_[(lags_ - lag) * n + c];
      sample[lag - 1] += scale * growth * growth;
    }
    sample[lags_] += weight_[lag - 1] * sample[lag - 1];
  }
  average_.add(sample);
  history_.erase(history_.begin(), history_.begin() + static_cast<std::ptrdiff_t>(n));
}

Scalar Helfand::viscosity(std::string name) const {
  if (samples() == 0) return {std::move(name), std::nan(""), std::nan("")};
  return {std::move(name), average_.mean(lags_), average_.standard_error(lags_)};
}

Table Helfand::table() const {
  Table table;
  table.comment = {
      "growth of the integrated stress, <(dG)^2>/(2 V kT); its slope is the viscosity"};
  table.columns = {"lag", "growth", "growth_error"};
  for (std::size_t lag = 1; lag <= lags_; ++lag)
    table.rows.push_back({lag_time(lag), average_.mean(lag - 1), average_.standard_error(lag - 1)});
  return table;
}

Chart Helfand::chart() const {
  Chart chart{.title = "Growth of the integrated stress",
              .x_label = "lag",
              .y_label = "<dG^2> / (2 V kT)",
              .curves = {}};
  Curve curve{.title = "measured", .x = {}, .y = {}, .error = {}};
  for (const auto& row : table().rows) {
    curve.x.push_back(row[0]);
    curve.y.push_back(row[1]);
  }
  chart.curves.push_back(std::move(curve));
  return chart;
}

void Helfand::save(StateWriter& out) const {
  out.write("integral", integral_);
  out.write("history", history_);
  out.write("steps", std::vector<std::int64_t>{steps_});
  average_.save(out, "growth");
}

void Helfand::load(const StateReader& in) {
  const std::size_t n = integral_.size();
  integral_ = in.read_doubles("integral");
  history_ = in.read_doubles("history");
  const std::vector<std::int64_t> steps = in.read_integers("steps");
  if (integral_.size() != n || history_.size() % n != 0 || history_.size() > (lags_ + 1) * n ||
      history_.empty() || steps.size() != 1)
    throw IoError(
        "the checkpoint's integrated stress does not fit the case's window: it is damaged or of "
        "another case");
  steps_ = steps[0];
  average_.load(in, "growth");
}

}  // namespace odpd
