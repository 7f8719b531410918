// What every solver owes its caller, on toy networks in two and three dimensions.
#include <gtest/gtest.h>

#include <limits>

#include "odpd/core/error.h"
#include "odpd/core/parallel.h"
#include "odpd/solvers/solver.h"
#include "solvers/toys.h"

namespace {

using odpd::SolveReport;
using toys::Kind;

odpd::SolverOptions options(const std::string& name, double tolerance) {
  odpd::SolverOptions o;
  o.name = name;
  o.tolerance = tolerance;
  return o;
}

SolveReport solve(const odpd::SolverOptions& o, const odpd::System& system,
                  const std::vector<double>& b, std::vector<double>& x) {
  const auto solver = odpd::make_solver(o);
  solver->bind(system);
  x.resize(b.size());
  return solver->solve(b, x);
}

struct Case {
  std::string solver;
  int dimension;
  Kind kind;
};

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const std::string& solver : odpd::available_solvers()) {
    for (int dimension : {2, 3}) {
      for (Kind kind : {Kind::regular, Kind::null_space, Kind::held}) {
        if (solver == "picard-deflated" && kind == Kind::regular) continue;
        all.push_back({solver, dimension, kind});
      }
    }
  }
  return all;
}

class EverySolver : public testing::TestWithParam<Case> {};
class EveryIterativeSolver : public testing::TestWithParam<Case> {};
class EverySolverOfDefiniteProblems : public testing::TestWithParam<Case> {};

TEST_P(EverySolver, ReachesTheToleranceTruthfully) {
  const auto& [name, dimension, kind] = GetParam();
  const odpd::AssembledSystem system = toys::system(dimension, kind);
  const std::vector<double> b = toys::random_vector(system.size());
  std::vector<double> x;
  const SolveReport report = solve(options(name, 1e-10), system, b, x);
  ASSERT_TRUE(report.converged) << report.failure;
  EXPECT_EQ(report.failure, "");
  const double residual = toys::true_residual(system, b, x);
  EXPECT_LE(residual, 1.01e-10);
  EXPECT_NEAR(report.residual, residual, 0.01 * residual + 1e-15);
  EXPECT_GT(report.iterations, 0);
  EXPECT_GT(report.memory_bytes, system.size() * 8);
  EXPECT_EQ(report.problem, kind == Kind::regular      ? "R v = f"
                            : kind == Kind::null_space ? "R v = f, null space removed"
                                                       : "centre of mass held still");
  if (system.projected()) {
    std::vector<double> centred(x);
    system.project(centred);
    EXPECT_LT(toys::distance(centred, x), 1e-13);
  }
  std::vector<double> exact;
  ASSERT_TRUE(solve(options("cholmod", 1e-13), system, b, exact).converged);
  EXPECT_LT(toys::distance(x, exact), 1e-7);
}

TEST_P(EverySolver, StartsFromTheGuess) {
  const auto& [name, dimension, kind] = GetParam();
  const odpd::AssembledSystem system = toys::system(dimension, kind);
  const std::vector<double> b = toys::random_vector(system.size());
  std::vector<double> x;
  ASSERT_TRUE(solve(options("cholmod", 1e-12), system, b, x).converged);
  std::vector<double> again(x);
  const auto solver = odpd::make_solver(options(name, 1e-8));
  solver->bind(system);
  const SolveReport report = solver->solve(b, again);
  EXPECT_TRUE(report.converged) << report.failure;
  const bool free = name.starts_with("picard") || name == "pcg";
  if (free) {
    EXPECT_EQ(report.iterations, 0);
  }
  again.assign(again.size(), std::numeric_limits<double>::quiet_NaN());
  EXPECT_TRUE(solver->solve(b, again).converged) << "a guess that is not a number is no guess";
  EXPECT_LT(toys::distance(again, x), 1e-5);
}

