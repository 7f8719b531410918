#include <gtest/gtest.h>

#include <cmath>

#include "odpd/core/parallel.h"
#include "odpd/operator/translations.h"

namespace {

using odpd::Translations;

std::vector<double> waves(std::size_t size) {
  std::vector<double> x(size);
  for (std::size_t i = 0; i < size; ++i) x[i] = std::sin(static_cast<double>(i * i % 977)) + 0.3;
  return x;
}

// Blocks of 1 to 6 unknowns, of which the last ones move, behind nodes that do not.
const std::vector<Translations> all_kinds{{1, 5000, 1}, {2, 5000, 2}, {3, 5000, 3}, {3, 5000, 2},
                                          {6, 5000, 3}, {4, 5000, 1}, {2, 4200, 2}, {6, 17, 3}};
constexpr std::size_t nodes = 5000;

TEST(Translations, TakeOnlyTheMeanOfWhatTheyMove) {
  for (const Translations& t : all_kinds) {
    const auto block = static_cast<std::size_t>(t.block);
    const std::vector<double> before = waves(nodes * block);
    std::vector<double> x(before);
    t.remove_mean(x);
    std::vector<double> sum(block, 0.0), shift(block, 0.0);
    for (std::size_t i = 0; i < x.size(); ++i) {
      const std::size_t node = i / block, c = i % block;
      const bool moves = node >= nodes - static_cast<std::size_t>(t.nodes) &&
                         c >= block - static_cast<std::size_t>(t.components);
      if (!moves) {
        EXPECT_EQ(x[i], before[i]);
        continue;
      }
      sum[c] += x[i];
      if (shift[c] == 0.0) shift[c] = x[i] - before[i];
      EXPECT_NEAR(x[i] - before[i], shift[c], 1e-14) << "a shift only";
    }
    for (std::size_t c = 0; c < block; ++c) {
      EXPECT_NEAR(sum[c], 0.0, 1e-9);
      EXPECT_EQ(std::abs(shift[c]) > 1e-6, c >= block - static_cast<std::size_t>(t.components));
    }
  }
}

TEST(Translations, SumsAreTheTransposeOfAdding) {
  for (const Translations& t : all_kinds) {
    const std::vector<double> x = waves(nodes * static_cast<std::size_t>(t.block));
    const std::vector<double> a{0.7, -0.4, 2.0};
    const std::vector<double> by(a.begin(), a.begin() + t.components);
    std::vector<double> moved(x.size(), 0.0);
    t.add(by, moved);
    const std::vector<double> sums = t.sums(x);
    ASSERT_EQ(sums.size(), by.size());
    double left = 0.0, right = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) left += moved[i] * x[i];
    for (std::size_t c = 0; c < by.size(); ++c) right += by[c] * sums[c];
    EXPECT_NEAR(left, right, 1e-9);
    EXPECT_GT(std::abs(left), 1.0);
  }
}

// Weights 2 and 3 of the last two nodes: columns E = (1, ..., 1, 2, 3).
TEST(Translations, WeighTheLastNodes) {
  const std::vector<double> weights{2.0, 3.0};
  const Translations t{2, 100, 2, weights};
  EXPECT_EQ(t.squares(240), 98.0 + 4.0 + 9.0);
  const std::vector<double> before = waves(240);
  std::vector<double> x(before), column(240, 0.0);
  t.add(std::vector<double>{1.0, 0.0}, column);
  EXPECT_EQ(column[38], 0.0);
  EXPECT_EQ(column[40], 1.0);
  EXPECT_EQ(column[236], 2.0);
  EXPECT_EQ(column[238], 3.0);
  t.remove_mean(x);
  double part = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) part += before[i] * column[i] / 111.0;
  EXPECT_GT(std::abs(part), 0.1);
  for (std::size_t i = 0; i < x.size(); i += 2)
    EXPECT_NEAR(x[i], before[i] - part * column[i], 1e-14) << i;
  for (const double sum : t.sums(x)) EXPECT_NEAR(sum, 0.0, 1e-12);
}

TEST(Translations, HaveTheSameBitsOnAnyThreadCount) {
  const Translations t{3, 700000, 2};
  std::vector<double> one = waves(3 * 700000);
  std::vector<double> two(one);
  odpd::set_threads(1, 0);
  t.remove_mean(one);
  odpd::set_threads(2, 0);
  t.remove_mean(two);
  odpd::set_threads(1, 0);
  EXPECT_EQ(one, two);
}

TEST(Translations, TakeAnEmptyVector) {
  std::vector<double> none;
  Translations{3, 0, 3}.remove_mean(none);
  EXPECT_TRUE(none.empty());
}

}  // namespace
