#include "odpd/scene/body_room.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace odpd {

namespace {

// Normals in the frame of a body, each standing for its opposite too: along x, across to it, and tilted.
template <int D>
std::vector<Vec<D>> slab_normals();

constexpr int normals_around = 12, normal_tilts = 6;

template <>
std::vector<Vec<2>> slab_normals<2>() {
  std::vector<Vec<2>> normals;
  for (int k = 0; k < 2 * normals_around; ++k) {
    const double angle = std::numbers::pi * k / (2 * normals_around);
    normals.push_back({{std::cos(angle), std::sin(angle)}});
  }
  return normals;
}

template <>
std::vector<Vec<3>> slab_normals<3>() {
  std::vector<Vec<3>> normals{{{1.0, 0.0, 0.0}}};
  for (int t = 0; t < normal_tilts; ++t)
    for (int k = 0; k < normals_around; ++k) {
      const double tilt = 0.5 * std::numbers::pi * t / normal_tilts;
      const double angle = 2.0 * std::numbers::pi * k / normals_around, across = std::cos(tilt);
      normals.push_back({{std::sin(tilt), across * std::cos(angle), across * std::sin(angle)}});
    }
  return normals;
}

}  // namespace

template <int D>
BodyRoom<D>::BodyRoom(const Box<D>& box, const Particles<D>& particles) : box_(box), balls_(box) {
  constexpr double long_below =
      1.1;  // ellipsoids and rods of 2 : 1; cubes and tetrahedra are not (1.15)
  const std::vector<Vec<D>> normals = slab_normals<D>();
  for (const RigidBody<D>& body : particles.bodies) {
    double radius = 0.0;
    for (const Vec<D>& b : body.frame) radius = std::max(radius, norm(b));
    balls_.add(body.pose.centre, radius);
    std::vector<Slab> slabs;
    double narrowest = 2.0 * radius;
    for (const Vec<D>& n : normals) {
      Slab slab{body.pose.orientation.turn(n), 0.0, 0.0};
      for (const Vec<D>& b : body.frame) {
        slab.low = std::min(slab.low, dot(n, b));
        slab.high = std::max(slab.high, dot(n, b));
      }
      narrowest = std::min(narrowest, slab.high - slab.low);
      slabs.push_back(slab);
    }
    slabs_.push_back(narrowest < long_below * radius ? slabs : std::vector<Slab>{});
  }
}

template <int D>
bool BodyRoom<D>::holds(const Vec<D>& r) const {
  return balls_.find_near(r, 0.0, [&](std::size_t k) {
    const Vec<D> arm = box_.separation(r, balls_.centre(k));
    if (!(norm(arm) < balls_.radius(k))) return false;
    return std::all_of(slabs_[k].begin(), slabs_[k].end(), [&](const Slab& slab) {
      const double along = dot(slab.normal, arm);
      return slab.low < along && along < slab.high;
    });
  });
}

template class BodyRoom<2>;
template class BodyRoom<3>;

}  // namespace odpd
