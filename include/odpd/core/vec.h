#pragma once
// Small fixed-size vectors: a point, velocity or force in D = 2 or 3 dimensions.
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "odpd/core/index.h"

namespace odpd {

/// D Cartesian components, contiguous (an array of Vec<D> is a flat array of doubles).
template <int D>
struct Vec {
  std::array<double, D> x{};

  double& operator[](int c) { return x[index(c)]; }
  double operator[](int c) const { return x[index(c)]; }

  Vec& operator+=(const Vec& b) {
    for (int c = 0; c < D; ++c) (*this)[c] += b[c];
    return *this;
  }
  Vec& operator-=(const Vec& b) {
    for (int c = 0; c < D; ++c) (*this)[c] -= b[c];
    return *this;
  }
  Vec& operator*=(double s) {
    for (int c = 0; c < D; ++c) (*this)[c] *= s;
    return *this;
  }
  friend Vec operator+(Vec a, const Vec& b) { return a += b; }
  friend Vec operator-(Vec a, const Vec& b) { return a -= b; }
  friend Vec operator*(double s, Vec a) { return a *= s; }
  friend Vec operator*(Vec a, double s) { return a *= s; }
  friend bool operator==(const Vec&, const Vec&) = default;
};

template <int D>
double dot(const Vec<D>& a, const Vec<D>& b) {
  double s = 0.0;
  for (int c = 0; c < D; ++c) s += a[c] * b[c];
  return s;
}

template <int D>
double norm(const Vec<D>& a) {
  return std::sqrt(dot(a, a));
}

/// Volume of a ball of radius 1: pi (2D), 4 pi/3 (3D).
template <int D>
constexpr double unit_ball_volume = D == 2 ? std::numbers::pi : 4.0 * std::numbers::pi / 3.0;

/// True when no component is NaN or infinite.
template <int D>
bool finite(const Vec<D>& a) {
  for (int c = 0; c < D; ++c)
    if (!std::isfinite(a[c])) return false;
  return true;
}

}  // namespace odpd
