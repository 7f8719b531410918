// The iterations of pcg on DPD fluids, walls or periodic: at most 36 to 1e-7, and the same velocities with either
// preconditioner.
#include <gtest/gtest.h>

#include "contract.h"

namespace {

using contract::Geometry;

template <int D>
odpd::SolveReport solved(const contract::Instant<D>& instant, const char* preconditioner,
                         double tolerance, std::vector<double>& x) {
  const auto solver =
      odpd::make_solver({.name = "pcg", .tolerance = tolerance, .preconditioner = preconditioner});
  solver->bind(instant.resistance());
  x.assign(instant.load.size(), 0.0);
  return solver->solve(instant.load, x);
}

class Multilevel : public ::testing::TestWithParam<Geometry> {
 protected:
  template <int D>
  void check(double length) {
    const auto& instant =
        contract::instant_of<D>(contract::Model::central, GetParam(), length, false);
    std::vector<double> x, y;
    const auto grid = solved(instant, "multilevel", 1e-7, x);
    ASSERT_TRUE(grid.converged) << grid.failure;
    EXPECT_EQ(grid.note, "");
    EXPECT_LE(grid.iterations, 36);
    const auto plain = solved(instant, "block-jacobi", 1e-7, y);
    ASSERT_TRUE(plain.converged) << plain.failure;
    EXPECT_GT(2 * plain.iterations, 3 * grid.iterations);
    solved(instant, "multilevel", 1e-10, x);
    solved(instant, "block-jacobi", 1e-10, y);
    for (std::size_t k = 0; k < x.size(); ++k) y[k] -= x[k];
    EXPECT_LT(support::norm(y), 1e-7 * support::norm(x));
  }
};

INSTANTIATE_TEST_SUITE_P(All, Multilevel, ::testing::Values(Geometry::walls, Geometry::periodic),
                         [](const auto& test) { return contract::name(test.param); });

TEST_P(Multilevel, NeedsFewIterationsIn2D) { check<2>(24.0); }
TEST_P(Multilevel, NeedsFewIterationsIn3D) { check<3>(8.0); }

}  // namespace
