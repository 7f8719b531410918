// The keys of [[body]] and the shapes it knows by name.
#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "odpd/core/error.h"
#include "odpd/core/index.h"
#include "odpd/scene/bodies.h"

namespace odpd {

namespace {

template <int D>
Vec<D> body_vector(const Config& entry, const std::string& key, std::vector<double> values) {
  if (values.size() != D)
    entry.fail(key, fmt::format("{} components are needed in {} dimensions, there are {}", D, D,
                                values.size()));
  Vec<D> v;
  for (std::size_t c = 0; c < D; ++c) v.x[c] = values[c];
  return v;
}

template <int D>
Vec<D> optional_body_vector(const Config& entry, const std::string& key) {
  return body_vector<D>(entry, key, entry.numbers(key, std::vector<double>(D, 0.0)));
}

// An angular velocity or a torque: one number in 2D, a vector in 3D.
template <int D>
Vec<D> turning_vector(const Config& entry, const std::string& key) {
  constexpr auto n = index(rotation_components<D>);
  if (!entry.has(key)) return {};
  std::vector<double> values = n == 1 ? std::vector<double>{entry.number(key)} : entry.numbers(key);
  if (values.size() == n) values.resize(D, 0.0);
  return body_vector<D>(entry, key, values);
}

// Points given as [{ at = [x, y] }, ...].
template <int D>
std::vector<Vec<D>> read_points(const Config& entry, const std::string& key) {
  std::vector<Vec<D>> points;
  for (const Config& point : entry.tables(key))
    points.push_back(body_vector<D>(point, "at", point.numbers("at")));
  return points;
}

// n^D points of a square or cube.
template <int D>
std::vector<Vec<D>> grid_of(double side, std::int64_t n) {
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

// Evenly spaced points on a circle (in the x-y plane).
template <int D>
void add_circle(double radius, std::int64_t count, std::vector<Vec<D>>& points) {
  for (std::int64_t k = 0; k < count; ++k) {
    const double angle =
        2.0 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(count);
    Vec<D> p{};
    p[0] = radius * std::cos(angle);
    p[1] = radius * std::sin(angle);
    points.push_back(p);
  }
}

// A centre and `rings` circles of 6 k points at k radius/rings: a hexagonal disk's count.
template <int D>
std::vector<Vec<D>> disk_of(double radius, std::int64_t rings) {
  std::vector<Vec<D>> points(1);
  for (std::int64_t k = 1; k <= rings; ++k)
    add_circle(radius * static_cast<double>(k) / static_cast<double>(rings), 6 * k, points);
  return points;
}

// `count` points on a sphere, evenly by the golden angle (Fibonacci lattice).
template <int D>
std::vector<Vec<D>> sphere_of(double radius, std::int64_t count) {
  std::vector<Vec<D>> points;
  const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
  for (std::int64_t k = 0; k < count; ++k) {
    const double z = 1.0 - (2.0 * static_cast<double>(k) + 1.0) / static_cast<double>(count);
    const double s = std::sqrt(1.0 - z * z), angle = golden * static_cast<double>(k);
    const std::array<double, 3> p{s * std::cos(angle), s * std::sin(angle), z};
    Vec<D> point{};
    for (std::size_t c = 0; c < D; ++c) point.x[c] = radius * p[c];
    points.push_back(point);
  }
  return points;
}

template <int D>
std::vector<Vec<D>> read_shape(const Config& entry) {
  const std::vector<std::string> names =
      D > 2 ? std::vector<std::string>{"points", "cube", "sphere"}
            : std::vector<std::string>{"points", "square", "ring", "disk"};
  const std::string shape = entry.choice("shape", names);
  std::vector<Vec<D>> points;
  if (shape == "points") {
    points = read_points<D>(entry, "points");
    if (points.empty())
      entry.fail("points", "a shape of points needs some: points = [{ at = [0.0, ...] }, ...]");
  } else if (shape == "square" || shape == "cube") {
    points = grid_of<D>(entry.positive("side"), entry.positive_integer("per_side", 2));
  } else if (shape == "ring") {
    add_circle(entry.positive("radius"), entry.positive_integer("points_on_ring", 3), points);
  } else if (shape == "disk") {
    points = disk_of<D>(entry.positive("radius"), entry.positive_integer("rings", 2));
  } else {
    points = sphere_of<D>(entry.positive("radius"), entry.positive_integer("points_on_sphere", 12));
  }
  Vec<D> centre{};
  for (const Vec<D>& p : points) centre += (1.0 / static_cast<double>(points.size())) * p;
  for (Vec<D>& p : points) p -= centre;
  return points;
}

template <int D>
void read_places(const Config& entry, const Box<D>& box, BodySettings<D>& body) {
  body.positions = read_points<D>(entry, "positions");
  if (!body.positions.empty() && entry.has("count"))
    entry.fail("count", "give positions or count, never both");
  if (body.positions.empty()) {
    body.count = entry.positive_integer("count", 1);
    body.clearance = entry.non_negative("clearance", 1.0);
  }
  for (const Vec<D>& p : body.positions)
    for (int c = 0; c < D; ++c)
      if (!(p[c] >= 0.0 && p[c] <= box.size[c]))
        entry.fail("positions",
                   fmt::format("{} = {} lies outside the box, which reaches from 0 to {}", "xyz"[c],
                               p[c], box.size[c]));
  for (int c = 0; c < D; ++c)
    if (2.0 * body.radius() >= 0.5 * box.size[c])
      entry.fail("shape",
                 fmt::format("the body is {} across: the box must be more than twice that in "
                             "direction {}, or its images would be ambiguous",
                             2.0 * body.radius(), "xyz"[c]));
}

// A body that moves needs some extent. One that is no line but almost would turn about it at once, however small dt is.
template <int D>
void check_turns(const Config& entry, const Box<D>& box, const BodySettings<D>& body) {
  constexpr double thin = 1e-3;
  const double edge = *std::max_element(box.size.x.begin(), box.size.x.end());
  // Of a smaller one rounding of positions in the box would tell the orientation.
  if (!(body.radius() > 1e-9 * edge))
    entry.fail("shape", "a body that turns needs two points not in one place");
  if (rotations<D>(body.shape) > rotations<D>(body.shape, thin * thin))
    entry.fail("shape", fmt::format("its points lie almost on a line, within {} of their extent: "
                                    "put them on it to a millionth of that (more digits), or "
                                    "farther from it",
                                    thin));
}

}  // namespace

template <int D>
BodySettings<D> read_body(const Config& entry, const Box<D>& box) {
  BodySettings<D> body;
  body.name = entry.text("name", body.name);
  if (!is_plain_name(body.name))
    entry.fail("name", "use letters, digits, _ and -: it goes into file columns");
  body.shape = read_shape<D>(entry);
  const std::string motion = entry.choice("motion", {"free", "fixed", "given"}, "free");
  body.motion = motion == "free"    ? BodyMotion::free
                : motion == "fixed" ? BodyMotion::fixed
                                    : BodyMotion::given;
  if (body.motion == BodyMotion::given) {
    body.velocity.velocity = optional_body_vector<D>(entry, "velocity");
    body.velocity.angular = turning_vector<D>(entry, "angular_velocity");
    for (int c = 0; c < D; ++c)
      if (!box.is_periodic(c) && body.velocity.velocity[c] != 0.0)
        entry.fail("velocity", fmt::format("direction {} is bounded: the body would leave the box "
                                           "through its wall",
                                           "xyz"[c]));
  }
  if (body.motion == BodyMotion::free) {
    body.load.force = optional_body_vector<D>(entry, "force");
    body.load.torque = turning_vector<D>(entry, "torque");
  }
  if (body.motion != BodyMotion::fixed) check_turns(entry, box, body);
  read_places(entry, box, body);
  return body;
}

template BodySettings<2> read_body<2>(const Config&, const Box<2>&);
template BodySettings<3> read_body<3>(const Config&, const Box<3>&);

}  // namespace odpd
