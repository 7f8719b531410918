// The two schemes of Phan-Thien et al. 2016 and their stopping rule.
#include <gtest/gtest.h>

#include "odpd/core/error.h"
#include "odpd/solvers/solver.h"
#include "solvers/toys.h"

namespace {

using toys::Kind;

odpd::SolveReport solve(const std::string& name, odpd::Stopping stopping, double tolerance,
                        const odpd::System& system, const std::vector<double>& b,
                        std::vector<double>& x) {
  odpd::SolverOptions o;
  o.name = name;
  o.tolerance = tolerance;
  o.stopping = stopping;
  const auto solver = odpd::make_solver(o);
  solver->bind(system);
  x.assign(b.size(), 0.0);
  return solver->solve(b, x);
}

TEST(Picard, SchemeTwoSolvesTheProblemWithTheCentreOfMassHeld) {
  for (int dimension : {2, 3}) {
    const odpd::AssembledSystem held = toys::system(dimension, Kind::held);
    const odpd::AssembledSystem regular = toys::system(dimension, Kind::regular);
    const std::vector<double> b = toys::random_vector(held.size());
    std::vector<double> exact, other, x;
    ASSERT_TRUE(solve("cholmod", odpd::Stopping::residual, 1e-12, held, b, exact).converged);
    ASSERT_TRUE(solve("cholmod", odpd::Stopping::residual, 1e-12, regular, b, other).converged);
    const auto report = solve("picard-deflated", odpd::Stopping::increment, 1e-7, held, b, x);
    ASSERT_TRUE(report.converged) << report.failure;
    EXPECT_LT(toys::distance(x, exact), 1e-5);
    EXPECT_GT(toys::distance(x, other), 1e-3) << "which is not R v = f";
  }
}

TEST(Picard, SchemeTwoNeedsAProjectedProblem) {
  const odpd::AssembledSystem system = toys::system(2, Kind::regular);
  odpd::SolverOptions o;
  o.name = "picard-deflated";
  const auto solver = odpd::make_solver(o);
  try {
    solver->bind(system);
    FAIL();
  } catch (const odpd::SolverError& error) {
    EXPECT_NE(std::string(error.what()).find("solver.hold_centre_of_mass = true"),
              std::string::npos);
  }
}

TEST(Picard, TheIncrementRuleIsLaxAndTheReportSaysSo) {
  const odpd::AssembledSystem system = toys::system(2, Kind::regular);
  const std::vector<double> b = toys::random_vector(system.size());
  std::vector<double> exact, x;
  ASSERT_TRUE(solve("cholmod", odpd::Stopping::residual, 1e-13, system, b, exact).converged);
  const auto report = solve("picard", odpd::Stopping::increment, 1e-5, system, b, x);
  ASSERT_TRUE(report.converged) << report.failure;
  EXPECT_NEAR(report.residual, toys::true_residual(system, b, x), 1e-12);
  EXPECT_GT(toys::distance(x, exact), 3e-5) << "the true error is far above the increment";
  EXPECT_LT(toys::distance(x, exact), 1e-2);
}

TEST(Picard, OneStepIsEquation24) {
  // One node: D = A, and one step is the answer.
  toys::Network net;
  net.nodes = 1;
  net.block(0, 0) = {4.0, 1.0, 1.0, 3.0};
  const odpd::AssembledSystem system(toys::matrix(net));
  std::vector<double> x;
  const auto report = solve("picard", odpd::Stopping::residual, 1e-12, system, {9.0, 5.0}, x);
  ASSERT_TRUE(report.converged);
  EXPECT_EQ(report.iterations, 1);
  EXPECT_NEAR(x[0], 2.0, 1e-14);
  EXPECT_NEAR(x[1], 1.0, 1e-14);
}

TEST(Picard, StopsEarlyWhenItDiverges) {
  const odpd::AssembledSystem system = toys::system(2, Kind::regular, 1, -0.2);
  const std::vector<double> b = toys::random_vector(system.size());
  std::vector<double> x;
  const auto report = solve("picard", odpd::Stopping::residual, 1e-8, system, b, x);
  EXPECT_FALSE(report.converged);
  EXPECT_LT(report.iterations, 20000);
  EXPECT_NE(report.failure.find("diverges"), std::string::npos) << report.failure;
}

}  // namespace
