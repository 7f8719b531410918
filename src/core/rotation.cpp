#include "odpd/core/rotation.h"

#include <algorithm>
#include <numbers>

namespace odpd {

namespace {

using Matrix4 = std::array<std::array<double, 4>, 4>;

// One rotation of Jacobi's in the plane of p and q, which makes m[p][q] zero; the columns of v turn with it.
void annihilate(Matrix4& m, Matrix4& v, std::size_t p, std::size_t q) {
  if (m[p][q] == 0.0) return;
  const double half = (m[q][q] - m[p][p]) / (2.0 * m[p][q]);
  const double t = (half >= 0.0 ? 1.0 : -1.0) / (std::abs(half) + std::hypot(half, 1.0));
  const double c = 1.0 / std::hypot(t, 1.0), s = t * c;
  for (auto& row : m) {
    const double a = row[p], b = row[q];
    row[p] = c * a - s * b;
    row[q] = s * a + c * b;
  }
  for (std::size_t k = 0; k < 4; ++k) {
    const double a = m[p][k], b = m[q][k];
    m[p][k] = c * a - s * b;
    m[q][k] = s * a + c * b;
    const double x = v[k][p], y = v[k][q];
    v[k][p] = c * x - s * y;
    v[k][q] = s * x + c * y;
  }
}

// Eigenvector of the largest eigenvalue of a symmetric matrix.
std::array<double, 4> leading_vector(Matrix4 m) {
  Matrix4 v{};
  double size = 0.0;
  for (std::size_t k = 0; k < 4; ++k) {
    v[k][k] = 1.0;
    for (std::size_t l = 0; l < 4; ++l) size += m[k][l] * m[k][l];
  }
  constexpr int most_sweeps = 30;  // convergence is quadratic: five or six do
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    double off = 0.0;
    for (std::size_t p = 0; p < 4; ++p)
      for (std::size_t q = p + 1; q < 4; ++q) off += m[p][q] * m[p][q];
    if (!(off > 1e-36 * size)) break;
    for (std::size_t p = 0; p < 4; ++p)
      for (std::size_t q = p + 1; q < 4; ++q) annihilate(m, v, p, q);
  }
  std::size_t best = 0;
  for (std::size_t k = 1; k < 4; ++k)
    if (m[k][k] > m[best][best]) best = k;
  return {v[0][best], v[1][best], v[2][best], v[3][best]};
}

}  // namespace

Rotation<2> rotation_onto(const Vec<2>& from, const Vec<2>& to) {
  Rotation<2> q;
  q.advance({{std::atan2(torque(from, to)[0], dot(from, to)), 0.0}});
  return q;
}

Rotation<3> rotation_onto(const Vec<3>& from, const Vec<3>& to) {
  Rotation<3> q;
  const auto advance = [&q](const Vec<3>& axis, double angle) {
    if (angle > 0.0) q.advance((angle / norm(axis)) * axis);
  };
  Vec<3> start = from, axis = torque(from, to);
  // Of opposite directions the product is rounding alone: half a turn about an axis across, then what is left.
  if (dot(from, to) < 0.0 && norm(axis) < 1e-6 * norm(from) * norm(to)) {
    const auto least = std::min_element(
        from.x.begin(), from.x.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
    Vec<3> unit{};
    unit.x[static_cast<std::size_t>(least - from.x.begin())] = 1.0;
    advance(torque(from, unit), std::numbers::pi);
    start = -1.0 * from;
    axis = torque(start, to);
  }
  advance(axis, std::atan2(norm(axis), dot(start, to)));
  return q;
}

Rotation<2> best_rotation(std::span<const Vec<2>> from, std::span<const Vec<2>> to) {
  double c = 0.0, s = 0.0;
  for (std::size_t k = 0; k < from.size(); ++k) {
    c += dot(from[k], to[k]);
    s += torque(from[k], to[k])[0];
  }
  Rotation<2> rotation;
  const double size = std::hypot(c, s);
  if (!(size > 0.0)) return rotation;
  const std::array<double, 2> values{c / size, s / size};
  rotation.set(values.data());
  return rotation;
}

Rotation<3> best_rotation(std::span<const Vec<3>> from, std::span<const Vec<3>> to) {
  std::array<std::array<double, 3>, 3> sum{};
  for (std::size_t k = 0; k < from.size(); ++k)
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t b = 0; b < 3; ++b) sum[a][b] += from[k].x[a] * to[k].x[b];
  Matrix4 m{};
  m[0][0] = sum[0][0] + sum[1][1] + sum[2][2];
  for (std::size_t a = 0; a < 3; ++a) {
    const std::size_t b = (a + 1) % 3, c = (a + 2) % 3;
    m[0][a + 1] = m[a + 1][0] = sum[b][c] - sum[c][b];
    m[a + 1][a + 1] = sum[a][a] - sum[b][b] - sum[c][c];
    m[a + 1][b + 1] = m[b + 1][a + 1] = sum[a][b] + sum[b][a];
  }
  const std::array<double, 4> q = leading_vector(m);
  Rotation<3> rotation;
  rotation.set(q.data());
  return rotation;
}

}  // namespace odpd
