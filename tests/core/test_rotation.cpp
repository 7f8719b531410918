// The best rotation between two sets of points.
#include <gtest/gtest.h>

#include <numbers>
#include <vector>

#include "odpd/core/rotation.h"
#include "support/dimensions.h"
#include "support/points.h"

namespace {

using odpd::Rotation;
using odpd::Vec;

template <int D>
double misfit(const Rotation<D>& rotation, const std::vector<Vec<D>>& from,
              const std::vector<Vec<D>>& to) {
  double sum = 0.0;
  for (std::size_t k = 0; k < from.size(); ++k) {
    const Vec<D> d = to[k] - rotation.turn(from[k]);
    sum += dot(d, d);
  }
  return sum;
}

template <class T>
class BestRotation : public ::testing::Test {};
TYPED_TEST_SUITE(BestRotation, support::Dimensions);

TYPED_TEST(BestRotation, IsTheOneThatWasMade) {
  constexpr int D = TypeParam::D;
  for (const double angle : {0.0, 1e-9, 0.3, 1.5, std::numbers::pi}) {
    for (const bool flat : {false, true}) {
      auto from = support::random_vectors<D>(5, 3);
      // In 3D a figure in a plane fixes the rotation, too.
      for (Vec<D>& a : from)
        if (flat && D > 2) a[D - 1] = 0.0;
      Rotation<D> made;
      Vec<D> axis{};
      axis[0] = D == 2 ? 1.0 : 0.8;
      axis[1] = D == 2 ? 0.0 : -0.6;
      made.advance(angle * axis);
      std::vector<Vec<D>> to;
      for (const Vec<D>& a : from) to.push_back(made.turn(a));
      EXPECT_LT(misfit(odpd::best_rotation(from, to), from, to), 1e-26) << angle << " " << flat;
    }
  }
}

TYPED_TEST(BestRotation, IsBetterThanItsNeighboursAndBalancesTheTorque) {
  constexpr int D = TypeParam::D;
  for (std::uint64_t seed = 1; seed < 20; ++seed) {
    const auto from = support::random_vectors<D>(4, seed);
    const auto to = support::random_vectors<D>(4, seed + 100);
    const Rotation<D> best = odpd::best_rotation(from, to);
    Vec<D> torque{};
    for (std::size_t k = 0; k < from.size(); ++k) torque += odpd::torque(best.turn(from[k]), to[k]);
    EXPECT_LT(norm(torque), 1e-12);
    const double least = misfit(best, from, to);
    for (int c = 0; c < odpd::rotation_components<D>; ++c)
      for (const double step : {-2.0, -0.5, -1e-3, 1e-3, 0.5, 2.0}) {
        Rotation<D> other = best;
        Vec<D> w{};
        w[c] = step;
        other.advance(w);
        EXPECT_GT(misfit(other, from, to), least);
      }
  }
}

TYPED_TEST(BestRotation, OfNothingIsARotation) {
  constexpr int D = TypeParam::D;
  const std::vector<Vec<D>> zero(3);
  const Vec<D> one = support::uniform_vec<D>(1.0);
  EXPECT_NEAR(norm(odpd::best_rotation(zero, zero).turn(one)), norm(one), 1e-15);
}

// Onto the direction, by the angle between the two and no farther: a vector across both stays.
TYPED_TEST(BestRotation, OntoADirectionIsTheShortest) {
  constexpr int D = TypeParam::D;
  auto from = support::random_vectors<D>(12, 5), to = support::random_vectors<D>(12, 6);
  to[0] = 3.0 * from[0];
  to[1] = -0.2 * from[1];
  from[2] = to[2] = Vec<D>{};
  from[2][0] = 1.0;
  to[2][0] = -1.0;
  for (std::size_t k = 0; k < from.size(); ++k) {
    const Rotation<D> q = odpd::rotation_onto(from[k], to[k]);
    const Vec<D> turned = q.turn(from[k]);
    EXPECT_LT(norm((1.0 / norm(turned)) * turned - (1.0 / norm(to[k])) * to[k]), 1e-12) << k;
    EXPECT_NEAR(norm(turned), norm(from[k]), 1e-12);
    if (D < 3 || k < 3) continue;
    const Vec<D> across = odpd::torque(from[k], to[k]);
    EXPECT_LT(norm(q.turn(across) - across), 1e-12) << k;
  }
}

}  // namespace