TEST_P(EverySolverOfDefiniteProblems, ReportsAnIndefiniteMatrix) {
  const auto& [name, dimension, kind] = GetParam();
  // Below the smallest eigenvalues of A, above none of the diagonal blocks.
  const odpd::AssembledSystem system = toys::system(dimension, kind, 1, -0.2);
  const std::vector<double> b = toys::random_vector(system.size());
  std::vector<double> x;
  const SolveReport report = solve(options(name, 1e-8), system, b, x);
  EXPECT_FALSE(report.converged);
  EXPECT_NE(report.failure.find(name + ": "), std::string::npos) << report.failure;
  RecordProperty("failure", report.failure);
}

TEST_P(EveryIterativeSolver, ReportsTheIterationLimit) {
  const auto& [name, dimension, kind] = GetParam();
  const odpd::AssembledSystem system = toys::system(dimension, kind);
  const std::vector<double> b = toys::random_vector(system.size());
  odpd::SolverOptions o = options(name, 1e-8);
  o.max_iterations = 2;
  std::vector<double> x;
  const SolveReport report = solve(o, system, b, x);
  EXPECT_FALSE(report.converged);
  EXPECT_LE(report.iterations, 2);
  EXPECT_GT(report.residual, 1e-8);
  EXPECT_NE(report.failure.find("solver.max_iterations"), std::string::npos) << report.failure;
}

// A stale matrix would leave a residual of order 1, as is shown below, so the tolerance is lax.
TEST_P(EverySolver, BindsAgainAndAgain) {
  const auto& [name, dimension, kind] = GetParam();
  const auto solver = odpd::make_solver(options(name, 1e-4));
  for (std::uint32_t seed : {2U, 3U, 4U}) {
    const odpd::AssembledSystem system = toys::system(dimension, kind, seed);
    const std::vector<double> b = toys::random_vector(system.size(), seed);
    std::vector<double> x(b.size(), 0.0);
    solver->bind(system);
    const SolveReport report = solver->solve(b, x);
    ASSERT_TRUE(report.converged) << report.failure;
    EXPECT_LE(toys::true_residual(system, b, x), 1.01e-4);
    // What solves one system is no answer to the next (between walls they differ in size as well).
    const odpd::AssembledSystem next = toys::system(dimension, kind, seed + 1);
    if (next.size() == system.size()) {
      EXPECT_GT(toys::true_residual(next, b, x), 0.1);
    }
    // A second right-hand side on the same set-up.
    const std::vector<double> c = toys::random_vector(system.size(), seed + 100);
    ASSERT_TRUE(solver->solve(c, x).converged);
    EXPECT_LE(toys::true_residual(system, c, x), 1.01e-4);
  }
}

TEST_P(EverySolver, TreatsZeroAndNanLoads) {
  const auto& [name, dimension, kind] = GetParam();
  const odpd::AssembledSystem system = toys::system(dimension, kind);
  const auto solver = odpd::make_solver(options(name, 1e-8));
  solver->bind(system);
  std::vector<double> b(static_cast<std::size_t>(system.size()), 0.0);
  std::vector<double> x(b.size(), 1.0);
  SolveReport report = solver->solve(b, x);
  EXPECT_TRUE(report.converged);
  EXPECT_EQ(toys::norm(x), 0.0);
  if (system.projected()) {
    b.assign(b.size(), 0.1);  // a net force only: nothing is left of it
    x.assign(b.size(), 1.0);
    EXPECT_TRUE(solver->solve(b, x).converged);
    EXPECT_EQ(toys::norm(x), 0.0);
  }
  b[3] = std::numeric_limits<double>::quiet_NaN();
  report = solver->solve(b, x);
  EXPECT_FALSE(report.converged);
  EXPECT_NE(report.failure.find("not finite"), std::string::npos);
}

std::string case_name(const testing::TestParamInfo<Case>& tested) {
  std::string name = tested.param.solver;
  for (char& c : name) c = c == '-' ? '_' : c;
  return name + "_" + std::to_string(tested.param.dimension) + "d_" +
         toys::kind_name(tested.param.kind);
}

template <class Wanted>
std::vector<Case> cases_that(const Wanted& wanted) {
  std::vector<Case> all = cases();
  std::erase_if(all, [&](const Case& tested) { return !wanted(tested); });
  return all;
}

