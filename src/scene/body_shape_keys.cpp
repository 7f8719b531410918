#include "odpd/scene/body_shape_keys.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "odpd/scene/body_shapes.h"
#include "odpd/scene/vector_key.h"

namespace odpd {

template <int D>
ShapeKeys read_shape_keys(const Config& entry) {
  const std::vector<std::string> names =
      D > 2 ? std::vector<std::string>{"points", "cube", "sphere", "ellipsoid", "rod"}
            : std::vector<std::string>{"points", "square", "ring", "disk", "ellipse", "rod"};
  ShapeKeys keys;
  const std::string shape = keys.name = entry.choice("shape", names);
  const bool by_corners = shape == "points" || shape == "square" || shape == "cube";
  const bool by_spacing = shape == "ellipsoid" || shape == "ellipse" || shape == "rod";
  keys.has_radius = !by_corners && (shape != "rod" || entry.has("radius"));
  if (shape == "square" || shape == "cube") {
    keys.side = entry.positive("side");
    keys.number = entry.positive_integer("per_side", 2);
  }
  if (by_spacing || (!by_corners && entry.has("spacing"))) keys.spacing = entry.positive("spacing");
  if (keys.spacing > 0.0 && keys.has_radius && shape != "disk")
    keys.layers = entry.positive_integer("layers", 1);
  if (shape == "rod") keys.length = entry.positive("length");
  if (shape == "ellipsoid" || shape == "ellipse") keys.aspect = entry.positive("aspect");
  if (by_corners || by_spacing) return keys;
  const std::string number = shape == "ring"   ? "points_on_ring"
                             : shape == "disk" ? "rings"
                                               : "points_on_sphere";
  if (keys.spacing > 0.0 && entry.has(number))
    entry.fail(number, fmt::format("give {} or spacing, never both", number));
  if (keys.spacing == 0.0)
    keys.number = entry.positive_integer(number, shape == "ring" ? 3 : shape == "disk" ? 2 : 12);
  return keys;
}

template <int D>
std::vector<Vec<D>> read_points(const Config& entry, const std::string& key) {
  std::vector<Vec<D>> points;
  for (const Config& point : entry.tables(key)) points.push_back(read_vector<D>(point, "at"));
  return points;
}

namespace {

LongShape long_shape(const ShapeKeys& keys, double radius) {
  if (keys.name == "rod") return {LongShape::Kind::spherocylinder, 0.5 * keys.length, radius};
  return {LongShape::Kind::spheroid, keys.aspect * radius, radius};
}

// Layers behind the surface, as many as there are up to the middle.
template <int D>
void add_inner_layers(const ShapeKeys& keys, double radius, std::vector<Vec<D>>& points) {
  const double spacing = keys.spacing;
  const double share = D > 2 ? spacing * spacing : spacing, flat = 0.25 * spacing;
  LongShape shape = long_shape(keys, radius);
  for (std::int64_t layer = 1; layer < keys.layers; ++layer) {
    shape.half_length -= spacing;
    shape.half_width -= spacing;
    const double thinnest = std::min(shape.half_length, shape.half_width);
    if (thinnest < -1e-6 * spacing) return;
    std::vector<Vec<D>> inner;
    if (thinnest > flat) {
      inner = surface_sites<D>(shape, std::max(1LL, std::llround(surface_of<D>(shape) / share)));
    } else if (shape.half_width > std::max(flat, shape.half_length)) {
      // Two sides in one.
      shape.half_length = std::max(shape.half_length, 1e-3 * spacing);
      inner =
          surface_sites<D>(shape, std::max(1LL, std::llround(0.5 * surface_of<D>(shape) / share)));
    } else if (shape.half_length > flat) {
      inner = line_sites<D>(2.0 * shape.half_length, spacing);
    } else {
      inner.push_back({});
    }
    points.insert(points.end(), inner.begin(), inner.end());
  }
}

// Sites so that each has `spacing`, or its square, of `extent`; enough to be a body.
std::int64_t sites_on(const Config& entry, double extent, double share) {
  constexpr double most = 1e7;
  if (extent > most * share)
    entry.fail("spacing", fmt::format("would put {:.2g} sites on a body: at most {:.0g} are meant; "
                                      "use a larger one",
                                      extent / share, most));
  return std::max<std::int64_t>(std::llround(extent / share), 4);
}

// Bodies thinner than a spacing would have holes that their own sites do not show.
void check_thickness(const Config& entry, const ShapeKeys& keys, double radius) {
  if (keys.name == "rod" && keys.length < 2.0 * radius)
    entry.fail("length", fmt::format("is that from end to end, at least 2 radius = {:.6g}: give "
                                     "a longer one, or shape = \"sphere\"",
                                     2.0 * radius));
  const double across = 2.0 * radius * std::min(keys.aspect, 1.0);
  if (across < keys.spacing)
    entry.fail("spacing",
               fmt::format("the {} is {:.6g} across where it is thinnest, less than the spacing of "
                           "its sites, {:.6g}: use a spacing of {:.6g} or less{}",
                           keys.name, across, keys.spacing, across,
                           keys.name == "rod" ? ", or leave radius out for a line of sites"
                                              : ", or another radius or aspect"));
}

template <int D>
std::vector<Vec<D>> sites_of(const Config& entry, const ShapeKeys& keys, double radius) {
  const double spacing = keys.spacing;
  if (keys.name == "points") return read_points<D>(entry, "points");
  if (keys.name == "square" || keys.name == "cube") return grid_sites<D>(keys.side, keys.number);
  if (keys.name == "rod" && !keys.has_radius) {
    sites_on(entry, keys.length, spacing);
    return line_sites<D>(keys.length, spacing);
  }
  check_thickness(entry, keys, radius);
  std::vector<Vec<D>> points;
  if (keys.name == "ring") {
    const double round = 2.0 * std::numbers::pi * radius;
    add_circle(radius, spacing > 0.0 ? sites_on(entry, round, spacing) : keys.number, points);
    add_inner_layers(keys, radius, points);
    return points;
  }
  if (keys.name == "disk") {
    std::int64_t rings = keys.number;
    if (spacing > 0.0) {
      sites_on(entry, std::numbers::pi * radius * radius, spacing * spacing);
      rings = std::llround(radius / spacing);
    }
    return disk_sites<D>(radius, std::max<std::int64_t>(rings, 1));
  }
  if (keys.name == "sphere") {
    const double area = 4.0 * std::numbers::pi * radius * radius;
    points = sphere_sites<D>(
        radius, spacing > 0.0 ? sites_on(entry, area, spacing * spacing) : keys.number);
  } else {
    const LongShape shape = long_shape(keys, radius);
    points = surface_sites<D>(
        shape, sites_on(entry, surface_of<D>(shape), D > 2 ? spacing * spacing : spacing));
  }
  add_inner_layers(keys, radius, points);
  return points;
}

}  // namespace

template <int D>
std::vector<Vec<D>> centred_sites(const Config& entry, const ShapeKeys& keys, double radius) {
  std::vector<Vec<D>> points = sites_of<D>(entry, keys, radius);
  if (points.empty())
    entry.fail("points", "a shape of points needs some: points = [{ at = [0.0, ...] }, ...]");
  Vec<D> centre{};
  for (const Vec<D>& p : points) centre += (1.0 / static_cast<double>(points.size())) * p;
  for (Vec<D>& p : points) p -= centre;
  return points;
}

template <int D>
double volume_inside(const Config& entry, const ShapeKeys& keys, double radius) {
  if (keys.name == "square" || keys.name == "cube") return std::pow(keys.side, D);
  if (!keys.has_radius)
    entry.fail("fraction",
               "of points, or of a line of sites, there is no volume to have a "
               "fraction of: give count");
  if (keys.name == "ellipsoid" || keys.name == "ellipse" || keys.name == "rod")
    return volume_of<D>(long_shape(keys, radius));
  return unit_ball_volume<D> * std::pow(radius, D);
}

Radii::Radii(const Config& entry, const ShapeKeys& keys, std::uint64_t seed, std::size_t kind)
    : random_(seed, Stream::body_sizes), kind_(kind) {
  if (!keys.has_radius) return;
  if (entry.is_array("radius")) {
    list_ = entry.numbers("radius");
    if (list_.empty()) entry.fail("radius", "is an empty list: give one radius for each body");
    for (const double r : list_)
      if (!(r > 0.0))
        entry.fail("radius", fmt::format("every radius must be positive (> 0), one is {}", r));
  } else if (entry.is_table("radius")) {
    read_distribution(entry.table("radius"));
  } else {
    mean_ = entry.positive("radius");
  }
}

double Radii::of(std::size_t body) const {
  if (!list_.empty()) return list_[body];
  if (deviation_ == 0.0) return mean_;
  double w = random_.normal(0, 0, kind_, body);
  if (!lognormal_) {
    // Radii at 0 and below, one of some millions at most, are drawn again.
    for (std::uint64_t again = 1; mean_ + deviation_ * w <= 0.0; ++again)
      w = random_.normal(again, 0, kind_, body);
    return mean_ + deviation_ * w;
  }
  // ln R has the variance ln(1 + (deviation/mean)^2) and half of that less than ln(mean) as its mean.
  const double variance = std::log1p(deviation_ * deviation_ / (mean_ * mean_));
  return mean_ * std::exp(std::sqrt(variance) * w - 0.5 * variance);
}

void Radii::read_distribution(const Config& table) {
  constexpr double widest = 0.2;  // of the mean: five deviations above 0
  mean_ = table.positive("mean");
  deviation_ = table.non_negative("deviation");
  lognormal_ = table.choice("distribution", {"normal", "lognormal"}, "normal") == "lognormal";
  if (!lognormal_ && deviation_ > widest * mean_)
    table.fail("deviation",
               fmt::format("radii from a normal distribution of mean {:.6g} and deviation {:.6g} "
                           "could be negative: use a deviation of at most {:.6g}, or "
                           "distribution = \"lognormal\"",
                           mean_, deviation_, widest * mean_));
}

#define ODPD_INSTANTIATE(D)                                                               \
  template ShapeKeys read_shape_keys<D>(const Config&);                                   \
  template std::vector<Vec<D>> read_points<D>(const Config&, const std::string&);         \
  template std::vector<Vec<D>> centred_sites<D>(const Config&, const ShapeKeys&, double); \
  template double volume_inside<D>(const Config&, const ShapeKeys&, double);
ODPD_INSTANTIATE(2)
ODPD_INSTANTIATE(3)
#undef ODPD_INSTANTIATE

}  // namespace odpd
