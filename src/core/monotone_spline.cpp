#include "odpd/core/monotone_spline.h"

#include <algorithm>
#include <cmath>

#include "odpd/core/error.h"
#include "odpd/core/index.h"

namespace odpd {

namespace {

// `slope`, so far as the spline stays monotone beside the secants `before` and `after` of a point.
double limited_slope(double slope, double before, double after) {
  if (!(before * after > 0.0)) return 0.0;
  const double most = 3.0 * std::min(std::abs(before), std::abs(after));
  return before > 0.0 ? std::clamp(slope, 0.0, most) : std::clamp(slope, -most, 0.0);
}

// From x_k + t on to x_k + h.
double cubic_integral(double y, double m, double c, double d, double t, double h) {
  const auto antiderivative = [&](double x) {
    return x * (y + x * (m / 2.0 + x * (c / 3.0 + x * d / 4.0)));
  };
  return antiderivative(h) - antiderivative(t);
}

}  // namespace

MonotoneSpline::MonotoneSpline(std::vector<double> x, const std::vector<double>& y)
    : x_(std::move(x)) {
  const std::size_t n = x_.size();
  if (n < 2 || y.size() != n) throw ConfigError("a spline needs two points or more");
  std::vector<double> width(n - 1), secant(n - 1);
  for (std::size_t k = 0; k + 1 < n; ++k) {
    width[k] = x_[k + 1] - x_[k];
    secant[k] = (y[k + 1] - y[k]) / width[k];
    if (!(width[k] > 0.0) || !std::isfinite(width[k]) || !std::isfinite(secant[k]))
      throw ConfigError("the points of a spline must be finite, in ascending order of x");
  }
  buckets_per_length_ = static_cast<double>(n - 1) / (x_.back() - x_.front());
  for (std::size_t b = 0; b < n; ++b) {
    const double left = x_[0] + static_cast<double>(b) / buckets_per_length_;
    bucket_.push_back(std::upper_bound(x_.begin() + 1, x_.end() - 1, left) - x_.begin() - 1);
  }
  std::vector<double> slope(n, secant[0]);
  for (std::size_t k = 0; k < n && n > 2; ++k) {
    // The parabola of an end is that of the point next to it.
    const std::size_t before = k == 0 ? 0 : k + 1 == n ? n - 3 : k - 1, after = before + 1;
    const double bend = (secant[after] - secant[before]) / (width[before] + width[after]);
    const double parabola = k == 0       ? secant[0] - bend * width[0]
                            : k + 1 == n ? secant[n - 2] + bend * width[n - 2]
                                         : secant[before] + bend * width[before];
    slope[k] = k == 0       ? limited_slope(parabola, secant[0], secant[0])
               : k + 1 == n ? limited_slope(parabola, secant[n - 2], secant[n - 2])
                            : limited_slope(parabola, secant[before], secant[after]);
  }
  cubics_.resize(n - 1);
  double rest = 0.0;
  for (std::size_t k = n - 1; k-- > 0;) {
    const double h = width[k], m = slope[k];
    const double c = (3.0 * secant[k] - 2.0 * m - slope[k + 1]) / h;
    const double d = (m + slope[k + 1] - 2.0 * secant[k]) / (h * h);
    cubics_[k] = {y[k], m, c, d, rest};
    rest += cubic_integral(y[k], m, c, d, 0.0, h);
  }
}

std::size_t MonotoneSpline::interval(double x) const {
  const double last = static_cast<double>(cubics_.size() - 1);
  const auto b = static_cast<std::size_t>(std::clamp((x - x_[0]) * buckets_per_length_, 0.0, last));
  const auto above =
      std::upper_bound(x_.begin() + bucket_[b] + 1, x_.begin() + bucket_[b + 1] + 1, x);
  return index(above - x_.begin()) - 1;
}

MonotoneSpline::Value MonotoneSpline::operator()(double x) const {
  const std::size_t k = interval(x);
  const auto& [y, m, c, d, rest] = cubics_[k];
  const double t = x - x_[k];
  return {y + t * (m + t * (c + t * d)), m + t * (2.0 * c + t * 3.0 * d), 2.0 * c + 6.0 * d * t,
          rest + cubic_integral(y, m, c, d, t, x_[k + 1] - x_[k])};
}

}  // namespace odpd
