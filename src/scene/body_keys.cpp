// The keys of [[body]] and the shapes it knows by name.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "odpd/core/error.h"
#include "odpd/core/index.h"
#include "odpd/core/random.h"
#include "odpd/scene/body_shapes.h"
#include "odpd/scene/scene_settings.h"

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

// Keys that give a shape, all but its radius, which may differ from body to body.
struct ShapeKeys {
  std::string name;
  double side = 0.0;        // of a square or cube
  double length = 0.0;      // of a rod, over all
  double aspect = 1.0;      // of an ellipsoid, along its axis to across
  double spacing = 0.0;     // of sites; 0: by their number
  std::int64_t layers = 1;  // of sites, a spacing apart
  std::int64_t number = 0;  // of sites: per side, on a ring or sphere; or of rings
  bool has_radius = false;
};

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

// Volume inside the outermost sites.
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

// Bodies of one entry whose radii are kept one by one.
constexpr std::int64_t most_bodies = 10000000;

// Radii of the bodies of one entry: one number, a list, or a distribution to draw from.
class Radii {
 public:
  Radii(const Config& entry, const ShapeKeys& keys, std::uint64_t seed, std::size_t kind)
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
  bool differ() const { return !list_.empty() || deviation_ > 0.0; }
  const std::vector<double>& list() const { return list_; }
  double of(std::size_t body) const {
    if (!list_.empty()) return list_[body];
    if (deviation_ == 0.0) return mean_;
    const double w = random_.normal(0, 0, kind_, body);
    if (!lognormal_) return mean_ + deviation_ * w;
    // ln R has the variance ln(1 + (deviation/mean)^2) and half of that less than ln(mean) as its mean.
    const double variance = std::log1p(deviation_ * deviation_ / (mean_ * mean_));
    return mean_ * std::exp(std::sqrt(variance) * w - 0.5 * variance);
  }

