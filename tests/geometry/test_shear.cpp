// Boxes whose images slide (Lees-Edwards).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "odpd/geometry/pair_list.h"
#include "support/dimensions.h"
#include "support/points.h"

namespace {

using odpd::Box;
using odpd::PairList;
using odpd::Shear;
using odpd::Vec;
using Rows = std::vector<std::vector<std::int32_t>>;

template <typename T>
class ShearTest : public testing::Test {};
TYPED_TEST_SUITE(ShearTest, support::Dimensions);

template <int D>
Box<D> sheared_box(const Vec<D>& size, const Shear& shear, double t) {
  Box<D> box;
  box.size = size;
  box.periodic.fill(true);
  box.shear = shear;
  return box.at(t);
}

// The nearest a - b over all images, each written down.
template <int D>
Vec<D> nearest(const Box<D>& box, const Vec<D>& a, const Vec<D>& b) {
  Vec<D> best = support::uniform_vec<D>(1e9);
  int images = 1;
  for (int c = 0; c < D; ++c) images *= 5;
  for (int image = 0; image < images; ++image) {
    Vec<D> d = a - b;
    int rest = image;
    for (int c = 0; c < D; ++c, rest /= 5) {
      const double up = rest % 5 - 2;
      d[c] -= up * box.size[c];
      if (c == box.shear->gradient) d[box.shear->flow] -= up * box.offset;
    }
    if (dot(d, d) < dot(best, best)) best = d;
  }
  return best;
}

// All pairs of directions.
template <int D, class Test>
void for_all_directions(const Test& test) {
  for (int flow = 0; flow < D; ++flow)
    for (int gradient = 0; gradient < D; ++gradient)
      if (flow != gradient) test(Shear{flow, gradient, 1.0, 0.0, 0.0});
}

TEST(Shear, StrainIsTheIntegralOfTheRate) {
  for (const double frequency : {0.0, 0.7}) {
    const Shear shear{0, 1, 1.3, frequency, 0.0};
    double strain = 0.0;
    const double dt = 1e-3;
    for (int k = 0; k < 5000; ++k) strain += dt * shear.rate_at((k + 0.5) * dt);
    EXPECT_NEAR(shear.strain_at(5.0), strain, 1e-6) << "frequency " << frequency;
  }
}

TYPED_TEST(ShearTest, OffsetStaysWithinHalfABox) {
  constexpr int D = TypeParam::D;
  const Vec<D> size = support::uniform_vec<D>(4.0);
  for_all_directions<D>([&](const Shear& shear) {
    for (int k = 0; k < 50; ++k) {
      const double t = 0.37 * k;
      const Box<D> box = sheared_box<D>(size, shear, t);
      EXPECT_LE(std::abs(box.offset), 2.0);
      const double boxes = (4.0 * t - box.offset) / 4.0;
      EXPECT_NEAR(boxes, std::round(boxes), 1e-12);
      EXPECT_EQ(box.sliding, 4.0);
    }
  });
}

TYPED_TEST(ShearTest, WrappedPointsKeepTheirSeparationsAndTellTheirImages) {
  constexpr int D = TypeParam::D;
  Vec<D> size;
  for (int c = 0; c < D; ++c) size[c] = 4.0 + c;
  for_all_directions<D>([&](const Shear& shear) {
    for (const double t : {0.0, 0.3, 0.77, 11.1}) {
      const Box<D> box = sheared_box<D>(size, shear, t);
      const auto r = support::random_points<D>(-1.9 * size, 2.9 * size, 40, 5);
      for (std::size_t i = 0; i < r.size(); ++i) {
        Vec<D> wrapped = r[i];
        std::array<std::int32_t, static_cast<std::size_t>(D)> image{};
        box.wrap(wrapped, image);
        Vec<D> back = wrapped;
        for (int c = 0; c < D; ++c) {
          EXPECT_GE(wrapped[c], 0.0);
          EXPECT_LT(wrapped[c], size[c]);
          back[c] += image[static_cast<std::size_t>(c)] * size[c];
        }
        back[shear.flow] += image[static_cast<std::size_t>(shear.gradient)] * box.offset;
        EXPECT_LT(norm(back - r[i]), 1e-12);
      }
    }
  });
}

TYPED_TEST(ShearTest, TinyNegativeCoordinatesCrossNothing) {
  constexpr int D = TypeParam::D;
  const Box<D> box = sheared_box<D>(support::uniform_vec<D>(4.0), Shear{0, 1, 1.0, 0.0, 0.0}, 0.3);
  Vec<D> r = support::uniform_vec<D>(1.0);
  r[1] = -1e-18;
  std::array<std::int32_t, static_cast<std::size_t>(D)> image{};
  box.wrap(r, image);
  EXPECT_EQ(r[0], 1.0);
  EXPECT_EQ(r[1], 0.0);
  EXPECT_EQ(image[1], 0);
}

TYPED_TEST(ShearTest, SeparationIsThatOfTheNearestImage) {
  constexpr int D = TypeParam::D;
  const Vec<D> size = support::uniform_vec<D>(3.0);
  int across = 0;
  for_all_directions<D>([&](const Shear& shear) {
    for (int k = 0; k < 8; ++k) {
      const Box<D> box = sheared_box<D>(size, shear, 0.13 * k);
      const auto r = support::random_points<D>(Vec<D>{}, size, 60, static_cast<std::uint64_t>(k));
      for (std::size_t i = 0; i < r.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) {
          const Vec<D> expected = nearest(box, r[i], r[j]);
          // Beyond half the shortest edge the nearest image is not asked for.
          if (norm(expected) > 1.5) continue;
          EXPECT_LT(norm(box.separation(r[i], r[j]) - expected), 1e-12);
          across += box.images_up(r[i] - r[j]) != 0 ? 1 : 0;
          const double up = ((r[i] - r[j]) - expected)[shear.gradient] / 3.0;
          EXPECT_NEAR(box.images_up(r[i] - r[j]), up, 1e-12);
        }
    }
  });
  EXPECT_GT(across, 1000);
}

TYPED_TEST(ShearTest, StraightenedImagesAreBoxesApart) {
  constexpr int D = TypeParam::D;
  const Vec<D> size = support::uniform_vec<D>(3.0);
  for_all_directions<D>([&](const Shear& shear) {
    const Box<D> box = sheared_box<D>(size, shear, 0.21);
    for (const Vec<D>& r : support::random_points<D>(Vec<D>{}, size, 30, 3)) {
      const Vec<D> inside = box.straightened(r);
      Vec<D> image = r;
      image[shear.gradient] += 3.0;
      image[shear.flow] += box.offset;
      Vec<D> expected = inside;
      expected[shear.gradient] += 3.0;
      EXPECT_LT(norm(box.straightened(image) - expected), 1e-12);
      for (int c = 0; c < D; ++c) EXPECT_TRUE(inside[c] >= 0.0 && inside[c] < 3.0);
    }
  });
}

template <int D>
void compare_with_all_images(const Box<D>& box, PairList<D>& list, double reach, std::uint64_t seed,
                             std::size_t points, std::int64_t& pairs) {
  const auto r = support::random_points<D>(Vec<D>{}, box.size, points, seed);
  list.slide(box);
  list.update(r);
  for (std::size_t i = 0; i < r.size(); ++i) {
    std::vector<std::int32_t> row, expected;
    for (const std::int32_t j : list.partners(static_cast<std::int64_t>(i)))
      if (norm(nearest(box, r[i], r[static_cast<std::size_t>(j)])) < reach) row.push_back(j);
    for (std::size_t j = i + 1; j < r.size(); ++j)
      if (norm(nearest(box, r[i], r[j])) < reach) expected.push_back(static_cast<std::int32_t>(j));
    ASSERT_EQ(row, expected) << "offset " << box.offset << " flow " << box.shear->flow
                             << " gradient " << box.shear->gradient;
    pairs += static_cast<std::int64_t>(expected.size());
  }
}

TYPED_TEST(ShearTest, PairListFindsAllImagesAtAnyOffset) {
  constexpr int D = TypeParam::D;
  std::int64_t pairs = 0;
  // From two cells per direction, through odd ones, to boxes of unlike edges; with and without a skin.
  for (const double edge : {2.0, 2.5, 3.4, 4.7})
    for (const double skin : {0.0, 0.35})
      for_all_directions<D>([&](const Shear& shear) {
        Vec<D> size = support::uniform_vec<D>(edge);
        size[shear.flow] += 0.6;
        Box<D> box = sheared_box<D>(size, shear, 0.0);
        PairList<D> list(box, 1.0, skin);
        for (std::uint64_t k = 0; k < 4; ++k)
          compare_with_all_images(box.at(0.05 + 0.273 * static_cast<double>(k)), list, 1.0 + skin,
                                  k, 40, pairs);
        // Offsets of whole cells, and of half a box.
        for (const double offset : {0.0, size[shear.flow] / 3.0, 0.5 * size[shear.flow], -1.0}) {
          box.offset = offset;
          compare_with_all_images(box, list, 1.0 + skin, 77, 40, pairs);
        }
      });
  EXPECT_GT(pairs, 10000);
}

TYPED_TEST(ShearTest, SlidingImagesWithoutOffsetGiveTheListOfThePeriodicBox) {
  constexpr int D = TypeParam::D;
  Box<D> sheared = sheared_box<D>(support::uniform_vec<D>(5.3), Shear{}, 3.0), plain = sheared;
  plain.shear.reset();
  PairList<D> a(sheared, 1.0), b(plain, 1.0);
  const auto r = support::random_points<D>(Vec<D>{}, plain.size, 500, 4);
  a.update(r);
  b.update(r);
  for (std::int64_t row = 0; row < a.rows(); ++row) {
    const auto x = a.partners(row), y = b.partners(row);
    ASSERT_TRUE(std::equal(x.begin(), x.end(), y.begin(), y.end()));
  }
}

TYPED_TEST(ShearTest, AListWithASkinIsNotKeptWhenTheImagesSlide) {
  constexpr int D = TypeParam::D;
  const Box<D> box = sheared_box<D>(support::uniform_vec<D>(4.0), Shear{0, 1, 1.0, 0.0, 0.0}, 0.0);
  PairList<D> list(box, 1.0, 0.5);
  const auto r = support::random_points<D>(Vec<D>{}, box.size, 100, 4);
  list.update(r);
  list.slide(box);
  EXPECT_FALSE(list.update(r));
  list.slide(box.at(0.01));
  EXPECT_TRUE(list.update(r));
}

}  // namespace
