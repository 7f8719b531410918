#include "odpd/scene/body_places.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "odpd/core/error.h"
#include "odpd/geometry/ball_cells.h"

namespace odpd {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

template <int D>
struct PlacedBody {
  std::size_t kind = 0;
  std::int64_t number = 0;  // of its kind, from 1
  Vec<D> centre{};
  std::vector<Vec<D>> arms;  // of its constituents
  double radius = 0.0;       // of the outermost
  double spacing = 0.0;      // of neighbours; the largest

  Vec<D> at(std::size_t k) const { return centre + arms[k]; }
};

// Largest distance of a constituent from the nearest other one.
template <int D>
double spacing_of(std::vector<Vec<D>> points) {
  std::sort(points.begin(), points.end(),
            [](const Vec<D>& a, const Vec<D>& b) { return a[0] < b[0]; });
  double most = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    double nearest = infinity;
    // Those further along x can only be further away.
    const auto is_nearer = [&](std::size_t j) {
      if (std::abs(points[i][0] - points[j][0]) > nearest) return false;
      nearest = std::min(nearest, norm(points[i] - points[j]));
      return true;
    };
    for (std::size_t j = i + 1; j < points.size() && is_nearer(j);) ++j;
    for (std::size_t j = i; j > 0 && is_nearer(j - 1);) --j;
    if (nearest < infinity) most = std::max(most, nearest);
  }
  return most;
}

// A constituent of b lies deeper inside a than neighbours in a are apart.
template <int D>
bool reaches_into(const Box<D>& box, const PlacedBody<D>& a, const PlacedBody<D>& b) {
  for (std::size_t k = 0; k < b.arms.size(); ++k)
    if (norm(box.separation(b.at(k), a.centre)) < a.radius - a.spacing) return true;
  return false;
}

template <int D>
bool are_near(const Box<D>& box, const PlacedBody<D>& a, const PlacedBody<D>& b) {
  const double near = std::max(a.spacing, b.spacing);
  BallCells<D> sites(box);
  for (std::size_t k = 0; k < a.arms.size(); ++k) sites.add(a.at(k), 0.0);
  for (std::size_t l = 0; l < b.arms.size(); ++l)
    if (sites.find_near(b.at(l), near, [&](std::size_t k) {
          return norm(box.separation(a.at(k), b.at(l))) <= near;
        }))
      return true;
  return false;
}

// Where `share` of the larger radius is the distance at which centres are one in the other.
template <int D>
bool lie_in_each_other(const Box<D>& box, const PlacedBody<D>& a, const PlacedBody<D>& b,
                       double share) {
  const double apart = norm(box.separation(a.centre, b.centre));
  if (apart > a.radius + b.radius) return false;
  const bool central = apart <= share * std::max(a.radius, b.radius);
  const bool deep = share == 1.0 && (reaches_into(box, a, b) || reaches_into(box, b, a));
  return (central || deep) && are_near(box, a, b);
}

// Bodies so far, to be asked for the first of them that a further one lies in.
template <int D>
class PlacedBodies {
 public:
  explicit PlacedBodies(const Box<D>& box) : box_(box), balls_(box) {}

  void add(const PlacedBody<D>& body) {
    balls_.add(body.centre, body.radius);
    bodies_.push_back(body);
  }
  const PlacedBody<D>* first_in(const PlacedBody<D>& body, double share) const {
    std::vector<std::size_t> near;
    balls_.find_near(body.centre, body.radius, [&](std::size_t k) {
      near.push_back(k);
      return false;
    });
    std::sort(near.begin(), near.end());
    for (const std::size_t k : near)
      if (lie_in_each_other(box_, body, bodies_[k], share)) return &bodies_[k];
    return nullptr;
  }

 private:
  const Box<D>& box_;
  BallCells<D> balls_;
  std::vector<PlacedBody<D>> bodies_;
};

// How deep behind a surface its constituents are at least and at most; of all walls where that is most.
template <int D>
struct Depth {
  const WallSettings<D>* wall = nullptr;
  double least = -infinity, most = -infinity;
};

template <int D>
Depth<D> depth_in_walls(const SceneSettings<D>& scene, const PlacedBody<D>& body, bool of_least) {
  Depth<D> deepest;
  for (const WallSettings<D>& wall : scene.walls) {
    Depth<D> here{&wall, infinity, -infinity};
    for (const Vec<D>& arm : body.arms) {
      const double x = body.centre[wall.axis] + arm[wall.axis];
      const double h =
          wall.high ? x - (scene.box.size[wall.axis] - wall.thickness) : wall.thickness - x;
      here.least = std::min(here.least, h);
      here.most = std::max(here.most, h);
    }
    if (of_least ? here.least > deepest.least : here.most > deepest.most) deepest = here;
  }
  return deepest;
}

template <int D>
std::string side_of(const WallSettings<D>& wall) {
  return fmt::format("{}{}", "xyz"[wall.axis], wall.high ? '+' : '-');
}

template <int D>
std::string name_of(const SceneSettings<D>& scene, const PlacedBody<D>& body) {
  return fmt::format("body {} of [[body]] '{}' at ({:.6g})", body.number,
                     scene.bodies[body.kind].name,
                     fmt::join(body.centre.x.begin(), body.centre.x.end(), ", "));
}

// Rounding may leave a constituent that should touch a surface or an end this far behind it.
template <int D>
double rounding(const SceneSettings<D>& scene, int axis) {
  return 1e-9 * scene.box.size[axis];
}

