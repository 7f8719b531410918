#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <string>

#include "odpd/core/error.h"
#include "odpd/core/parallel.h"
#include "odpd/geometry/pair_list.h"
#include "support/dimensions.h"
#include "support/errors.h"
#include "support/points.h"

namespace {

using odpd::Box;
using odpd::CellList;
using odpd::PairList;
using odpd::Vec;
using Rows = std::vector<std::vector<std::int32_t>>;

// Nearest distance over all images, without Box::separation.
template <int D>
double distance(const Box<D>& box, const Vec<D>& a, const Vec<D>& b) {
  double square = 0.0;
  for (int c = 0; c < D; ++c) {
    double nearest = std::abs(a[c] - b[c]);
    if (box.is_periodic(c)) nearest = std::min(nearest, std::abs(box.size[c] - nearest));
    square += nearest * nearest;
  }
  return std::sqrt(square);
}

template <int D>
Rows brute_force(const Box<D>& box, const std::vector<Vec<D>>& r, double reach) {
  Rows rows(r.size());
  for (std::size_t i = 0; i < r.size(); ++i) {
    for (std::size_t j = i + 1; j < r.size(); ++j) {
      if (distance(box, r[i], r[j]) < reach) rows[i].push_back(static_cast<std::int32_t>(j));
    }
  }
  return rows;
}

// Rows of the list, restricted to pairs closer than `reach` now.
template <int D>
Rows rows_of(const PairList<D>& list, const Box<D>& box, const std::vector<Vec<D>>& r,
             double reach) {
  Rows rows(r.size());
  for (std::size_t i = 0; i < r.size(); ++i) {
    for (const std::int32_t j : list.partners(static_cast<std::int64_t>(i))) {
      if (distance(box, r[i], r[static_cast<std::size_t>(j)]) < reach) rows[i].push_back(j);
    }
  }
  return rows;
}

template <int D>
Box<D> make_box(double length, int periodic_mask) {
  Box<D> box;
  for (int c = 0; c < D; ++c) {
    box.size[c] = length * (1.0 + 0.13 * c);
    box.periodic[static_cast<std::size_t>(c)] = (periodic_mask >> c) % 2 == 1;
  }
  return box;
}

template <class T>
class PairListTest : public ::testing::Test {};
TYPED_TEST_SUITE(PairListTest, support::Dimensions);

// Every mixture of periodic and bounded directions, from one cell per direction to many.
TYPED_TEST(PairListTest, EqualsBruteForce) {
  constexpr int D = TypeParam::D;
  for (int mask = 0; mask < (1 << D); ++mask) {
    for (const double length : {2.0, 2.4, 2.6, 3.9, 6.5}) {
      const Box<D> box = make_box<D>(length, mask);
      const auto r = support::random_points<D>(Vec<D>{}, box.size, 150, 11);
      PairList<D> list(box, 1.0, 0.3);
      EXPECT_TRUE(list.update(r));
      const Rows expected = brute_force(box, r, 1.3);
      std::int64_t pairs = 0;
      for (std::size_t i = 0; i < r.size(); ++i) {
        const auto row = list.partners(static_cast<std::int64_t>(i));
        EXPECT_EQ(std::vector<std::int32_t>(row.begin(), row.end()), expected[i])
            << "periodic mask " << mask << ", length " << length << ", row " << i;
        pairs += static_cast<std::int64_t>(expected[i].size());
      }
      EXPECT_GT(pairs, 0);
      EXPECT_EQ(list.pairs(), pairs);
      EXPECT_EQ(list.rows(), 150);
    }
  }
}

// A few particles in many cells, most of them empty, two, three or more to a direction.
TYPED_TEST(PairListTest, EqualsBruteForceAmongEmptyCells) {
  constexpr int D = TypeParam::D;
  std::int64_t pairs = 0;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    const Box<D> box = make_box<D>(2.5 + 0.01 * static_cast<double>(seed), (1 << D) - 1);
    const auto r = support::random_points<D>(Vec<D>{}, box.size, 4 + seed % 20, seed);
    PairList<D> list(box, 1.0, 0.0);
    list.update(r);
    ASSERT_EQ(rows_of(list, box, r, 1.0), brute_force(box, r, 1.0)) << "seed " << seed;
    pairs += list.pairs();
  }
  EXPECT_GT(pairs, 400);
}

