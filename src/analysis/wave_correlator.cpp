#include "odpd/analysis/wave_correlator.h"

#include <algorithm>

#include "odpd/core/error.h"

namespace odpd {

WaveCorrelator::WaveCorrelator(std::vector<std::int64_t> lags, std::vector<bool> longitudinal,
                               double scale)
    : lags_(std::move(lags)), longitudinal_(std::move(longitudinal)), scale_(scale) {
  make_room();
}

void WaveCorrelator::make_room() {
  history_.clear();
  for (const std::int64_t last : lags_)
    history_.emplace_back(static_cast<std::size_t>(last + 1) * longitudinal_.size(), 0.0);
  average_ = BlockAverage(waves() == 0 ? 0 : first_column(waves(), false));
}

std::size_t WaveCorrelator::first_column(std::size_t wave, bool longitudinal) const {
  std::size_t column = 0;
  for (std::size_t before = 0; before < wave; ++before) column += 2 * (lags(before) + 1);
  return longitudinal ? column + lags(wave) + 1 : column;
}

void WaveCorrelator::add(std::span<const double> current) {
  const std::size_t modes = longitudinal_.size();
  const auto along =
      static_cast<double>(std::count(longitudinal_.begin(), longitudinal_.end(), true));
  const bool complete = samples_ >= *std::max_element(lags_.begin(), lags_.end());
  std::vector<double> sample(complete ? average_.width() : 0, 0.0);
  std::vector<double> across(modes, 0.0), parallel(modes, 0.0);
  for (std::size_t wave = 0; wave < waves(); ++wave) {
    const std::size_t places = lags(wave) + 1;
    std::vector<double>& history = history_[wave];
    std::size_t place = static_cast<std::size_t>(samples_) % places;
    for (std::size_t m = 0; m < modes; ++m) {
      const double now = current[wave * modes + m];
      history[place * modes + m] = now;
      if (longitudinal_[m])
        parallel[m] = scale_ / along * now;
      else
        across[m] = scale_ / (static_cast<double>(modes) - along) * now;
    }
    if (!complete) continue;
    const std::size_t first = first_column(wave, false);
    for (std::size_t lag = 0; lag < places; ++lag) {
      const double* const then = history.data() + place * modes;
      for (std::size_t m = 0; m < modes; ++m) {
        sample[first + lag] += across[m] * then[m];
        sample[first + places + lag] += parallel[m] * then[m];
      }
      place = place == 0 ? places - 1 : place - 1;
    }
  }
  ++samples_;
  if (complete) average_.add(sample);
}

void WaveCorrelator::save(StateWriter& out) const {
  out.write("lags", lags_);
  out.write("samples", std::vector<std::int64_t>{samples_});
  std::vector<double> all;
  for (const auto& history : history_) all.insert(all.end(), history.begin(), history.end());
  out.write("history", all);
  if (waves() > 0) average_.save(out, "correlation");
}

void WaveCorrelator::load(const StateReader& in, std::size_t waves) {
  lags_ = in.read_integers("lags");
  const std::vector<std::int64_t> samples = in.read_integers("samples");
  const std::vector<double> all = in.read_doubles("history");
  std::size_t places = 0;
  bool sound = true;
  for (const std::int64_t last : lags_) {
    sound = sound && last >= 0;
    places += last < 0 ? 0 : static_cast<std::size_t>(last + 1);
  }
  if (!sound || (!lags_.empty() && lags_.size() != waves) || samples.size() != 1 ||
      all.size() != places * longitudinal_.size())
    throw IoError(
        "the checkpoint's currents do not fit the case's wave numbers: it is damaged or of another "
        "case");
  make_room();
  samples_ = samples[0];
  auto from = all.begin();
  for (auto& history : history_) {
    std::copy_n(from, history.size(), history.begin());
    from += std::ssize(history);
  }
  if (!lags_.empty()) average_.load(in, "correlation");
}

}  // namespace odpd
