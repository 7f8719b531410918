#pragma once
// Rotations of rigid bodies. An angular velocity is a Vec<D> w so that both dimensions read alike: in 2D w = (omega, 0),
// its second component unused; in 3D the vector itself. Torques likewise.
//
//   swing(w, a)  = X(a) w     velocity of a point at arm a
//   torque(a, f) = X(a)^T f   of a force f there
//   Q <- exp(angle) Q         a finite rotation, exact: a unit complex number (2D) or quaternion (3D)
#include <array>
#include <cmath>
#include <span>

#include "odpd/core/vec.h"

namespace odpd {

/// Components of an angular velocity that mean something.
template <int D>
constexpr int rotation_components = D == 2 ? 1 : 3;

inline Vec<2> swing(const Vec<2>& w, const Vec<2>& a) { return {{-w[0] * a[1], w[0] * a[0]}}; }
inline Vec<3> swing(const Vec<3>& w, const Vec<3>& a) {
  return {{w[1] * a[2] - w[2] * a[1], w[2] * a[0] - w[0] * a[2], w[0] * a[1] - w[1] * a[0]}};
}
inline Vec<2> torque(const Vec<2>& a, const Vec<2>& f) {
  return {{a[0] * f[1] - a[1] * f[0], 0.0}};
}
inline Vec<3> torque(const Vec<3>& a, const Vec<3>& f) { return swing(a, f); }

/// Orientation of a body: turns vectors of its frame into those of space.
template <int D>
class Rotation;

template <>
class Rotation<2> {
 public:
  static constexpr std::size_t numbers = 2;
  Vec<2> turn(const Vec<2>& a) const { return {{c_ * a[0] - s_ * a[1], s_ * a[0] + c_ * a[1]}}; }
  /// Q <- exp(angle) Q, normalised.
  void advance(const Vec<2>& angle) {
    const double c = std::cos(angle[0]), s = std::sin(angle[0]);
    const double re = c * c_ - s * s_, im = c * s_ + s * c_;
    const double size = std::sqrt(re * re + im * im);
    c_ = re / size;
    s_ = im / size;
  }
  std::array<double, numbers> values() const { return {c_, s_}; }
  void set(const double* v) {
    c_ = v[0];
    s_ = v[1];
  }

 private:
  double c_ = 1.0, s_ = 0.0;
};

template <>
class Rotation<3> {
 public:
  static constexpr std::size_t numbers = 4;
  Vec<3> turn(const Vec<3>& a) const {
    const Vec<3> u{{q_[1], q_[2], q_[3]}};
    const Vec<3> t = 2.0 * swing(u, a);
    return a + q_[0] * t + swing(u, t);
  }
  /// Q <- exp(angle) Q, normalised.
  void advance(const Vec<3>& angle) {
    const double size = norm(angle);
    // sin(x/2)/x, by its series where x is small.
    const double c = std::cos(0.5 * size);
    const double f = size > 1e-4 ? std::sin(0.5 * size) / size : 0.5 - size * size / 48.0;
    const Vec<3> p = f * angle, v{{q_[1], q_[2], q_[3]}};
    const double re = c * q_[0] - dot(p, v);
    const Vec<3> im = c * v + q_[0] * p + swing(p, v);
    const double length = std::sqrt(re * re + dot(im, im));
    q_ = {re / length, im[0] / length, im[1] / length, im[2] / length};
  }
  std::array<double, numbers> values() const { return q_; }
  void set(const double* v) { q_ = {v[0], v[1], v[2], v[3]}; }

 private:
  std::array<double, numbers> q_{1.0, 0.0, 0.0, 0.0};
};

/// The shortest rotation that turns the direction of `from` into that of `to`, neither of them 0; opposite ones: half a turn, in 3D
/// about some axis across them.
Rotation<2> rotation_onto(const Vec<2>& from, const Vec<2>& to);
Rotation<3> rotation_onto(const Vec<3>& from, const Vec<3>& to);

/// The rotation Q with the smallest sum_k |to_k - Q from_k|^2; at it sum_k torque(Q from_k, to_k) = 0. (3D: the quaternion of
/// Horn 1987, J. Opt. Soc. Am. A 4, 629.) A function of its arguments alone; where several are as good, one of them.
Rotation<2> best_rotation(std::span<const Vec<2>> from, std::span<const Vec<2>> to);
Rotation<3> best_rotation(std::span<const Vec<3>> from, std::span<const Vec<3>> to);

}  // namespace odpd