TYPED_TEST(PairListTest, FindsPointsOutsideBoundedDirections) {
  constexpr int D = TypeParam::D;
  Box<D> box = make_box<D>(4.0, 1);
  Vec<D> low = support::uniform_vec<D>(-2.5);
  Vec<D> high = box.size + support::uniform_vec<D>(2.5);
  low[0] = 0.0;
  high[0] = box.size[0];
  const auto r = support::random_points<D>(low, high, 300, 2);
  PairList<D> list(box, 1.0, 0.2);
  list.update(r);
  EXPECT_EQ(rows_of(list, box, r, 1.2), brute_force(box, r, 1.2));
}

TYPED_TEST(PairListTest, IsCompleteWhileNothingMovedHalfASkin) {
  constexpr int D = TypeParam::D;
  const Box<D> box = make_box<D>(3.1, (1 << D) - 1);
  const auto start = support::random_points<D>(Vec<D>{}, box.size, 250, 8);
  PairList<D> list(box, 1.0, 0.4);
  list.update(start);
  for (std::uint64_t trial = 0; trial < 5; ++trial) {
    std::vector<Vec<D>> r = start;
    const auto steps = support::random_vectors<D>(r.size(), 20 + trial);
    for (std::size_t i = 0; i < r.size(); ++i) {
      r[i] += 0.1999 / norm(steps[i]) * steps[i];
      box.wrap(r[i]);
    }
    EXPECT_FALSE(list.update(r));
    EXPECT_EQ(list.rebuilds(), 1);
    const Rows edges = rows_of(list, box, r, 1.0);
    EXPECT_EQ(edges, brute_force(box, r, 1.0));
    EXPECT_NE(edges, rows_of(list, box, start, 1.0)) << "the motion must matter";
    PairList<D> fresh(box, 1.0, 0.4);
    fresh.update(r);
    EXPECT_EQ(edges, rows_of(fresh, box, r, 1.0)) << "edges must not know when the list was made";
  }
}

TYPED_TEST(PairListTest, IsRebuiltWhenOneParticleMovedFurther) {
  constexpr int D = TypeParam::D;
  const Box<D> box = make_box<D>(5.0, (1 << D) - 1);
  auto r = support::random_points<D>(Vec<D>{}, box.size, 100, 8);
  r[42] = support::uniform_vec<D>(0.1);
  PairList<D> list(box, 1.0, 0.4);
  EXPECT_TRUE(list.update(r));
  EXPECT_FALSE(list.update(r));
  r[42][0] = box.size[0] - 0.05;  // 0.15 away through the border
  EXPECT_FALSE(list.update(r));
  r[42][0] = box.size[0] - 0.11;  // 0.21 away
  EXPECT_TRUE(list.update(r));
  EXPECT_EQ(list.rebuilds(), 2);
  EXPECT_EQ(rows_of(list, box, r, 1.4), brute_force(box, r, 1.4));
  list.invalidate();
  EXPECT_TRUE(list.update(r));
  r.pop_back();
  EXPECT_TRUE(list.update(r)) << "another number of particles";
  EXPECT_EQ(list.rows(), 99);
}

// Left to itself the list misses no pair, searches at every update where particles move far and keeps what it found where
// they do not.
TYPED_TEST(PairListTest, ChoosesItsSkinByTheMotion) {
  constexpr int D = TypeParam::D;
  const Box<D> box = make_box<D>(4.0, 1);
  for (const double step : {0.3, 0.002}) {
    auto r = support::random_points<D>(Vec<D>{}, box.size, 200, 8);
    PairList<D> list(box, 1.0);
    constexpr std::uint64_t updates = 100;
    for (std::uint64_t k = 0; k < updates; ++k) {
      const auto steps = support::random_vectors<D>(r.size(), 20 + k);
      for (std::size_t i = 0; i < r.size(); ++i) {
        r[i] += step / norm(steps[i]) * steps[i];
        box.wrap(r[i]);
      }
      list.update(r);
      ASSERT_EQ(rows_of(list, box, r, 1.0), brute_force(box, r, 1.0)) << "step " << k;
    }
    if (step > 0.1) {
      EXPECT_EQ(list.skin(), 0.0);
      EXPECT_EQ(list.rebuilds(), updates);
    } else {
      EXPECT_GT(list.skin(), step);
      EXPECT_LT(list.rebuilds(), updates / 4);
    }
  }
}

