#pragma once
// The monotone cubic spline through points (x_k, y_k) (Fritsch & Carlson 1980): once continuously differentiable, and between two points
// it rises or falls as they do. With t = x - x_k, h = x_{k+1} - x_k and s_k = (y_{k+1} - y_k)/h,
//
//   y = y_k + m_k t + c t^2 + d t^3,   c = (3 s_k - 2 m_k - m_{k+1})/h,   d = (m_k + m_{k+1} - 2 s_k)/h^2
//
// m_k is the slope of the parabola through three points, where that keeps y monotone: 0 where s_{k-1} and s_k differ in sign, and else
// at most three times the smaller of them (the square in their figure 2). For smooth y its error is of order h^3, near extrema h^2.
#include <cstddef>
#include <vector>

namespace odpd {

class MonotoneSpline {
 public:
  struct Value {
    double y = 0.0;
    double first = 0.0, second = 0.0;  ///< dy/dx, d^2y/dx^2
    double rest = 0.0;                 ///< integral of y from x to the last point
  };

  /// Throws ConfigError unless there are as many y as x, two or more, x ascends and all are finite.
  MonotoneSpline(std::vector<double> x, const std::vector<double>& y);

  /// Outside of the points the cubic of the first or last interval goes on.
  Value operator()(double x) const;
  const std::vector<double>& points() const { return x_; }

 private:
  struct Cubic {
    double y, m, c, d;
    double rest;  // from the end of the interval to the last point
  };

  std::size_t interval(double x) const;

  std::vector<double> x_;
  std::vector<Cubic> cubics_;
  // Where to look: of as many equal parts of the range as it has intervals, that in which each begins.
  std::vector<std::ptrdiff_t> bucket_;
  double buckets_per_length_ = 0.0;
};

}  // namespace odpd
