// The petsc backend: preconditioners through options, and what it does with wrong ones.
#include <gtest/gtest.h>

#include <algorithm>

#include "odpd/core/error.h"
#include "odpd/solvers/petsc_options.h"
#include "odpd/solvers/solver.h"
#include "solvers/toys.h"

namespace {

using toys::Kind;

/// Fails the test when anything is written to stderr in its life.
class SilentStderr {
 public:
  SilentStderr() { testing::internal::CaptureStderr(); }
  ~SilentStderr() { EXPECT_EQ(testing::internal::GetCapturedStderr(), ""); }
  SilentStderr(const SilentStderr&) = delete;
  SilentStderr& operator=(const SilentStderr&) = delete;
};

class Petsc : public testing::Test {
 protected:
  void SetUp() override {
    const auto names = odpd::available_solvers();
    if (std::find(names.begin(), names.end(), "petsc") == names.end())
      GTEST_SKIP() << "this build has no PETSc";
  }
};
class PetscMethods : public Petsc, public testing::WithParamInterface<const char*> {};

odpd::SolverOptions petsc(const std::string& text, double tolerance = 1e-9) {
  odpd::SolverOptions o;
  o.name = "petsc";
  o.tolerance = tolerance;
  o.petsc_options = text;
  return o;
}

odpd::SolveReport solve(const odpd::SolverOptions& o, const odpd::System& system,
                        std::vector<double>& x) {
  const auto solver = odpd::make_solver(o);
  solver->bind(system);
  x.assign(static_cast<std::size_t>(system.size()), 0.0);
  return solver->solve(toys::random_vector(system.size()), x);
}

std::string config_error(const std::string& text) {
  const odpd::AssembledSystem system = toys::system(2, Kind::regular);
  std::vector<double> x;
  const SilentStderr silent;
  std::string message;
  try {
    solve(petsc(text), system, x);
  } catch (const odpd::ConfigError& error) {
    message = error.what();
  }
  return message;
}

TEST_P(PetscMethods, SolveEveryProblem) {
  const SilentStderr silent;
  for (int dimension : {2, 3}) {
    for (Kind kind : {Kind::regular, Kind::null_space, Kind::held}) {
      const odpd::AssembledSystem system = toys::system(dimension, kind);
      std::vector<double> x;
      const auto report = solve(petsc(GetParam()), system, x);
      EXPECT_TRUE(report.converged)
          << dimension << "D " << toys::kind_name(kind) << ": " << report.failure;
      EXPECT_LE(toys::true_residual(system, toys::random_vector(system.size()), x), 1.01e-9);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Options, PetscMethods,
    testing::Values("", "-pc_type icc", "-pc_type icc -pc_factor_levels 1", "-pc_type jacobi",
                    "-pc_type pbjacobi", "-pc_type sor -pc_sor_symmetric", "-pc_type gamg",
                    "-pc_type hypre -pc_hypre_boomeramg_nodal_coarsen 4 "
                    "-pc_hypre_boomeramg_coarsen_type HMIS -pc_hypre_boomeramg_interp_type ext+i "
                    "-pc_hypre_boomeramg_strong_threshold 0.5",
                    "-pc_type none", "-ksp_type minres -pc_type jacobi",
                    "-ksp_type gmres -pc_type jacobi -ksp_gmres_restart 100"));

TEST_F(Petsc, ADirectFactorIsAMethodToo) {
  const odpd::AssembledSystem system = toys::system(2, Kind::regular);
  std::vector<double> x;
  const auto report = solve(petsc("-ksp_type preonly -pc_type cholesky", 1e-12), system, x);
  EXPECT_TRUE(report.converged) << report.failure;
}

TEST_F(Petsc, MultigridKnowsTheRotationsOfAnOpenBox) {
  const toys::OpenSystem open(toys::network(2, 3000, false, 0.0, 3));
  const odpd::AssembledSystem blind(open.matrix());
  std::vector<double> x;
  const auto with = solve(petsc("-pc_type gamg"), open, x);
  const auto without = solve(petsc("-pc_type gamg"), blind, x);
  ASSERT_TRUE(with.converged) << with.failure;
  ASSERT_TRUE(without.converged) << without.failure;
  EXPECT_LT(with.iterations, without.iterations);
}

TEST_F(Petsc, AnOptionThatPetscIgnoresIsAnError) {
  const std::string text = config_error("-pc_type icc -pc_fator_levels 1");
  EXPECT_NE(text.find("-pc_fator_levels"), std::string::npos) << text;
  EXPECT_EQ(text.find("odpd_"), std::string::npos) << text;
  // It is gone afterwards.
  EXPECT_EQ(config_error("-pc_type icc -pc_factor_levels 1"), "");
  EXPECT_EQ(config_error(""), "");
}

TEST_F(Petsc, UnknownTypesAreNamed) {
  EXPECT_NE(config_error("-pc_type nonsense").find("nonsense"), std::string::npos);
  EXPECT_NE(config_error("-ksp_type nonsense").find("nonsense"), std::string::npos);
  EXPECT_NE(config_error("-mat_type nonsense").find("nonsense"), std::string::npos);
  EXPECT_NE(config_error("-pc_type bjacobi -sub_pc_type nonsense").find("nonsense"),
            std::string::npos);
}

TEST_F(Petsc, SolversWithDifferentOptionsLiveTogether) {
  const odpd::AssembledSystem system = toys::system(3, Kind::regular);
  const std::vector<double> b = toys::random_vector(system.size());
  const auto jacobi = odpd::make_solver(petsc("-pc_type jacobi"));
  const auto icc = odpd::make_solver(petsc("-pc_type icc"));
  jacobi->bind(system);
  icc->bind(system);
  std::vector<double> x(b.size(), 0.0);
  std::vector<double> y(b.size(), 0.0);
  const auto slow = jacobi->solve(b, x);
  const auto fast = icc->solve(b, y);
  ASSERT_TRUE(slow.converged && fast.converged);
  EXPECT_LT(2 * fast.iterations, slow.iterations);
}

TEST_F(Petsc, IndefiniteMatricesAreReportedByEveryMethod) {
  const odpd::AssembledSystem system = toys::system(2, Kind::regular, 1, -0.2);
  for (const char* text : {"", "-pc_type jacobi", "-pc_type gamg", "-pc_type hypre"}) {
    std::vector<double> x;
    const SilentStderr silent;
    try {
      const auto report = solve(petsc(text), system, x);
      EXPECT_FALSE(report.converged) << text;
      EXPECT_NE(report.failure, "") << text;
    } catch (const odpd::SolverError& error) {
      EXPECT_NE(std::string(error.what()), "") << text;
    }
  }
}

TEST(PetscOptions, AreSplitIntoNamesAndValues) {
  const auto options = odpd::parse_petsc_options(" -pc_type icc  -ksp_view -pc_sor_omega -1.5 ");
  ASSERT_EQ(options.size(), 3U);
  EXPECT_EQ(options[0].name, "pc_type");
  EXPECT_EQ(options[0].value, "icc");
  EXPECT_EQ(options[1].name, "ksp_view");
  EXPECT_EQ(options[1].value, "");
  EXPECT_EQ(options[2].value, "-1.5");
  EXPECT_EQ(odpd::petsc_option(options, "pc_type", "none"), "icc");
  EXPECT_EQ(odpd::petsc_option(options, "ksp_type", "cg"), "cg");
  for (const char* wrong : {"icc", "-pc_type icc ilu", "-pc_type icc -pc_type ilu",
                            "-ksp_rtol 1e-3", "-ksp_max_it 5"}) {
    EXPECT_THROW(odpd::parse_petsc_options(wrong), odpd::ConfigError) << wrong;
  }
}

}  // namespace