TYPED_TEST(PairListTest, ACoordinateThatIsNoNumberSpoilsNoOtherRow) {
  constexpr int D = TypeParam::D;
  const Box<D> box = make_box<D>(5.0, 1);
  auto r = support::random_points<D>(Vec<D>{}, box.size, 200, 8);
  PairList<D> list(box, 1.0, 0.3);
  list.update(r);
  const double good = r[70][0];
  r[70][0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(list.update(r));
  EXPECT_EQ(rows_of(list, box, r, 1.0), brute_force(box, r, 1.0));
  EXPECT_TRUE(list.update(r));
  r[70][0] = good;
  EXPECT_TRUE(list.update(r));
  EXPECT_EQ(rows_of(list, box, r, 1.0), brute_force(box, r, 1.0));
}

// Many particles in one place: rows longer than what kernels sort.
TYPED_TEST(PairListTest, LongRowsAreSorted) {
  constexpr int D = TypeParam::D;
  const Box<D> box = make_box<D>(4.0, 1);
  std::vector<Vec<D>> r =
      support::random_points<D>(support::uniform_vec<D>(1.0), support::uniform_vec<D>(1.5), 300, 8);
  PairList<D> list(box, 1.0, 0.0);
  list.update(r);
  const Rows expected = brute_force(box, r, 1.0);
  EXPECT_GT(expected[0].size(), 200u);
  for (std::size_t i = 0; i < r.size(); ++i) {
    const auto row = list.partners(static_cast<std::int64_t>(i));
    EXPECT_EQ(std::vector<std::int32_t>(row.begin(), row.end()), expected[i]);
  }
}

TYPED_TEST(PairListTest, HasTheSameRowsOnAnyThreadCount) {
  constexpr int D = TypeParam::D;
  const Box<D> box = make_box<D>(D == 2 ? 35.0 : 11.0, 1);
  const auto r = support::random_points<D>(Vec<D>{}, box.size, 5000, 4);
  PairList<D> one(box, 1.0, 0.3);
  one.update(r);
  const Rows expected = rows_of(one, box, r, 1.3);
  for (const int threads : {2, 3}) {
    odpd::set_threads(threads, 0);
    PairList<D> list(box, 1.0, 0.3);
    list.update(r);
    odpd::set_threads(1, 0);
    EXPECT_EQ(rows_of(list, box, r, 1.3), expected);
  }
}

TYPED_TEST(PairListTest, RefusesAPeriodicBoxBelowTwoCutoffs) {
  constexpr int D = TypeParam::D;
  Box<D> box = make_box<D>(1.99, 1);
  support::expect_error<odpd::ConfigError>([&] { PairList<D>(box, 1.0, 0.2); },
                                           {"direction x", "two cutoffs", "box.size"});
  box.periodic[0] = false;
  EXPECT_NO_THROW(PairList<D>(box, 1.0, 0.2));
  box.size[0] = 2.0;
  box.periodic[0] = true;
  EXPECT_NO_THROW(PairList<D>(box, 1.0, 0.2));
}

TYPED_TEST(PairListTest, NeighbourhoodsNameEveryCellOnce) {
  constexpr int D = TypeParam::D;
  for (int mask = 0; mask < (1 << D); ++mask) {
    for (const double length : {0.9, 2.2, 3.3, 5.1}) {
      const Box<D> box = make_box<D>(length, mask);
      const auto r = support::random_points<D>(Vec<D>{}, box.size, 60, 1);
      const CellList<D> cells(box, 1.0, r);
      std::vector<std::int64_t> around;
      std::size_t members = 0;
      for (std::int64_t cell = 0; cell < cells.cells(); ++cell) {
        cells.neighbourhood(cell, around);
        EXPECT_EQ(std::count(around.begin(), around.end(), cell), 1);
        std::sort(around.begin(), around.end());
        EXPECT_EQ(std::adjacent_find(around.begin(), around.end()), around.end());
        EXPECT_GE(around.front(), 0);
        EXPECT_LT(around.back(), cells.cells());
        for (const std::int32_t i : cells.members(cell)) {
          EXPECT_EQ(cells.cell_of(r[static_cast<std::size_t>(i)]), cell);
        }
        members += cells.members(cell).size();
      }
      EXPECT_EQ(members, r.size());
    }
  }
}

// Pairs far from each other in a box of many more cells than particles, also a long one.
TYPED_TEST(PairListTest, ASparseBoxHasFewCells) {
  constexpr int D = TypeParam::D;
  for (const double width : {1e6, 3.0}) {
    Box<D> box = make_box<D>(width, 1);
    box.size[0] = 1e6;
    auto r = support::random_points<D>(Vec<D>{}, box.size, 300, 5);
    const auto steps = support::random_points<D>(Vec<D>{}, support::uniform_vec<D>(0.8), 300, 6);
    for (std::size_t i = 0; i < 300; ++i) {
      r.push_back(r[i] + steps[i]);
      box.wrap(r.back());
    }
    const CellList<D> cells(box, 1.2, r);
    EXPECT_LE(cells.cells(), 4 * 600 + 1);
    EXPECT_GE(cells.cells(), 600) << "yet about one per particle";
    PairList<D> list(box, 1.0, 0.2);
    list.update(r);
    const Rows expected = brute_force(box, r, 1.2);
    EXPECT_EQ(rows_of(list, box, r, 1.2), expected);
    EXPECT_GE(list.pairs(), 150);
  }
}

// Mean distance in memory of pairs closer than the cutoff.
template <int D>
double memory_distance(const Box<D>& box, const std::vector<Vec<D>>& r) {
  double sum = 0.0, pairs = 0.0;
  const Rows rows = brute_force(box, r, 1.0);
  for (std::size_t i = 0; i < r.size(); ++i) {
    for (const std::int32_t j : rows[i]) {
      sum += static_cast<double>(j) - static_cast<double>(i);
      pairs += 1.0;
    }
  }
  return sum / pairs;
}

TYPED_TEST(PairListTest, SpatialOrderBringsNeighboursTogether) {
  constexpr int D = TypeParam::D;
  const Box<D> box = make_box<D>(D == 2 ? 16.0 : 7.0, 1);
  const auto r = support::random_points<D>(Vec<D>{}, box.size, 1200, 4);
  std::vector<std::int64_t> id(r.size());
  std::iota(id.begin(), id.end(), 0);
  const auto order = odpd::spatial_order<D>(box, 1.0, r, id);
  auto sorted = order;
  std::sort(sorted.begin(), sorted.end());
  for (std::size_t k = 0; k < sorted.size(); ++k)
    ASSERT_EQ(sorted[k], static_cast<std::int32_t>(k));
  std::vector<Vec<D>> moved;
  for (const std::int32_t k : order) moved.push_back(r[static_cast<std::size_t>(k)]);
  EXPECT_LT(memory_distance(box, moved), 0.5 * memory_distance(box, r));

  // The order of identities is a function of the state, not of where the particles lie in memory.
  const auto shuffle = support::random_order(r.size(), 6);
  std::vector<Vec<D>> other_r;
  std::vector<std::int64_t> other_id, first, second;
  for (const std::int32_t k : shuffle) {
    other_r.push_back(r[static_cast<std::size_t>(k)]);
    other_id.push_back(id[static_cast<std::size_t>(k)]);
  }
  for (const std::int32_t k : order) first.push_back(id[static_cast<std::size_t>(k)]);
  for (const std::int32_t k : odpd::spatial_order<D>(box, 1.0, other_r, other_id)) {
    second.push_back(other_id[static_cast<std::size_t>(k)]);
  }
  EXPECT_EQ(first, second);
}

}  // namespace