INSTANTIATE_TEST_SUITE_P(Toys, EverySolver, testing::ValuesIn(cases()), case_name);
// A direct solver has no iteration limit.
INSTANTIATE_TEST_SUITE_P(Toys, EveryIterativeSolver,
                         testing::ValuesIn(cases_that([](const Case& tested) {
                           return tested.solver != "cholmod";
                         })),
                         case_name);
// The shift that makes a matrix indefinite leaves no null space.
INSTANTIATE_TEST_SUITE_P(Toys, EverySolverOfDefiniteProblems,
                         testing::ValuesIn(cases_that([](const Case& tested) {
                           return tested.kind != Kind::null_space;
                         })),
                         case_name);

TEST(Solver, NamesTheNodeThatIsNotHeld) {
  toys::Network net = toys::network(2, 220, true, 1.0, 1);
  net.block(17, 17) = {1.0, 2.0, 2.0, 4.0};  // as if held by one neighbour
  const odpd::AssembledSystem system(toys::matrix(net));
  for (const std::string& name : odpd::available_solvers()) {
    if (name == "picard-deflated") continue;
    const auto solver = odpd::make_solver(options(name, 1e-6));
    try {
      solver->bind(system);
      FAIL() << name;
    } catch (const odpd::SolverError& error) {
      EXPECT_NE(std::string(error.what()).find("node 17 "), std::string::npos) << error.what();
    }
  }
}

TEST(Solver, RefusesToSolveUnbound) {
  std::vector<double> b(4, 1.0);
  std::vector<double> x(4, 0.0);
  const auto solver = odpd::make_solver(options("pcg", 1e-6));
  EXPECT_THROW(solver->solve(b, x), odpd::SolverError);
  const odpd::AssembledSystem system = toys::system(2, Kind::regular);
  solver->bind(system);
  EXPECT_THROW(solver->solve(b, x), odpd::SolverError);  // of another size
}

TEST(Solver, ASingleFreeNodeDoesNotMove) {
  toys::Network net;
  net.nodes = 1;
  net.block(0, 0) = {1.0, 0.0, 0.0, 1.0};
  const odpd::AssembledSystem system(toys::matrix(net), false, true);
  for (const std::string& name : odpd::available_solvers()) {
    std::vector<double> x;
    EXPECT_TRUE(solve(options(name, 1e-6), system, {3.0, 4.0}, x).converged) << name;
    EXPECT_EQ(toys::norm(x), 0.0) << name;
  }
}

TEST(Solver, ATinyDenseNullSpaceProblemIsSolved) {
  // Few nodes, all connected: incomplete factors are complete and would meet the zero pivot.
  for (int dimension : {2, 3}) {
    const odpd::AssembledSystem system(
        toys::matrix(toys::clique(dimension, 7, dimension == 2 ? 5U : 6U)), true);
    const std::vector<double> b = toys::random_vector(system.size());
    for (const std::string& name : odpd::available_solvers()) {
      std::vector<double> x;
      const SolveReport report = solve(options(name, 1e-5), system, b, x);
      EXPECT_TRUE(report.converged) << report.failure;
      EXPECT_LE(toys::true_residual(system, b, x), 1.01e-5) << name;
    }
  }
}

TEST(Solver, NativeSolversGiveTheSameBitsOnAnyThreadCount) {
  const toys::Network net = toys::network(2, 3000, true, 1.0, 5);
  for (bool held : {false, true}) {
    const odpd::AssembledSystem system(toys::matrix(net), false, held);
    const std::vector<double> b = toys::random_vector(system.size());
    for (const std::string name : {"pcg", "picard", "eigen-cg"}) {
      odpd::SolverOptions o = options(name, 1e-3);
      o.max_iterations = 8;
      std::vector<double> one;
      std::vector<double> two;
      odpd::set_threads(1, 0);
      solve(o, system, b, one);
      odpd::set_threads(2, 0);
      solve(o, system, b, two);
      odpd::set_threads(1, 0);
      EXPECT_EQ(one, two) << name;
    }
  }
}

}  // namespace
