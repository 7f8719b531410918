#pragma once
// A rigid body of constituent particles of equal mass: constituent k stands at
//
//   r_k = X + Q b_k,   sum_k b_k = 0,
//
// X the centre, Q the orientation, b_k fixed in the body. Positions are always made from X and Q, so that distances inside
// it stay what they are. It moves with D velocities and turns about each axis that it has a moment of inertia about,
//
//   I = sum_k X(a_k)^T X(a_k),   a_k = Q b_k   (per mass of a constituent)
//
// In 3D a body whose constituents lie on a line, a rod, has none about that line: five motions instead of six.
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "odpd/core/index.h"
#include "odpd/core/rotation.h"
#include "odpd/geometry/box.h"

namespace odpd {

/// Velocity of the centre (length/time) and angular velocity (1/time).
template <int D>
struct RigidMotion {
  Vec<D> velocity{}, angular{};
};

/// Force (force) and torque (force length).
template <int D>
struct RigidLoad {
  Vec<D> force{}, torque{};
};

/// Where a body is.
template <int D>
struct RigidPose {
  using Image = std::array<std::int32_t, index(D)>;
  Vec<D> centre{};          ///< X, inside the box along periodic directions
  Image image{};            ///< box crossings of X
  Rotation<D> orientation;  ///< Q

  /// X + V dt, exp(w dt) Q.
  void advance(const RigidMotion<D>& motion, double dt, const Box<D>& box) {
    centre += dt * motion.velocity;
    box.wrap(centre, image);
    orientation.advance(dt * motion.angular);
  }
};

template <int D>
struct RigidBody {
  std::vector<std::int64_t> members;  ///< identities of the constituents
  std::vector<Vec<D>> frame;          ///< b_k (length)
  bool known = false;                 ///< its motion is prescribed, not solved for
  RigidPose<D> pose;
};

/// Position of constituent k at a pose, inside the box along periodic directions, and its box crossings.
template <int D>
void place_constituent(const RigidBody<D>& body, const RigidPose<D>& pose, std::size_t k,
                       const Box<D>& box, Vec<D>& position, typename RigidPose<D>::Image& image) {
  position = pose.centre + pose.orientation.turn(body.frame[k]);
  image = pose.image;
  box.wrap(position, image);
}

/// Arms a_k = r_k - X of constituents at these positions (nearest images), X their mean.
template <int D>
void find_arms(const Box<D>& box, std::span<const Vec<D>> positions, std::span<Vec<D>> arms);

/// A moment of inertia below this part of the largest one is none. Rounding leaves 1e-16 of it about the line of a rod, so one
/// that is 1e-6 of its length thick or less counts as a line.
constexpr double least_moment = 1e-12;
/// I, sum_k X(a_k)^T X(a_k) (length^2), symmetric; in 2D one number, at [0][0].
template <int D>
std::array<Vec<D>, index(D)> moment_of_inertia(std::span<const Vec<D>> arms);
/// Axes about which constituents at these arms have a moment of inertia, of `least` or more of the largest one: all (1 in 2D,
/// 3 in 3D), 2 on a line in 3D, 0 in one point.
template <int D>
int rotations(std::span<const Vec<D>> arms, double least = least_moment);

/// The rigid motion closest to given velocities of points at these arms, least squares, and of such the smallest; for velocities
/// that are rigid, that motion, where it has no spin about a line. Also the motion of momentum sum v and angular momentum
/// sum torque(a, v), per mass of a point. Throws as angular_velocity.
template <int D>
RigidMotion<D> rigid_motion(std::span<const Vec<D>> arms, std::span<const Vec<D>> velocities);
/// w = I^+ l, with the pseudo-inverse: what l has along the line of a rod has no effect. Throws ConfigError for constituents in
/// one point.
template <int D>
Vec<D> angular_velocity(std::span<const Vec<D>> arms, const Vec<D>& l);
/// w with sum_k X(e_k)^T X(a_k) w = l, a matrix that must be symmetric; none where it is singular.
template <int D>
std::optional<Vec<D>> turn_under(std::span<const Vec<D>> arms, std::span<const Vec<D>> ends,
                                 const Vec<D>& l);

}  // namespace odpd
