#include <gtest/gtest.h>

#include <cmath>

#include "odpd/geometry/box.h"
#include "support/dimensions.h"
#include "support/points.h"

namespace {

using odpd::Box;
using odpd::Vec;

template <int D>
Box<D> odd_box(bool bounded_y) {
  Box<D> box;
  for (int c = 0; c < D; ++c) box.size[c] = 2.7 + 0.31 * c;
  box.periodic.fill(true);
  box.periodic[1] = !bounded_y;
  return box;
}

template <class T>
class BoxTest : public ::testing::Test {};
TYPED_TEST_SUITE(BoxTest, support::Dimensions);

TYPED_TEST(BoxTest, CountsAndVolume) {
  constexpr int D = TypeParam::D;
  const Box<D> box = odd_box<D>(true);
  EXPECT_EQ(box.periodic_directions(), D - 1);
  EXPECT_FALSE(box.is_periodic(1));
  double volume = 1.0;
  for (int c = 0; c < D; ++c) volume *= box.size[c];
  EXPECT_DOUBLE_EQ(box.volume(), volume);
}

TYPED_TEST(BoxTest, SeparationIsThatOfTheNearestImages) {
  constexpr int D = TypeParam::D;
  for (const bool bounded : {false, true}) {
    const Box<D> box = odd_box<D>(bounded);
    const auto points = support::random_points<D>(Vec<D>{}, box.size, 200, 3);
    for (std::size_t k = 0; k + 1 < points.size(); k += 2) {
      const Vec<D> d = box.separation(points[k], points[k + 1]);
      EXPECT_EQ(d, -1.0 * box.separation(points[k + 1], points[k])) << "antisymmetric, bit by bit";
      for (int c = 0; c < D; ++c) {
        const double plain = points[k][c] - points[k + 1][c];
        double nearest = plain;
        for (int image = -2; image <= 2 && box.is_periodic(c); ++image) {
          const double shifted = plain + image * box.size[c];
          if (std::abs(shifted) < std::abs(nearest)) nearest = shifted;
        }
        EXPECT_NEAR(d[c], nearest, 1e-14);
      }
    }
  }
}

TYPED_TEST(BoxTest, WrapKeepsTheUnwrappedPlace) {
  constexpr int D = TypeParam::D;
  const Box<D> box = odd_box<D>(true);
  const auto far = support::random_points<D>(support::uniform_vec<D>(-60.0),
                                             support::uniform_vec<D>(60.0), 500, 5);
  for (const Vec<D>& start : far) {
    Vec<D> r = start;
    std::array<std::int32_t, D> image{};
    box.wrap(r, image);
    for (int c = 0; c < D; ++c) {
      const auto crossings = image[static_cast<std::size_t>(c)];
      EXPECT_NEAR(r[c] + crossings * box.size[c], start[c], 1e-12);
      if (box.is_periodic(c)) {
        EXPECT_GE(r[c], 0.0);
        EXPECT_LT(r[c], box.size[c]);
      } else {
        EXPECT_EQ(r[c], start[c]) << "bounded directions are left alone";
        EXPECT_EQ(crossings, 0);
      }
    }
    Vec<D> again = r;
    box.wrap(again, image);
    EXPECT_EQ(again, r) << "wrapping twice changes nothing";
  }
}

// Coordinates next to the ends of the box, where rounding decides.
TYPED_TEST(BoxTest, WrapStaysInsideNextToTheEnds) {
  constexpr int D = TypeParam::D;
  for (const double length : {0.1, 0.7, 2.7, 10.0, 1.0 / 3.0}) {
    Box<D> box;
    box.size = support::uniform_vec<D>(length);
    box.periodic.fill(true);
    for (int k = -40; k <= 40; ++k) {
      for (const double towards : {-1e300, 0.0, 1e300}) {
        Vec<D> r;
        const double end = k * length;
        r[0] = towards == 0.0 ? end : std::nextafter(end, towards);
        const double start = r[0];
        std::array<std::int32_t, D> image{};
        box.wrap(r, image);
        EXPECT_GE(r[0], 0.0) << "length " << length << ", edge " << k << ", towards " << towards;
        EXPECT_LT(r[0], length);
        EXPECT_NEAR(r[0] + image[0] * length, start, 1e-14 * (1.0 + std::abs(end)));
      }
    }
  }
}

TEST(Box, ATinyNegativeCoordinateBecomesZeroWithoutCrossing) {
  const Box<2> box{{10.0, 10.0}, {true, true}};
  Vec<2> r{{-1e-20, -0.0}};
  std::array<std::int32_t, 2> image{4, -2};
  box.wrap(r, image);
  EXPECT_EQ(r[0], 0.0);
  EXPECT_EQ(r[1], 0.0);
  EXPECT_EQ(image[0], 4);
  EXPECT_EQ(image[1], -2);
  Vec<2> end{{10.0, 5.0}};
  box.wrap(end, image);
  EXPECT_EQ(end[0], 0.0);
  EXPECT_EQ(image[0], 5);
}

}  // namespace
