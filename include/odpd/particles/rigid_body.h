#pragma once
// A rigid body of constituent particles of equal mass: constituent k stands at
//
//   r_k = X + Q b_k,   sum_k b_k = 0,
//
// X the centre, Q the orientation, b_k fixed in the body. Positions are always made from X and Q, so that distances inside
// it stay what they are.
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

/// The rigid motion closest to given velocities of points at these arms, least squares; for velocities that are rigid, that
/// motion. Also the motion of momentum sum v and angular momentum sum torque(a, v), per mass of a point.
template <int D>
RigidMotion<D> rigid_motion(std::span<const Vec<D>> arms, std::span<const Vec<D>> velocities);
/// w with sum_k X(e_k)^T X(a_k) w = l, a matrix that must be symmetric; none where it is singular.
template <int D>
std::optional<Vec<D>> turn_under(std::span<const Vec<D>> arms, std::span<const Vec<D>> ends,
                                 const Vec<D>& l);
/// w with sum_k X(a_k)^T X(a_k) w = l. Throws ConfigError for constituents on a line (3D) or in one point.
template <int D>
Vec<D> angular_velocity(std::span<const Vec<D>> arms, const Vec<D>& l);

}  // namespace odpd
