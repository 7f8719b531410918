#pragma once
// Smoothing kernels of a density sum: W(r) of compact support h, with an integral of 1 over d-dimensional space. With q = r/h < 1
//
//   wendland-c2   s (1 - q)^4 (1 + 4 q)                            s h^d = 7/pi, 21/(2 pi)   in 2D, 3D
//   wendland-c4   s (1 - q)^6 (1 + 6 q + 35/3 q^2)                         9/pi, 495/(32 pi)
//   lucy          s (1 - q)^3 (1 + 3 q)                                    5/pi, 105/(16 pi)
//   quintic       s [(3 - x)^5 - 6 (2 - x)^5 + 15 (1 - x)^5]               63/(478 pi), 9/(40 pi)
//
// with x = 3 q, each term of the last only where its base is positive (Lucy 1977; Wendland 1995; Morris, Fox & Zhu 1997). All have a slope that
// vanishes as r at r = 0, so that F = -W'/r is finite there.
#include <span>
#include <string>
#include <vector>

#include "odpd/pairs/densities.h"
#include "odpd/pairs/weight_columns.h"

namespace odpd {

class SmoothingKernel {
 public:
  enum class Shape { wendland_c2, wendland_c4, lucy, quintic };

  /// support: h (length). Throws ConfigError unless it is positive and dimension 2 or 3.
  SmoothingKernel(Shape shape, int dimension, double support);

  double support() const { return support_; }
  Shape shape() const { return shape_; }
  /// W, W' and W'' at r >= 0; zero from h on.
  Derivatives operator()(double r) const;
  /// F = -W'/r >= 0 at r >= 0 (1/length^(d + 2)).
  double slope(double r) const;
  /// All of these distances at once.
  void operator()(std::span<const double> r, const WeightColumns& columns) const;

  bool operator==(const SmoothingKernel&) const = default;

 private:
  Shape shape_;
  double support_, scale_;  // h, s
};

/// In the order of the shapes.
const std::vector<std::string>& smoothing_kernel_names();

inline double SmoothingKernel::slope(double r) const {
  const double q = r / support_, p = 1.0 - q;
  if (!(p > 0.0)) return 0.0;
  const double s = scale_ / (support_ * support_);
  switch (shape_) {
    case Shape::wendland_c2:
      return s * 20.0 * p * p * p;
    case Shape::wendland_c4:
      return s * 56.0 / 3.0 * p * p * p * p * p * (1.0 + 5.0 * q);
    case Shape::lucy:
      return s * 12.0 * p * p;
    case Shape::quintic:
      break;
  }
  // The fourth powers, less what vanishes at q = 0 so that the division by q is one of polynomials there.
  const double x = 3.0 * q;
  if (x < 1.0) return s * 45.0 * (24.0 + x * x * (-24.0 + 10.0 * x));
  const auto fourth = [](double y) { return y > 0.0 ? y * y * y * y : 0.0; };
  return s * 45.0 * (fourth(3.0 - x) - 6.0 * fourth(2.0 - x)) / x;
}

inline Derivatives SmoothingKernel::operator()(double r) const {
  const double q = r / support_, p = 1.0 - q;
  if (!(p > 0.0)) return {};
  const double s = scale_, s2 = s / (support_ * support_), p2 = p * p, p3 = p2 * p;
  switch (shape_) {
    case Shape::wendland_c2:
      return {s * p2 * p2 * (1.0 + 4.0 * q), -s2 * 20.0 * r * p3,
              -s2 * 20.0 * p2 * (1.0 - 4.0 * q)};
    case Shape::wendland_c4: {
      const double p4 = p2 * p2;
      return {s * p4 * p2 * (1.0 + q * (6.0 + 35.0 / 3.0 * q)),
              -s2 * 56.0 / 3.0 * r * p4 * p * (1.0 + 5.0 * q),
              -s2 * 56.0 / 3.0 * p4 * (1.0 + q * (4.0 - 35.0 * q))};
    }
    case Shape::lucy:
      return {s * p3 * (1.0 + 3.0 * q), -s2 * 12.0 * r * p2, -s2 * 12.0 * p * (1.0 - 3.0 * q)};
    case Shape::quintic:
      break;
  }
  const auto terms = [x = 3.0 * q](auto power) {
    const auto of = [&](double y) { return y > 0.0 ? power(y) : 0.0; };
    return of(3.0 - x) - 6.0 * of(2.0 - x) + 15.0 * of(1.0 - x);
  };
  const double value = terms([](double y) { return y * y * y * y * y; }),
               second = terms([](double y) { return y * y * y; });
  return {s * value, -r * slope(r), s2 * 180.0 * second};
}

}  // namespace odpd
