#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "odpd/core/error.h"
#include "odpd/core/monotone_spline.h"
#include "odpd/core/quadrature.h"

namespace {

using odpd::MonotoneSpline;

// Unevenly spaced, with a plateau, a step, and extrema.
const std::vector<double> uneven_x{0.0, 0.1, 0.15, 0.4, 0.45, 0.9, 1.0, 1.6, 2.0};
const std::vector<double> uneven_y{3.0, 3.0, 2.9, -4.0, -4.1, -1.0, 7.0, 7.1, 2.0};

template <class Function>
MonotoneSpline spline_of(const Function& f, double a, double b, std::size_t intervals) {
  std::vector<double> x, y;
  for (std::size_t k = 0; k <= intervals; ++k) {
    x.push_back(a + (b - a) * static_cast<double>(k) / static_cast<double>(intervals));
    y.push_back(f(x.back()));
  }
  return {x, y};
}

TEST(MonotoneSpline, GoesThroughThePointsWithOneSlopeAndStaysBetweenThem) {
  const MonotoneSpline spline(uneven_x, uneven_y);
  for (std::size_t k = 0; k < uneven_x.size(); ++k) {
    EXPECT_NEAR(spline(uneven_x[k]).y, uneven_y[k], 1e-14);
    if (k == 0 || k + 1 == uneven_x.size()) continue;
    const auto before = spline(uneven_x[k] - 1e-12), after = spline(uneven_x[k] + 1e-12);
    EXPECT_NEAR(before.y, after.y, 1e-9);
    EXPECT_NEAR(before.first, after.first, 1e-7);
    EXPECT_NEAR(before.rest, after.rest, 1e-10);
  }
  for (std::size_t k = 0; k + 1 < uneven_x.size(); ++k) {
    const double sign = uneven_y[k + 1] - uneven_y[k];
    double last = uneven_y[k];
    for (int part = 1; part <= 50; ++part) {
      const double x = uneven_x[k] + (uneven_x[k + 1] - uneven_x[k]) * part / 50.0;
      EXPECT_GE((spline(x).y - last) * sign, -1e-12) << x;
      last = spline(x).y;
    }
  }
}

TEST(MonotoneSpline, ItsDerivativesAndIntegralAreItsOwn) {
  const MonotoneSpline spline(uneven_x, uneven_y);
  constexpr double h = 1e-5;
  for (const double x : {0.05, 0.12, 0.3, 0.42, 0.7, 0.95, 1.3, 1.9}) {
    const auto before = spline(x - h), at = spline(x), after = spline(x + h);
    EXPECT_NEAR(at.first, (after.y - before.y) / (2.0 * h), 1e-4);
    EXPECT_NEAR(at.second, (after.first - before.first) / (2.0 * h), 1e-5);
    double rest = 0.0, from = x;
    for (const double end : uneven_x) {
      if (end <= from) continue;
      rest += odpd::integrate<1>([&](double r) { return std::array{spline(r).y}; }, from, end)[0];
      from = end;
    }
    EXPECT_NEAR(at.rest, rest, 1e-12);
  }
  EXPECT_EQ(spline(2.0).rest, 0.0);
}

TEST(MonotoneSpline, TakesAParabolaAsItIs) {
  const auto parabola = [](double x) { return 18.5 / 2.0 * (1.0 - x) * (1.0 - x); };
  const MonotoneSpline spline({0.0, 0.2, 0.25, 0.7, 1.0},
                              {parabola(0.0), parabola(0.2), parabola(0.25), parabola(0.7), 0.0});
  for (const double x : {0.0, 0.1, 0.22, 0.5, 0.99}) {
    EXPECT_NEAR(spline(x).y, parabola(x), 1e-13);
    EXPECT_NEAR(spline(x).first, -18.5 * (1.0 - x), 1e-12);
    EXPECT_NEAR(spline(x).second, 18.5, 1e-11);
    EXPECT_NEAR(spline(x).rest, 18.5 / 6.0 * std::pow(1.0 - x, 3), 1e-13);
  }
}

TEST(MonotoneSpline, ItsErrorIsOfThirdOrder) {
  const auto largest_error = [](std::size_t intervals) {
    const MonotoneSpline spline =
        spline_of([](double x) { return std::exp(-x); }, 0.0, 2.0, intervals);
    double largest = 0.0;
    for (int k = 0; k <= 1000; ++k)
      largest = std::max(largest, std::abs(spline(0.002 * k).y - std::exp(-0.002 * k)));
    return largest;
  };
  EXPECT_GT(largest_error(20) / largest_error(40), 7.0);
  EXPECT_LT(largest_error(40), 2e-5);
}

// Intervals are looked up by parts of the range: here most of the points lie in one.
TEST(MonotoneSpline, FindsIntervalsOfAnySpacing) {
  std::vector<double> x{0.0}, y{0.0};
  for (double r = 1e-6; r < 10.0; r *= 1.1) {
    x.push_back(r);
    y.push_back(std::sqrt(r));
  }
  const MonotoneSpline spline(x, y);
  for (std::size_t k = 0; k < x.size(); ++k) {
    EXPECT_NEAR(spline(x[k]).y, y[k], 1e-15);
    if (k > 2) {
      const double middle = 0.5 * (x[k] + x[k - 1]);
      EXPECT_NEAR(spline(middle).y, std::sqrt(middle), 1e-4 * std::sqrt(middle));
    }
  }
}

TEST(MonotoneSpline, RefusesWhatIsNoTable) {
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_THROW(MonotoneSpline({1.0}, {1.0}), odpd::ConfigError);
  EXPECT_THROW(MonotoneSpline({1.0, 2.0}, {1.0}), odpd::ConfigError);
  EXPECT_THROW(MonotoneSpline({1.0, 1.0}, {1.0, 2.0}), odpd::ConfigError);
  EXPECT_THROW(MonotoneSpline({1.0, 0.5, 2.0}, {1.0, 2.0, 3.0}), odpd::ConfigError);
  EXPECT_THROW(MonotoneSpline({1.0, 2.0}, {1.0, inf}), odpd::ConfigError);
  EXPECT_THROW(MonotoneSpline({0.0, 1.0, inf}, {1.0, 0.5, 0.0}), odpd::ConfigError);
  EXPECT_THROW(MonotoneSpline({1.0, 2.0}, {1.0, std::nan("")}), odpd::ConfigError);
}

}  // namespace
