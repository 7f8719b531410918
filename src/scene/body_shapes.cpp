#include "odpd/scene/body_shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "odpd/core/index.h"

namespace odpd {

namespace {

using std::numbers::pi;
using Kind = LongShape::Kind;

const double golden_angle = pi * (3.0 - std::sqrt(5.0));

// int_0^t sqrt(1 - e t'^2) dt'.
double spheroid_integral(double e, double t) {
  const double root = std::sqrt(std::abs(e)), end = std::sqrt(1.0 - e * t * t);
  if (root * std::abs(t) < 1e-4) return t * (1.0 - e * t * t / 6.0);
  return 0.5 * (t * end + (e > 0.0 ? std::asin(root * t) : std::asinh(root * t)) / root);
}

double flatness(const LongShape& shape) {
  const double ratio = shape.half_width / shape.half_length;
  return 1.0 - ratio * ratio;
}

// x/a where a share of the surface lies below it.
double axial_place(const LongShape& shape, double share) {
  if (shape.kind == Kind::spherocylinder) return 2.0 * share - 1.0;
  const double e = flatness(shape), wanted = (2.0 * share - 1.0) * spheroid_integral(e, 1.0);
  double low = -1.0, high = 1.0;
  for (int halving = 0; halving < 60; ++halving) {
    const double t = 0.5 * (low + high);
    (spheroid_integral(e, t) < wanted ? low : high) = t;
  }
  return 0.5 * (low + high);
}

// Radius of the surface at x.
double radius_at(const LongShape& shape, double x) {
  const double a = shape.half_length, b = shape.half_width;
  if (shape.kind == Kind::spheroid) return b * std::sqrt(std::max(0.0, 1.0 - x * x / (a * a)));
  const double beyond = std::max(0.0, std::abs(x) - (a - b));
  return std::sqrt(std::max(0.0, b * b - beyond * beyond));
}

// The outline in 2D at u in [0, 1], from the end of the axis.
Vec<2> outline_at(const LongShape& shape, double u) {
  const double a = shape.half_length, b = shape.half_width, angle = 2.0 * pi * u;
  if (shape.kind == Kind::spheroid) return {{a * std::cos(angle), b * std::sin(angle)}};
  // The points of a circle, their halves moved apart: the straight sides are two steps of it.
  const double apart = std::cos(angle) >= 0.0 ? a - b : b - a;
  return {{b * std::cos(angle) + apart, b * std::sin(angle)}};
}

// A polygon of many corners on the outline and the lengths along it up to each.
struct Outline {
  explicit Outline(const LongShape& shape) {
    constexpr int corners = 20000;
    for (int k = 0; k <= corners; ++k) {
      points.push_back(outline_at(shape, static_cast<double>(k) / corners));
      lengths.push_back(k == 0 ? 0.0
                               : lengths.back() + norm(points[index(k)] - points[index(k - 1)]));
    }
  }
  Vec<2> at(double length) const {
    const auto next = std::upper_bound(lengths.begin(), lengths.end() - 1, length);
    const auto k = static_cast<std::size_t>(next - lengths.begin());
    const double share = (length - lengths[k - 1]) / (lengths[k] - lengths[k - 1]);
    return points[k - 1] + share * (points[k] - points[k - 1]);
  }
  std::vector<Vec<2>> points;
  std::vector<double> lengths;
};

}  // namespace

template <int D>
std::vector<Vec<D>> grid_sites(double side, std::int64_t n) {
  std::vector<Vec<D>> points(1);
  for (int c = 0; c < D; ++c) {
    std::vector<Vec<D>> next;
    for (std::int64_t k = 0; k < n; ++k)
      for (Vec<D> p : points) {
        p[c] = n > 1 ? side * (static_cast<double>(k) / static_cast<double>(n - 1) - 0.5) : 0.0;
        next.push_back(p);
      }
    points.swap(next);
  }
  return points;
}

template <int D>
void add_circle(double radius, std::int64_t count, std::vector<Vec<D>>& points) {
  for (std::int64_t k = 0; k < count; ++k) {
    const double angle = 2.0 * pi * static_cast<double>(k) / static_cast<double>(count);
    Vec<D> p{};
    p[0] = radius * std::cos(angle);
    p[1] = radius * std::sin(angle);
    points.push_back(p);
  }
}

template <int D>
std::vector<Vec<D>> disk_sites(double radius, std::int64_t rings) {
  std::vector<Vec<D>> points(1);
  for (std::int64_t k = 1; k <= rings; ++k)
    add_circle(radius * static_cast<double>(k) / static_cast<double>(rings), 6 * k, points);
  return points;
}

template <int D>
std::vector<Vec<D>> sphere_sites(double radius, std::int64_t count) {
  std::vector<Vec<D>> points;
  for (std::int64_t k = 0; k < count; ++k) {
    const double z = 1.0 - (2.0 * static_cast<double>(k) + 1.0) / static_cast<double>(count);
    const double s = std::sqrt(1.0 - z * z), angle = golden_angle * static_cast<double>(k);
    const std::array<double, 3> p{s * std::cos(angle), s * std::sin(angle), z};
    Vec<D> point{};
    for (std::size_t c = 0; c < D; ++c) point.x[c] = radius * p[c];
    points.push_back(point);
  }
  return points;
}

template <int D>
std::vector<Vec<D>> line_sites(double length, double spacing) {
  const std::int64_t steps = std::max<std::int64_t>(1, std::llround(length / spacing));
  std::vector<Vec<D>> points;
  for (std::int64_t k = 0; k <= steps; ++k) {
    points.push_back({});
    points.back()[0] = length * (static_cast<double>(k) / static_cast<double>(steps) - 0.5);
  }
  return points;
}

template <int D>
double surface_of(const LongShape& shape) {
  const double a = shape.half_length, b = shape.half_width;
  if (shape.kind == Kind::spherocylinder)
    return D > 2 ? 4.0 * pi * a * b : 2.0 * pi * b + 4.0 * (a - b);
  if (D > 2) return 4.0 * pi * a * b * spheroid_integral(flatness(shape), 1.0);
  return Outline(shape).lengths.back();
}

template <int D>
double volume_of(const LongShape& shape) {
  const double a = shape.half_length, b = shape.half_width;
  const double across = D > 2 ? pi * b * b : 2.0 * b;
  const double ball = unit_ball_volume<D> * (D > 2 ? b * b : b);
  return shape.kind == Kind::spheroid ? ball * a : ball * b + 2.0 * (a - b) * across;
}

template <>
std::vector<Vec<2>> surface_sites<2>(const LongShape& shape, std::int64_t count) {
  const Outline outline(shape);
  std::vector<Vec<2>> points;
  for (std::int64_t k = 0; k < count; ++k)
    points.push_back(
        outline.at(outline.lengths.back() * static_cast<double>(k) / static_cast<double>(count)));
  return points;
}

template <>
std::vector<Vec<3>> surface_sites<3>(const LongShape& shape, std::int64_t count) {
  std::vector<Vec<3>> points;
  for (std::int64_t k = 0; k < count; ++k) {
    const double share = (static_cast<double>(k) + 0.5) / static_cast<double>(count);
    const double x = shape.half_length * axial_place(shape, share), s = radius_at(shape, x);
    const double angle = golden_angle * static_cast<double>(k);
    points.push_back({{x, s * std::cos(angle), s * std::sin(angle)}});
  }
  return points;
}

#define ODPD_INSTANTIATE(D)                                                \
  template std::vector<Vec<D>> grid_sites<D>(double, std::int64_t);        \
  template void add_circle<D>(double, std::int64_t, std::vector<Vec<D>>&); \
  template std::vector<Vec<D>> disk_sites<D>(double, std::int64_t);        \
  template std::vector<Vec<D>> sphere_sites<D>(double, std::int64_t);      \
  template std::vector<Vec<D>> line_sites<D>(double, double);              \
  template double surface_of<D>(const LongShape&);                         \
  template double volume_of<D>(const LongShape&);
ODPD_INSTANTIATE(2)
ODPD_INSTANTIATE(3)
#undef ODPD_INSTANTIATE

}  // namespace odpd
