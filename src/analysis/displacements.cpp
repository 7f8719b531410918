#include "odpd/analysis/displacements.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "odpd/analysis/least_squares.h"
#include "odpd/core/error.h"
#include "odpd/core/index.h"

namespace odpd {

Displacements::Displacements(std::string owner, double window, double fit_from, double lag_time,
                             std::size_t kinds)
    : owner_(std::move(owner)),
      fit_from_(fit_from),
      lag_time_(lag_time),
      lags_(std::max<std::int64_t>(1, std::llround(window / lag_time))),
      kinds_(kinds),
      window_(index(lags_) * kinds, 0.0),
      curve_(window_.size()),
      diffusion_(kinds + 1) {}

bool Displacements::add_sums(std::span<const double> sum, std::span<const double> population,
                             std::size_t components) {
  newest_.clear();
  if (begun_) {
    for (std::size_t a = 0; a < kinds_; ++a)
      window_[index(lag_) * kinds_ + a] =
          population[a] > 0.0 ? sum[a] / population[a] : std::nan("");
    if (++lag_ < lags_) return false;
    finish_window(population, components);
  }
  begun_ = true;
  lag_ = 0;
  return true;
}

void Displacements::add(std::vector<double> now, std::span<const std::int32_t> kind,
                        std::size_t width, std::span<const int> components) {
  std::vector<double> sum(kinds_, 0.0), population(kinds_, 0.0);
  for (std::size_t n = 0; n < kind.size() && begun_; ++n) {
    if (kind[n] < 0) continue;
    population[index(kind[n])] += 1.0;
    for (const int c : components) {
      const std::size_t at = n * width + index(c);
      const double path = now[at] - origin_[at];
      sum[index(kind[n])] += path * path;
    }
  }
  if (add_sums(sum, population, components.size())) origin_ = std::move(now);
}

void Displacements::finish_window(std::span<const double> population, std::size_t components) {
  curve_.add(window_);
  std::vector<double> value(kinds_ + 1, 0.0);
  double everyone = 0.0;
  for (std::size_t a = 0; a < kinds_; ++a) {
    std::vector<double> t, y;
    for (std::int64_t k = 0; k < lags_; ++k) {
      if (lag(k) < fit_from_ && k + 2 < lags_) continue;
      t.push_back(lag(k));
      y.push_back(window_[index(k) * kinds_ + a]);
    }
    const std::vector<double> even(t.size(), 1.0);
    const double slope = t.size() > 1 ? fit_polynomial(1, t, y, even).coefficient[1] : y[0] / t[0];
    value[a] = slope / (2.0 * static_cast<double>(components));
    if (population[a] > 0.0) value[kinds_] += population[a] * value[a];
    everyone += population[a];
  }
  value[kinds_] /= everyone;
  diffusion_.add(value);
  newest_ = value;
}

Table Displacements::table(std::span<const std::string> kinds) const {
  Table t;
  t.columns = {"lag"};
  for (std::int64_t k = 0; k < lags_; ++k) t.rows.push_back({lag(k)});
  for (std::size_t a = 0; a < kinds.size(); ++a) {
    t.columns.insert(t.columns.end(), {"msd_" + kinds[a], "msd_" + kinds[a] + "_error"});
    for (std::size_t k = 0; k < t.rows.size(); ++k) {
      const std::size_t column = k * kinds_ + a;
      t.rows[k].insert(t.rows[k].end(), {curve_.mean(column), curve_.standard_error(column)});
    }
  }
  return t;
}

void Displacements::save(StateWriter& out, const std::string& prefix) const {
  out.write(prefix + "lag", std::vector<std::int64_t>{lag_});
  out.write(prefix + "begun", std::vector<std::int64_t>{begun_ ? 1 : 0});
  if (!origin_.empty()) out.write(prefix + "origin", origin_);
  out.write(prefix + "window", window_);
  curve_.save(out, prefix + "curve");
  diffusion_.save(out, prefix + "diffusion");
}

void Displacements::load(const StateReader& in, const std::string& prefix,
                         std::size_t coordinates) {
  const std::vector<std::int64_t> lag = in.read_integers(prefix + "lag");
  const std::vector<std::int64_t> begun = in.read_integers(prefix + "begun");
  origin_.clear();
  if (in.has(prefix + "origin")) origin_ = in.read_doubles(prefix + "origin");
  window_ = in.read_doubles(prefix + "window");
  if (lag.size() != 1 || begun.size() != 1 || lag[0] < 0 || lag[0] >= lags_ ||
      origin_.size() != (begun[0] != 0 ? coordinates : 0) ||
      window_.size() != index(lags_) * kinds_)
    throw IoError(
        fmt::format("the checkpoint's displacements '{}' do not fit the case's particles and "
                    "window: it is damaged or of another case",
                    owner_));
  lag_ = lag[0];
  begun_ = begun[0] != 0;
  curve_.load(in, prefix + "curve");
  diffusion_.load(in, prefix + "diffusion");
}

}  // namespace odpd
