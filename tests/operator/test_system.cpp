#include <gtest/gtest.h>

#include "odpd/core/error.h"
#include "odpd/operator/system.h"

namespace {

/// Two by two blocks of two: [[4 1 | -1 0], [1 3 | 0 -2], [-1 0 | 5 0], [0 -2 | 0 6]].
odpd::BlockCsr small() {
  odpd::BlockCsr a;
  a.block = 2;
  a.rows = 2;
  a.start = {0, 2, 4};
  a.column = {0, 1, 0, 1};
  a.value = {4, 1, 1, 3, -1, 0, 0, -2, -1, 0, 0, -2, 5, 0, 0, 6};
  return a;
}

TEST(AssembledSystem, AppliesItsMatrix) {
  const odpd::AssembledSystem system(small());
  const std::vector<double> x{1, 2, 3, 4};
  std::vector<double> y(4, 99.0);
  system.apply(x, y);
  EXPECT_EQ(y, (std::vector<double>{3, -1, 14, 20}));
  std::vector<double> blocks(8, 99.0);
  system.block_diagonal(blocks);
  EXPECT_EQ(blocks, (std::vector<double>{4, 1, 1, 3, 5, 0, 0, 6}));
  EXPECT_EQ(system.size(), 4);
  EXPECT_FALSE(system.projected());
  EXPECT_TRUE(odpd::AssembledSystem(small(), true).projected());
  EXPECT_TRUE(odpd::AssembledSystem(small(), false, true).projected());
}

TEST(AssembledSystem, AMissingDiagonalBlockIsZero) {
  odpd::BlockCsr a = small();
  a.start = {0, 1, 2};
  a.column = {1, 0};
  a.value.resize(8);
  const odpd::AssembledSystem system(a);
  std::vector<double> blocks(8, 99.0);
  system.block_diagonal(blocks);
  EXPECT_EQ(blocks, std::vector<double>(8, 0.0));
}

TEST(AssembledSystem, RefusesAMatrixThatIsNone) {
  odpd::BlockCsr a = small();
  a.column[1] = 2;
  EXPECT_THROW(odpd::AssembledSystem{a}, odpd::SolverError);
  a = small();
  a.column = {1, 0, 0, 1};
  EXPECT_THROW(odpd::AssembledSystem{a}, odpd::SolverError);
  a = small();
  a.value.pop_back();
  EXPECT_THROW(odpd::AssembledSystem{a}, odpd::SolverError);
  a = small();
  a.start = {0, 4};
  EXPECT_THROW(odpd::AssembledSystem{a}, odpd::SolverError);
}

}  // namespace
