#include "odpd/scene/bodies.h"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "odpd/core/error.h"
#include "odpd/core/index.h"
#include "odpd/core/random.h"

namespace odpd {

template <int D>
double BodySettings<D>::radius() const {
  double most = 0.0;
  for (const Vec<D>& b : shape) most = std::max(most, norm(b));
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

template <int D>
struct Placer {
  const Box<D>& box;
  const Vec<D>& low;
  const Vec<D>& high;
  CounterRandom random;
  struct Taken {
    Vec<D> centre;
    double reach;
  };
  std::vector<Taken> taken;

  // Clear of the bodies placed so far, and of the ends of bounded directions.
  bool fits(const Vec<D>& centre, double reach) const {
    for (int c = 0; c < D; ++c)
      if (!box.is_periodic(c) && (centre[c] - low[c] < reach || high[c] - centre[c] < reach))
        return false;
    return std::all_of(taken.begin(), taken.end(), [&](const Taken& t) {
      return norm(box.separation(centre, t.centre)) >= std::max(reach + t.reach, 0.0);
    });
  }

  RigidPose<D> random_pose(const BodySettings<D>& s, std::uint64_t number) const {
    constexpr std::uint64_t most_attempts = 10000;
    const double reach = s.radius() + 0.5 * s.clearance;
    for (std::uint64_t attempt = 0; attempt < most_attempts; ++attempt) {
      const auto u = random.uniforms(attempt, 0, number, 0);
      RigidPose<D> pose;
      for (int c = 0; c < D; ++c) pose.centre[c] = low[c] + (high[c] - low[c]) * u[index(c)];
      if (!fits(pose.centre, reach)) continue;
      turn_at_random(random.uniforms(attempt, 1, number, 0), pose.orientation);
      return pose;
    }
    throw ConfigError(fmt::format(
        "[[body]] '{}': no room was found for body {} of {}: lower its count or clearance, give "
        "positions, or use a larger box",
        s.name, taken.size() + 1, s.bodies()));
  }
};

}  // namespace

template <int D>
std::vector<std::size_t> place_bodies(const std::vector<BodySettings<D>>& settings,
                                      const Box<D>& box, const Vec<D>& low, const Vec<D>& high,
                                      std::uint64_t seed, bool at_random, Particles<D>& particles) {
  Placer<D> placer{box, low, high, CounterRandom(seed, Stream::body_poses), {}};
  // Given places come first, so that random ones keep clear of them.
  std::vector<std::vector<RigidPose<D>>> poses(settings.size());
  for (std::size_t k = 0; k < settings.size(); ++k)
    for (const Vec<D>& centre : settings[k].positions) {
      RigidPose<D> pose;
      pose.centre = centre;
      box.wrap(pose.centre);
      poses[k].push_back(pose);
      placer.taken.push_back({pose.centre, settings[k].radius() + 0.5 * settings[k].clearance});
    }
  std::uint64_t number = 0;
  for (std::size_t k = 0; k < settings.size(); ++k)
    for (std::int64_t n = 0; settings[k].positions.empty() && n < settings[k].count; ++n) {
      RigidPose<D> pose;
      pose.centre = low;
      if (at_random) pose = placer.random_pose(settings[k], number++);
      poses[k].push_back(pose);
      placer.taken.push_back(
          {poses[k].back().centre, settings[k].radius() + 0.5 * settings[k].clearance});
    }
  std::vector<std::size_t> kind;
  for (const bool known : {false, true})
    for (std::size_t k = 0; k < settings.size(); ++k) {
      if ((settings[k].motion != BodyMotion::free) != known) continue;
      for (const RigidPose<D>& pose : poses[k]) {
        particles.add_body({{}, settings[k].shape, known, pose}, box, settings[k].species);
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
    // A fixed one, which may be a line without an orientation to be found, has that of the case.
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