template <int D>
void check_ends(const Config& entry, const SceneSettings<D>& scene, const PlacedBody<D>& body) {
  for (int c = 0; c < D; ++c) {
    if (scene.box.is_periodic(c)) continue;
    const auto [low, high] =
        std::minmax_element(body.arms.begin(), body.arms.end(),
                            [c](const Vec<D>& p, const Vec<D>& q) { return p[c] < q[c]; });
    for (const double x : {body.centre[c] + (*low)[c], body.centre[c] + (*high)[c]})
      if (x < -rounding(scene, c) || x > scene.box.size[c] + rounding(scene, c))
        entry.fail("positions", fmt::format("{} has a particle at {} = {:.6g}, outside the box, "
                                            "which reaches from 0 to {} there: move it inwards",
                                            name_of(scene, body), "xyz"[c], x, scene.box.size[c]));
  }
}

template <int D>
void check_walls(const Config& entry, const SceneSettings<D>& scene, const PlacedBody<D>& body) {
  const bool free = scene.bodies[body.kind].motion == BodyMotion::free;
  const Depth<D> depth = depth_in_walls(scene, body, !free);
  const double behind = free ? depth.most : depth.least;
  if (depth.wall == nullptr || behind <= rounding(scene, depth.wall->axis)) return;
  const WallSettings<D>& wall = *depth.wall;
  const double centre = body.centre[wall.axis] + (wall.high ? -behind : behind);
  entry.fail(
      "positions",
      fmt::format("{} lies in the wall at {}: {} is {:.6g} behind its surface; put the centre at "
                  "{} = {:.6g} or {}",
                  name_of(scene, body), side_of(wall),
                  free ? "its deepest particle" : "its outermost particle", behind,
                  "xyz"[wall.axis], centre, wall.high ? "less" : "more"));
}

}  // namespace

template <int D>
void check_body_positions(const Config& config, const SceneSettings<D>& scene) {
  const std::vector<Config> entries = config.tables("body");
  PlacedBodies<D> placed(scene.box);
  for (std::size_t kind = 0; kind < scene.bodies.size(); ++kind) {
    const BodySettings<D>& s = scene.bodies[kind];
    double spacing = 0.0;
    for (std::size_t n = 0; n < s.positions.size(); ++n) {
      if (n == 0 || !s.shapes.empty()) spacing = spacing_of<D>(s.shape_of(n));
      PlacedBody<D> body{kind,   static_cast<std::int64_t>(n) + 1, s.positions[n], {}, s.radius(n),
                         spacing};
      for (const Vec<D>& point : s.shape_of(n)) body.arms.push_back(s.orientation(n).turn(point));
      check_ends(entries[kind], scene, body);
      check_walls(entries[kind], scene, body);
      if (const PlacedBody<D>* other = placed.first_in(body, 1.0))
        entries[kind].fail(
            "positions",
            fmt::format("{} and {} lie in each other: put them further apart, or make one "
                        "shape = \"points\" of what belongs together",
                        name_of(scene, *other), name_of(scene, body)));
      placed.add(body);
    }
  }
}

template <int D>
void check_start_bodies(const SceneSettings<D>& scene, const std::vector<std::size_t>& kind,
                        const Particles<D>& particles) {
  constexpr double same_place = 1e-3;
  PlacedBodies<D> placed(scene.box);
  std::vector<std::int64_t> count(scene.bodies.size(), 0);
  std::vector<double> spacing;  // of each [[body]] of one size
  for (const BodySettings<D>& s : scene.bodies) spacing.push_back(spacing_of<D>(s.shape));
  for (std::size_t b = 0; b < particles.bodies.size(); ++b) {
    const RigidBody<D>& body = particles.bodies[b];
    const BodySettings<D>& s = scene.bodies[kind[b]];
    const std::int64_t number = ++count[kind[b]];
    const auto n = static_cast<std::size_t>(number - 1);
    PlacedBody<D> here{
        kind[b], number,      body.pose.centre,
        {},      s.radius(n), s.shapes.empty() ? spacing[kind[b]] : spacing_of<D>(s.shape_of(n))};
    for (const Vec<D>& point : body.frame) here.arms.push_back(body.pose.orientation.turn(point));
    const Depth<D> depth = depth_in_walls(scene, here, true);
    if (depth.wall != nullptr && depth.least > rounding(scene, depth.wall->axis))
      throw ConfigError(
          fmt::format("{}: {} lies in the wall at {}, {:.6g} behind its surface: move "
                      "it, or give the wall another thickness",
                      scene.start_file, name_of(scene, here), side_of(*depth.wall), depth.least));
    if (const PlacedBody<D>* other = placed.first_in(here, same_place))
      throw ConfigError(fmt::format("{}: {} and {} are at one place: move one of them",
                                    scene.start_file, name_of(scene, *other),
                                    name_of(scene, here)));
    placed.add(here);
  }
}

#define ODPD_INSTANTIATE(D)                                                                     \
  template void check_body_positions<D>(const Config&, const SceneSettings<D>&);                \
  template void check_start_bodies<D>(const SceneSettings<D>&, const std::vector<std::size_t>&, \
                                      const Particles<D>&);
ODPD_INSTANTIATE(2)
ODPD_INSTANTIATE(3)
#undef ODPD_INSTANTIATE

}  // namespace odpd
