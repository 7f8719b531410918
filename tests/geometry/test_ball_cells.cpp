// Balls found by cells are those found by looking at every one.
#include <gtest/gtest.h>

#include <algorithm>

#include "odpd/geometry/ball_cells.h"
#include "support/dimensions.h"
#include "support/points.h"

namespace {

using odpd::BallCells;
using odpd::Box;
using odpd::Vec;

template <typename T>
class BallCellsTest : public testing::Test {};
TYPED_TEST_SUITE(BallCellsTest, support::Dimensions);

template <int D>
struct SeenBall {
  Vec<D> centre;
  double radius;
};

template <int D>
void expect_all_found(const Box<D>& box, const BallCells<D>& cells,
                      const std::vector<SeenBall<D>>& balls, std::uint64_t seed) {
  ASSERT_EQ(cells.size(), balls.size());
  for (const double distance : {-0.1, 0.0, 0.3, 1.7, 40.0})
    for (const Vec<D>& r : support::random_points<D>(Vec<D>{}, box.size, 60, seed)) {
      std::vector<int> calls(balls.size(), 0);
      cells.find_near(r, distance, [&](std::size_t k) {
        ++calls[k];
        return false;
      });
      bool overlaps = false;
      for (std::size_t k = 0; k < balls.size(); ++k) {
        const double apart = norm(box.separation(r, balls[k].centre));
        EXPECT_LE(calls[k], 1);
        const bool near = apart <= distance + balls[k].radius;
        EXPECT_TRUE(calls[k] == 1 || !near) << "ball " << k;
        overlaps = overlaps || apart < distance + balls[k].radius;
      }
      EXPECT_EQ(cells.overlaps(r, distance), overlaps);
    }
}

template <int D>
void check_box(const Box<D>& box) {
  BallCells<D> cells(box);
  std::vector<SeenBall<D>> balls;
  expect_all_found(box, cells, balls, 1);
  const auto places = support::random_points<D>(Vec<D>{}, box.size, 260, 2);
  const std::vector<double> sizes{0.0, 0.05, 0.11, 0.4, 1.5, 0.07};
  for (std::size_t k = 0; k < 200; ++k) {
    balls.push_back({places[k], sizes[k % sizes.size()]});
    cells.add(balls.back().centre, balls.back().radius);
    if (k == 0 || k == 20) expect_all_found(box, cells, balls, 3);
  }
  expect_all_found(box, cells, balls, 4);
  for (std::size_t k = 0; k < 60; ++k) {
    balls[3 * k].centre = places[200 + k];
    cells.move(3 * k, balls[3 * k].centre);
    EXPECT_EQ(cells.centre(3 * k), balls[3 * k].centre);
  }
  expect_all_found(box, cells, balls, 5);
}

TYPED_TEST(BallCellsTest, FindsAllInPeriodicAndBoundedBoxes) {
  constexpr int D = TypeParam::D;
  for (const double length : {1.0, 3.0, 9.0})
    for (int mask = 0; mask < (1 << D); ++mask) {
      Box<D> box;
      for (int c = 0; c < D; ++c) {
        box.size[c] = length + c;
        box.periodic[static_cast<std::size_t>(c)] = (mask >> c) % 2 == 1;
      }
      check_box(box);
    }
}

TYPED_TEST(BallCellsTest, FindsAllAcrossSlidingFaces) {
  constexpr int D = TypeParam::D;
  for (const double offset : {0.0, 0.8, 3.2, -4.4}) {
    Box<D> box;
    box.size = support::uniform_vec<D>(6.0);
    box.size[0] = 9.0;
    box.periodic.fill(true);
    box.shear.emplace();
    box.shear->start = offset;
    check_box(box.at(0.0));
  }
}

// Where one place has two coordinates, and outside of the box.
TYPED_TEST(BallCellsTest, FindsPointsAtTheFaces) {
  constexpr int D = TypeParam::D;
  Box<D> box;
  box.size = support::uniform_vec<D>(5.0);
  box.periodic[0] = true;
  BallCells<D> cells(box);
  Vec<D> at = support::uniform_vec<D>(2.0);
  // Enough points for several cells.
  for (const Vec<D>& r :
       support::random_points<D>(support::uniform_vec<D>(1.0), support::uniform_vec<D>(4.0), 99, 1))
    cells.add(r, 0.0);
  const auto is_found = [&](const Vec<D>& r, double distance, std::size_t wanted) {
    return cells.find_near(r, distance, [&](std::size_t k) { return k == wanted; });
  };
  at[0] = 0.0;
  cells.add(at, 0.0);
  at[0] = 5.0;
  EXPECT_TRUE(is_found(at, 0.0, 99));
  cells.move(99, at);
  at[0] = 0.0;
  EXPECT_TRUE(is_found(at, 0.0, 99));
  at[0] = -1.2;
  cells.move(99, at);
  at[0] = 3.8;
  EXPECT_TRUE(is_found(at, 1e-9, 99));
  at[1] = 7.0;
  cells.move(99, at);
  at[1] = 6.0;
  EXPECT_TRUE(is_found(at, 1.0, 99));
}

}  // namespace
