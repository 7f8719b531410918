// Rotations, arms and rigid motions by themselves.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "odpd/particles/particles.h"
#include "support/dimensions.h"
#include "support/errors.h"
#include "support/points.h"

namespace {

using odpd::Particles;
using odpd::RigidBody;
using odpd::RigidMotion;
using odpd::Rotation;
using odpd::Vec;

template <int D>
RigidBody<D> some_body(std::size_t points) {
  RigidBody<D> body;
  body.frame = support::random_vectors<D>(points, 7);
  Vec<D> mean{};
  for (const Vec<D>& b : body.frame) mean += (1.0 / static_cast<double>(points)) * b;
  for (Vec<D>& b : body.frame) b = 0.5 * (b - mean);
  return body;
}

template <int D>
Vec<D> some_angle(std::uint64_t seed, double size) {
  Vec<D> w{};
  const auto numbers = support::random_numbers(3, seed);
  for (int c = 0; c < odpd::rotation_components<D>; ++c)
    w[c] = size * numbers[static_cast<std::size_t>(c)];
  return w;
}

template <class Dimension>
class RigidBodyTest : public ::testing::Test {};
TYPED_TEST_SUITE(RigidBodyTest, support::Dimensions);

TYPED_TEST(RigidBodyTest, KeepsItsDistancesOver100000Steps) {
  constexpr int D = TypeParam::D;
  odpd::Box<D> box{support::uniform_vec<D>(4.0), {}};
  box.periodic.fill(true);
  RigidBody<D> body = some_body<D>(5);
  for (std::uint64_t step = 0; step < 100000; ++step) {
    const Vec<D> velocity = support::random_vectors<D>(1, step)[0];
    body.pose.advance({velocity, some_angle<D>(step, 3.0)}, 0.05, box);
  }
  EXPECT_NE(body.pose.image, (typename odpd::RigidPose<D>::Image{}));
  typename odpd::RigidPose<D>::Image image;
  std::vector<Vec<D>> r(5);
  for (std::size_t k = 0; k < 5; ++k) place_constituent(body, body.pose, k, box, r[k], image);
  for (std::size_t k = 0; k < 5; ++k)
    for (std::size_t l = 0; l < k; ++l)
      EXPECT_NEAR(norm(box.separation(r[k], r[l])), norm(body.frame[k] - body.frame[l]), 1e-12);
}

// Many small turns about one axis are one large turn; a turn changes vectors by angle x vector to first order.
TYPED_TEST(RigidBodyTest, TurnsByTheExponential) {
  constexpr int D = TypeParam::D;
  const Vec<D> angle = some_angle<D>(3, 2.0), a = support::random_vectors<D>(1, 5)[0];
  Rotation<D> once, often, small;
  once.advance(angle);
  for (int k = 0; k < 1000; ++k) often.advance(1e-3 * angle);
  EXPECT_LT(norm(once.turn(a) - often.turn(a)), 1e-12);
  EXPECT_NEAR(norm(once.turn(a)), norm(a), 1e-14);
  EXPECT_GT(norm(once.turn(a) - a), 0.1);
  small.advance(1e-6 * angle);
  EXPECT_LT(norm(small.turn(a) - a - 1e-6 * swing(angle, a)), 2e-11);
  // torque(a, f) . w = f . swing(w, a)
  const Vec<D> f = support::random_vectors<D>(1, 6)[0];
  EXPECT_NEAR(dot(odpd::torque(a, f), angle), dot(f, swing(angle, a)), 1e-14);
}

TYPED_TEST(RigidBodyTest, ArmsAndMotionsAreFoundAcrossTheBoundary) {
  constexpr int D = TypeParam::D;
  odpd::Box<D> box{support::uniform_vec<D>(4.0), {}};
  box.periodic.fill(true);
  Particles<D> particles;
  particles.walls = 1;
  particles.add({}, 0, odpd::Group::wall(0));
  RigidBody<D> body = some_body<D>(4);
  body.pose.centre = support::uniform_vec<D>(3.9);
  body.pose.orientation.advance(some_angle<D>(1, 1.0));
  particles.add_body(body, box, 0);
  body.known = true;
  particles.add_body(body, box, 0);
  EXPECT_EQ(particles.body_of(0), -1);
  EXPECT_EQ(particles.body_of(1), 0);
  EXPECT_EQ(particles.body_of(5), 1);
  EXPECT_FALSE(particles.is_known(1));
  EXPECT_TRUE(particles.is_known(5));
  const std::span<const Vec<D>> positions(particles.position.data() + 1, 4);
  std::vector<Vec<D>> arms(4);
  odpd::find_arms<D>(box, positions, arms);
  const auto orientation = odpd::best_rotation(body.frame, arms);
  for (std::size_t k = 0; k < 4; ++k)
    EXPECT_LT(norm(orientation.turn(body.frame[k]) - arms[k]), 1e-13);
  const RigidMotion<D> motion{support::random_vectors<D>(1, 2)[0], some_angle<D>(4, 1.0)};
  std::vector<Vec<D>> velocities;
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_LT(norm(arms[k] - body.pose.orientation.turn(body.frame[k])), 1e-13);
    velocities.push_back(motion.velocity + swing(motion.angular, arms[k]));
  }
  const RigidMotion<D> found = odpd::rigid_motion<D>(arms, velocities);
  EXPECT_LT(norm(found.velocity - motion.velocity), 1e-13);
  EXPECT_LT(norm(found.angular - motion.angular), 1e-12);
}

