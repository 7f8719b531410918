#include "odpd/scene/bodies.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "odpd/core/error.h"
#include "odpd/core/index.h"
#include "odpd/core/random.h"
#include "odpd/scene/random_places.h"

namespace odpd {

template <int D>
std::int64_t BodySettings<D>::particles() const {
  if (shapes.empty()) return bodies() * static_cast<std::int64_t>(shape.size());
  std::int64_t all = 0;
  for (const auto& one : shapes) all += static_cast<std::int64_t>(one.size());
  return all;
}

template <int D>
double BodySettings<D>::radius(std::size_t body) const {
  double most = 0.0;
  for (const Vec<D>& b : shape_of(body)) most = std::max(most, norm(b));
  return most;
}

template <int D>
double BodySettings<D>::radius() const {
  double most = radius(0);
  for (std::size_t k = 1; k < shapes.size(); ++k) most = std::max(most, radius(k));
  return most;
}

void turn_at_random(const std::array<double, 4>& u, Rotation<2>& orientation) {
  const Vec<2> angle{{2.0 * std::numbers::pi * u[0], 0.0}};
  orientation.advance(angle);
}
void turn_at_random(const std::array<double, 4>& u, Rotation<3>& orientation) {
  // Shoemake 1992: a uniform unit quaternion.
  const double a = std::sqrt(1.0 - u[0]), b = std::sqrt(u[0]);
  const double s = 2.0 * std::numbers::pi * u[1], t = 2.0 * std::numbers::pi * u[2];
  const std::array<double, 4> q{b * std::cos(t), a * std::sin(s), a * std::cos(s), b * std::sin(t)};
  orientation.set(q.data());
}

namespace {

// Half the clearance around a body is its own.
template <int D>
double reach_of(const BodySettings<D>& s, std::size_t body) {
  return s.radius(body) + 0.5 * s.clearance;
}
template <int D>
std::vector<double> reaches_of(const BodySettings<D>& s) {
  std::vector<double> reaches(index(s.bodies()), reach_of(s, 0));
  for (std::size_t k = 1; k < s.shapes.size(); ++k) reaches[k] = reach_of(s, k);
  return reaches;
}

template <int D>
bool is_placed_at_random(const BodySettings<D>& s) {
  return s.positions.empty();
}

// Volume of the balls of all bodies at random places, those of a radius above `largest` as if they had that.
template <int D>
double random_volume(const std::vector<BodySettings<D>>& settings, double largest) {
  double volume = 0.0;
  const auto ball = [&](double reach) {
    return unit_ball_volume<D> * std::pow(std::clamp(reach, 0.0, largest), D);
  };
  for (const BodySettings<D>& s : settings) {
    if (!is_placed_at_random(s)) continue;
    if (s.shapes.empty()) volume += static_cast<double>(s.count) * ball(reach_of(s, 0));
    for (std::size_t k = 0; k < s.shapes.size(); ++k) volume += ball(reach_of(s, k));
  }
  return volume;
}

// Why there are no random places for all; `found` is empty where they were not even sought.
template <int D>
ConfigError no_room(const std::vector<BodySettings<D>>& settings, double space,
                    const std::optional<RandomPlaces<D>>& found) {
  constexpr const char* remedy =
      "lower count, fraction or clearance, give positions (of long bodies with `along`), or use a "
      "larger box";
  std::vector<std::string> names;
  std::int64_t bodies = 0;
  double across = 0.0;
  for (const BodySettings<D>& s : settings) {
    if (!is_placed_at_random(s)) continue;
    names.push_back(fmt::format("'{}'", s.name));
    bodies += s.count;
    across = std::max(across, 2.0 * (s.radius() + 0.5 * s.clearance));
    if (found && found->scale == 0.0 && index(bodies) > found->centres.size())
      return ConfigError(fmt::format(
          "[[body]] '{}': no room was found even for one body alone, which with half its clearance "
          "around it is {:.6g} across: {}",
          s.name, 2.0 * reach_of(s, found->centres.size() - index(bodies - s.count)), remedy));
  }
  constexpr double any = std::numeric_limits<double>::infinity();
  const double fraction = random_volume(settings, any) / space;
  std::string reached = "more than there is";
  if (found) {
    const double share = std::pow(found->scale, D);
    reached = fmt::format("and {:.3g} was reached, which is about {} of them", share * fraction,
                          static_cast<std::int64_t>(share * static_cast<double>(bodies)));
  }
  return ConfigError(fmt::format(
      "[[body]] {}: no random places were found for all {} bodies. With half its clearance around "
      "each, as {} of {}{:.4g} across, they would fill {:.3g} of the {}, {}: {}",
      fmt::join(names, ", "), bodies, D > 2 ? "balls" : "disks", names.size() > 1 ? "up to " : "",
      across, fraction, D > 2 ? "volume" : "area", reached, remedy));
}

template <int D>
RandomPlaces<D> places_of_bodies(const std::vector<BodySettings<D>>& settings, const Box<D>& box,
                                 const Vec<D>& low, const Vec<D>& high, std::uint64_t seed) {
  const double space = Box<D>{high - low, {}}.volume();
  // Balls wider than the box overlap with their own images.
  const double widest = 0.5 * *std::min_element(box.size.x.begin(), box.size.x.end());
  if (random_volume(settings, widest) > space) throw no_room<D>(settings, space, {});
  BallCells<D> there(box);
  std::vector<double> reaches;
  for (const BodySettings<D>& s : settings) {
    const std::vector<double> own = reaches_of(s);
    for (std::size_t k = 0; k < s.positions.size(); ++k) {
      Vec<D> centre = s.positions[k];
      box.wrap(centre);
      there.add(centre, own[k]);
    }
    if (is_placed_at_random(s)) reaches.insert(reaches.end(), own.begin(), own.end());
  }
  RandomPlaces<D> found = find_random_places<D>(box, low, high, there, reaches, seed);
  if (found.scale < 1.0) throw no_room<D>(settings, space, found);
  return found;
}

}  // namespace

template <int D>
std::vector<std::size_t> place_bodies(const std::vector<BodySettings<D>>& settings,
                                      const Box<D>& box, const Vec<D>& low, const Vec<D>& high,
                                      std::uint64_t seed, bool at_random, Particles<D>& particles) {
  RandomPlaces<D> found;
  if (at_random) found = places_of_bodies(settings, box, low, high, seed);
  const CounterRandom random(seed, Stream::body_poses);
  std::size_t number = 0;  // of a body at a random place
  std::vector<std::vector<RigidPose<D>>> poses(settings.size());
  for (std::size_t k = 0; k < settings.size(); ++k)
    for (std::size_t n = 0; n < index(settings[k].bodies()); ++n) {
      RigidPose<D>& pose = poses[k].emplace_back();
      pose.centre = low;
      if (!is_placed_at_random(settings[k])) {
        pose.centre = settings[k].positions[n];
        pose.orientation = settings[k].orientation(n);
        box.wrap(pose.centre);
      } else if (at_random) {
        pose.centre = found.centres[number];
        turn_at_random(random.uniforms(found.attempts[number], 1, number, 0), pose.orientation);
        ++number;
      }
    }
  std::vector<std::size_t> kind;
  for (const bool known : {false, true})
    for (std::size_t k = 0; k < settings.size(); ++k) {
      if ((settings[k].motion != BodyMotion::free) != known) continue;
      for (std::size_t n = 0; n < poses[k].size(); ++n) {
        particles.add_body({{}, settings[k].shape_of(n), known, poses[k][n]}, box,
                           settings[k].species);
        kind.push_back(k);
      }
    }
  return kind;
}

template <int D>
void move_bodies(const std::vector<std::vector<Vec<D>>>& constituents, const Box<D>& box,
                 const std::string& file, Particles<D>& particles) {
  const auto fail = [&](const std::string& what) {
    throw ConfigError(fmt::format(
        "{}: {}: start from it with the [[body]] entries of the run that wrote it", file, what));
  };
  if (constituents.size() != particles.bodies.size())
    fail(
        fmt::format("it has {} bodies, the case {}", constituents.size(), particles.bodies.size()));
  const std::vector<std::int32_t> index_of = particles.index_of_id();
  for (std::size_t b = 0; b < constituents.size(); ++b) {
    RigidBody<D>& body = particles.bodies[b];
    const std::vector<Vec<D>>& points = constituents[b];
    if (points.size() != body.frame.size())
      fail(fmt::format("body {} has {} particles in it, {} in the case", b, points.size(),
                       body.frame.size()));
    std::vector<Vec<D>> arms(points.size());
    find_arms<D>(box, points, arms);
    RigidPose<D> pose = body.pose;
    pose.centre = points[0] - arms[0];
    pose.image = {};
    box.wrap(pose.centre);
    const auto fits = [&](const RigidPose<D>& at) {
      double off = 0.0, size = 0.0;
      for (std::size_t k = 0; k < points.size(); ++k) {
        const Vec<D> b_k = at.orientation.turn(body.frame[k]);
        off = std::max(off, norm(arms[k] - b_k));
        size = std::max(size, norm(b_k));
      }
      return off <= 1e-5 * size;
    };
    // A line has no orientation about itself to be found: where it fits, that of the case.
    if (!fits(pose)) pose.orientation = best_rotation(body.frame, arms);
    if (!fits(pose)) fail(fmt::format("body {} has another shape than in the case", b));
    body.pose = pose;
    for (std::size_t k = 0; k < points.size(); ++k) {
      const auto p = index(index_of[index(body.members[k])]);
      place_constituent(body, pose, k, box, particles.position[p], particles.image[p]);
    }
  }
}

#define ODPD_INSTANTIATE(D)                                                                      \
  template struct BodySettings<D>;                                                               \
  template void move_bodies<D>(const std::vector<std::vector<Vec<D>>>&, const Box<D>&,           \
                               const std::string&, Particles<D>&);                               \
  template std::vector<std::size_t> place_bodies<D>(const std::vector<BodySettings<D>>&,         \
                                                    const Box<D>&, const Vec<D>&, const Vec<D>&, \
                                                    std::uint64_t, bool, Particles<D>&);
ODPD_INSTANTIATE(2)
ODPD_INSTANTIATE(3)
#undef ODPD_INSTANTIATE

}  // namespace odpd
