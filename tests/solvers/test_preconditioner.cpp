#include <gtest/gtest.h>

#include "odpd/core/error.h"
#include "odpd/solvers/preconditioner.h"
#include "solvers/toys.h"

namespace {

TEST(InvertDefinite, InvertsBlocksOfAnySize) {
  for (int b = 1; b <= 6; ++b) {
    const std::size_t n = static_cast<std::size_t>(b);
    const std::vector<double> g = toys::random_vector(b * b, 3);
    std::vector<double> a(n * n, 0.0);
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j) {
        for (std::size_t k = 0; k < n; ++k) a[i * n + j] += g[i * n + k] * g[j * n + k];
      }
      a[i * n + i] += 0.1;
    }
    std::vector<double> inverse(a);
    ASSERT_TRUE(odpd::invert_definite(inverse, b));
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j) {
        double s = 0.0;
        for (std::size_t k = 0; k < n; ++k) s += a[i * n + k] * inverse[k * n + j];
        EXPECT_NEAR(s, i == j ? 1.0 : 0.0, 1e-11);
        EXPECT_EQ(inverse[i * n + j], inverse[j * n + i]);
      }
    }
  }
}

TEST(InvertDefinite, RefusesSingularAndIndefiniteBlocks) {
  std::vector<double> singular{0.1 * 0.1, 0.1 * 0.3, 0.3 * 0.1, 0.3 * 0.3};
  EXPECT_FALSE(odpd::invert_definite(singular, 2));
  std::vector<double> indefinite{1.0, 2.0, 2.0, 1.0};
  EXPECT_FALSE(odpd::invert_definite(indefinite, 2));
  std::vector<double> zero(9, 0.0);
  EXPECT_FALSE(odpd::invert_definite(zero, 3));
  std::vector<double> scaled{1e-20, 0.0, 0.0, 1e20};  // of different units: definite all the same
  EXPECT_TRUE(odpd::invert_definite(scaled, 2));
}

TEST(BlockJacobi, InvertsTheBlockDiagonal) {
  for (int dimension : {2, 3}) {
    const odpd::AssembledSystem system = toys::system(dimension, toys::Kind::regular);
    const std::size_t d = static_cast<std::size_t>(dimension);
    std::vector<double> blocks(static_cast<std::size_t>(system.size()) * d);
    system.block_diagonal(blocks);
    const std::vector<double> x = toys::random_vector(system.size());
    std::vector<double> dx(x.size(), 0.0);
    for (std::size_t i = 0; i < x.size(); ++i) {
      for (std::size_t j = 0; j < d; ++j) dx[i] += blocks[i * d + j] * x[i / d * d + j];
    }
    odpd::BlockJacobi jacobi;
    jacobi.set_up(system);
    std::vector<double> z(x.size());
    jacobi.apply(dx, z);
    EXPECT_LT(toys::distance(z, x), 1e-12);
    EXPECT_EQ(jacobi.memory_bytes(), static_cast<std::int64_t>(8 * blocks.size()));
  }
}

}  // namespace
