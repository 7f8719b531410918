// Rotations, arms and rigid motions by themselves.
#include <gtest/gtest.h>

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

TEST(RigidBody, WithoutAMomentOfInertiaIsRefused) {
  const std::vector<Vec<3>> rod{{{-1.0, 0.0, 0.0}}, {{1.0, 0.0, 0.0}}};
  support::expect_error<odpd::ConfigError>([&] { odpd::angular_velocity<3>(rod, {}); }, {"line"});
  const std::vector<Vec<2>> point{{{0.0, 0.0}}};
  support::expect_error<odpd::ConfigError>([&] { odpd::angular_velocity<2>(point, {}); },
                                           {"point"});
}

}  // namespace
