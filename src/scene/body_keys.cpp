// The keys of [[body]].
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "odpd/core/error.h"
#include "odpd/core/index.h"
#include "odpd/scene/body_shape_keys.h"
#include "odpd/scene/scene_settings.h"
#include "odpd/scene/vector_key.h"

namespace odpd {

namespace {

// An angular velocity or a torque: one number in 2D, a vector in 3D.
template <int D>
Vec<D> turning_vector(const Config& entry, const std::string& key) {
  if constexpr (rotation_components<D> == D) return read_optional_vector<D>(entry, key);
  Vec<D> v{};
  if (entry.has(key)) v[0] = entry.number(key);
  return v;
}

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
    if (count == most_bodies)
      entry.fail("fraction", fmt::format("would be more than {} bodies: use larger ones, or a "
                                         "smaller deviation of their radii",
                                         most_bodies));
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
    const Vec<D> along = read_vector<D>(place, "along");
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
  for (std::size_t k = 0; k < std::max<std::size_t>(1, body.shapes.size()); ++k) {
    // Of a smaller one rounding of positions in the box would tell the orientation.
    if (!(body.radius(k) > 1e-9 * edge))
      entry.fail("shape", "a body that turns needs two points not in one place");
    const std::vector<Vec<D>>& shape = body.shape_of(k);
    if (rotations<D>(shape) > rotations<D>(shape, thin * thin))
      entry.fail("shape", fmt::format("its points lie almost on a line, within {} of their extent: "
                                      "put them on it to a millionth of that (more digits), or "
                                      "farther from it",
                                      thin));
  }
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
    body.velocity.velocity = read_optional_vector<D>(entry, "velocity");
    body.velocity.angular = turning_vector<D>(entry, "angular_velocity");
    for (int c = 0; c < D; ++c)
      if (!box.is_periodic(c) && body.velocity.velocity[c] != 0.0)
        entry.fail("velocity", fmt::format("direction {} is bounded: the body would leave the box "
                                           "through its wall",
                                           "xyz"[c]));
  }
  if (body.motion == BodyMotion::free) {
    body.load.force = read_optional_vector<D>(entry, "force");
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