// A rod: points on a line, `thick` times their distances away from it in turn.
std::vector<Vec<3>> rod_along(const Vec<3>& direction, double length, double thick = 0.0) {
  const Vec<3> u = (1.0 / norm(direction)) * direction;
  Vec<3> across = odpd::swing(u, Vec<3>{{0.3, -0.7, 0.5}});
  across *= 1.0 / norm(across);
  const std::array<double, 5> along{-0.5, -0.2, 0.0, 0.3, 0.4};
  std::vector<Vec<3>> arms;
  double side = thick;
  for (const double x : along) {
    arms.push_back(length * (x * u + side * across));
    side = -side;
  }
  Vec<3> mean{};
  for (const Vec<3>& a : arms) mean += 0.2 * a;
  for (Vec<3>& a : arms) a -= mean;
  return arms;
}

// Also those almost along an axis of the box, where an elimination in its order would meet a small pivot early.
std::vector<Vec<3>> directions() {
  std::vector<Vec<3>> all = support::random_vectors<3>(20, 8);
  for (const double tilt : {0.0, 1e-9, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3})
    for (int c = 0; c < 3; ++c) {
      Vec<3> u = tilt * Vec<3>{{0.4, -0.6, 0.7}};
      u[c] += 1.0;
      all.push_back(u);
    }
  return all;
}

TYPED_TEST(RigidBodyTest, MomentsOfInertiaAreThoseOfTheArms) {
  constexpr int D = TypeParam::D;
  const std::vector<Vec<D>> arms = some_body<D>(5).frame;
  const auto inertia = odpd::moment_of_inertia<D>(arms);
  EXPECT_EQ(odpd::rotations<D>(arms), odpd::rotation_components<D>);
  double square = 0.0;
  for (const Vec<D>& a : arms) square += dot(a, a);
  for (int c = 0; c < D; ++c)
    for (int k = 0; k < D; ++k) {
      double expected = D == 2 ? (c + k == 0 ? square : 0.0) : (c == k ? square : 0.0);
      for (const Vec<D>& a : arms) expected -= D == 3 ? a[c] * a[k] : 0.0;
      EXPECT_NEAR(inertia[static_cast<std::size_t>(c)][k], expected, 1e-14);
    }
}

TEST(Rod, TurnsAboutTwoAxesWhicheverWayItPoints) {
  const Vec<3> l{{0.3, 1.1, -0.8}};
  for (const double length : {1e-3, 1.0, 1e4})
    for (const Vec<3>& direction : directions()) {
      const Vec<3> u = (1.0 / norm(direction)) * direction;
      const std::vector<Vec<3>> arms = rod_along(direction, length);
      EXPECT_EQ(odpd::rotations<3>(arms), 2);
      double moment = 0.0;
      for (const Vec<3>& a : arms) moment += dot(a, a);
      const Vec<3> w = odpd::angular_velocity<3>(arms, l);
      EXPECT_LT(norm(moment * w - (l - dot(u, l) * u)), 1e-13);
      EXPECT_LT(std::abs(moment * dot(u, w)), 1e-14);
    }
}

// As positions in a box have them: far from the origin, across its boundary.
TEST(Rod, IsOneAfterRoundingToTheBox) {
  odpd::Box<3> box{support::uniform_vec<3>(100.0), {true, true, true}};
  for (const Vec<3>& direction : directions()) {
    std::vector<Vec<3>> points = rod_along(direction, 1.0), arms(points.size());
    for (Vec<3>& r : points) {
      r += support::uniform_vec<3>(99.9);
      box.wrap(r);
    }
    odpd::find_arms<3>(box, points, arms);
    EXPECT_EQ(odpd::rotations<3>(arms), 2);
  }
}

TEST(Rod, OfSomeThicknessTurnsAboutAllAxes) {
  const Vec<3> l{{0.3, 1.1, -0.8}};
  for (const Vec<3>& direction : directions()) {
    EXPECT_EQ(odpd::rotations<3>(rod_along(direction, 2.0, 1e-7)), 2);
    for (const double thick : {1e-5, 1e-4, 1e-2}) {
      const std::vector<Vec<3>> arms = rod_along(direction, 2.0, thick);
      EXPECT_EQ(odpd::rotations<3>(arms), 3);
      const Vec<3> w = odpd::angular_velocity<3>(arms, l);
      const auto inertia = odpd::moment_of_inertia<3>(arms);
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(dot(inertia[static_cast<std::size_t>(c)], w), l[c], 1e-14 / (thick * thick));
    }
  }
}

TEST(Rod, MovesWithoutSpinAboutItsLine) {
  const std::vector<Vec<3>> arms = rod_along({{1.0, 2.0, -0.5}}, 1.3);
  const RigidMotion<3> motion{{{0.1, -0.4, 0.2}}, {{0.7, 0.2, 0.9}}};
  std::vector<Vec<3>> velocities;
  for (const Vec<3>& a : arms) velocities.push_back(motion.velocity + swing(motion.angular, a));
  const RigidMotion<3> found = odpd::rigid_motion<3>(arms, velocities);
  for (std::size_t k = 0; k < arms.size(); ++k)
    EXPECT_LT(norm(found.velocity + swing(found.angular, arms[k]) - velocities[k]), 1e-14);
  EXPECT_NEAR(dot(found.angular, arms[0]), 0.0, 1e-14);
  EXPECT_GT(std::abs(dot(motion.angular, arms[0])), 0.1);
}

TEST(RigidBody, InOnePointIsRefused) {
  const std::vector<Vec<3>> points(3);
  EXPECT_EQ(odpd::rotations<3>(points), 0);
  support::expect_error<odpd::ConfigError>([&] { odpd::angular_velocity<3>(points, {}); },
                                           {"point"});
  const std::vector<Vec<2>> point{{{0.0, 0.0}}};
  EXPECT_EQ(odpd::rotations<2>(point), 0);
  support::expect_error<odpd::ConfigError>([&] { odpd::angular_velocity<2>(point, {}); },
                                           {"point"});
}

}  // namespace