 private:
  void read_distribution(const Config& table) {
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

  std::vector<double> list_;
  double mean_ = 0.0, deviation_ = 0.0;
  bool lognormal_ = false;
  CounterRandom random_;
  std::size_t kind_;
};

// Of a body, where its fraction is that of such balls; else 0.
template <int D>
double hydrodynamic_ball(const Config& entry, const Radii& radii) {
  if (entry.choice("fraction_of", {"sites", "hydrodynamic"}, "sites") == "sites") return 0.0;
  if (!entry.has("hydrodynamic_radius"))
    entry.fail("fraction_of",
               "\"hydrodynamic\" needs hydrodynamic_radius, which odpd calibrate --radius finds");
  if (radii.differ())
    entry.fail("fraction_of",
               "\"hydrodynamic\" is of bodies of one size: give each size its own [[body]]");
  return unit_ball_volume<D> * std::pow(entry.positive("hydrodynamic_radius"), D);
}

// As many bodies as come nearest to a fraction of the space.
template <int D>
std::int64_t count_of_fraction(const Config& entry, const ShapeKeys& keys, const Radii& radii,
                               double space) {
  const double fraction = entry.positive("fraction"), wanted = fraction * space;
  const double ball = hydrodynamic_ball<D>(entry, radii);
  const auto volume_of_body = [&](std::size_t k) {
    return ball > 0.0 ? ball : volume_inside<D>(entry, keys, radii.of(k));
  };
  if (!radii.list().empty())
    entry.fail("fraction", "a list of radii says how many bodies there are: leave fraction out");
  if (fraction >= 1.0)
    entry.fail("fraction",
               fmt::format("{} cannot be reached: it is the bodies' share of the {}, below 1",
                           fraction, D > 2 ? "volume" : "area"));
  const double first = volume_of_body(0);
  if (wanted < 0.5 * first)
    entry.fail("fraction",
               fmt::format("{} cannot be reached: a single body is {:.4g} of the {} between the "
                           "walls; use a larger box, or smaller bodies",
                           fraction, first / space, D > 2 ? "volume" : "area"));
  if (wanted > static_cast<double>(most_bodies) * first)
    entry.fail("fraction",
               fmt::format("would be more than {} bodies: use larger ones", most_bodies));
  if (!radii.differ()) return std::llround(wanted / first);
  std::int64_t count = 0;
  for (double volume = 0.0;; ++count) {
    const double next = volume_of_body(index(count));
    if (volume + 0.5 * next > wanted) return count;
    volume += next;
  }
}

template <int D>
void read_places(const Config& entry, const SceneSettings<D>& scene, const ShapeKeys& keys,
                 const Radii& radii, BodySettings<D>& body) {
  const Box<D>& box = scene.box;
  const auto listed = static_cast<std::int64_t>(radii.list().size());
  body.positions = read_points<D>(entry, "positions");
  for (const char* key : {"count", "fraction"})
    if (!body.positions.empty() && entry.has(key))
      entry.fail(key, fmt::format("give positions or {}, never both", key));
  if (entry.has("fraction") && entry.has("count"))
    entry.fail("fraction", "give count or fraction, never both");
  if (body.positions.empty()) {
    body.count = entry.has("fraction")
                     ? count_of_fraction<D>(entry, keys, radii, scene.fluid_volume())
                     : entry.positive_integer("count", std::max<std::int64_t>(listed, 1));
    body.clearance = entry.non_negative("clearance", 1.0);
  }
  if (listed > 0 && listed != body.bodies())
    entry.fail("radius", fmt::format("lists {} radii for {} bodies: give one for each", listed,
                                     body.bodies()));
  for (const Vec<D>& p : body.positions)
    for (int c = 0; c < D; ++c)
      if (!(p[c] >= 0.0 && p[c] <= box.size[c]))
        entry.fail("positions",
                   fmt::format("{} = {} lies outside the box, which reaches from 0 to {}", "xyz"[c],
                               p[c], box.size[c]));
}

// The direction in its frame that `along` turns a shape by: the axis of a figure of revolution, of points on a line the way from the
// first to the last one. None of other shapes.
template <int D>
std::optional<Vec<D>> axis_of(const ShapeKeys& keys, const std::vector<Vec<D>>& shape) {
  Vec<D> x{};
  x[0] = 1.0;
  if (keys.name == "rod" || keys.name == "ellipsoid" || keys.name == "ellipse") return x;
  constexpr double thin = 1e-6;  // as `rotations` has it
  const Vec<D> along = shape.back() - shape.front();
  double beside = 0.0;
  for (const Vec<D>& p : shape)
    beside = std::max(beside, norm(dot(along, along) * p - dot(along, p) * along));
  if (keys.name != "points" || !(beside < thin * std::pow(norm(along), 3))) return {};
  return along;
}

// Where bodies at `positions` point.
template <int D>
void read_orientations(const Config& entry, const ShapeKeys& keys, BodySettings<D>& body) {
  for (const Config& place : entry.tables("positions")) {
    body.orientations.emplace_back();
    if (!place.has("along")) continue;
    const Vec<D> along = body_vector<D>(place, "along", place.numbers("along"));
    const std::optional<Vec<D>> axis = axis_of<D>(keys, body.shape);
    if (!axis)
      place.fail("along", fmt::format("shape = \"{}\" has no axis to point anywhere: rods, {} and "
                                      "points on a line have one; leave `along` out",
                                      keys.name, D > 2 ? "ellipsoids" : "ellipses"));
    if (norm(along) == 0.0) place.fail("along", "a direction is needed, not the zero vector");
    body.orientations.back() = rotation_onto(*axis, along);
  }
}

// Half of an edge or longer, the nearest image of a site could be another one than its body's.
template <int D>
void check_size(const Config& entry, const Box<D>& box, const BodySettings<D>& body) {
  const double across = 2.0 * body.radius();
  for (int c = 0; c < D; ++c)
    if (across >= 0.5 * box.size[c])
      entry.fail("shape",
                 fmt::format("{} {:.6g} across: the box must be more than twice that in direction "
                             "{}, or its images would be ambiguous. It would do with a box longer "
                             "than {:.6g} there, or a body less than {:.6g} across",
                             body.shapes.empty() ? "the body is" : "the largest body is", across,
                             "xyz"[c], 2.0 * across, 0.5 * box.size[c]));
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
BodySettings<D> read_body(const Config& entry, const SceneSettings<D>& scene) {
  const Box<D>& box = scene.box;
  BodySettings<D> body;
  body.name = entry.text("name", body.name);
  if (!is_plain_name(body.name))
    entry.fail("name", "use letters, digits, _ and -: it goes into file columns");
  const ShapeKeys keys = read_shape_keys<D>(entry);
  const Radii radii(entry, keys, scene.seed, scene.bodies.size());
  read_places(entry, scene, keys, radii, body);
  body.shape = centred_sites<D>(entry, keys, radii.of(0));
  if (radii.differ()) {
    if (body.bodies() > most_bodies)
      entry.fail("radius", fmt::format("of more than {} bodies must be one number", most_bodies));
    body.shapes.push_back(body.shape);
    for (std::size_t k = 1; k < index(body.bodies()); ++k)
      body.shapes.push_back(centred_sites<D>(entry, keys, radii.of(k)));
  }
  read_orientations(entry, keys, body);
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
  check_size(entry, box, body);
  read_body_sizes(entry, scene, body);
  return body;
}

template BodySettings<2> read_body<2>(const Config&, const SceneSettings<2>&);
template BodySettings<3> read_body<3>(const Config&, const SceneSettings<3>&);

}  // namespace odpd
