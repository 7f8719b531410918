#include <gtest/gtest.h>

#include <functional>

#include "odpd/core/error.h"
#include "odpd/solvers/solver.h"
#include "odpd/version.h"
#include "solvers/toys.h"

namespace {

std::string message(const std::function<void(odpd::SolverOptions&)>& change) {
  odpd::SolverOptions options;
  change(options);
  try {
    odpd::make_solver(options);
  } catch (const odpd::ConfigError& error) {
    return error.what();
  }
  return "";
}

TEST(SolverTable, MakesEveryAvailableSolver) {
  for (const std::string& name : odpd::available_solvers()) {
    odpd::SolverOptions options;
    options.name = name;
    EXPECT_EQ(odpd::make_solver(options)->name(), name);
  }
  EXPECT_EQ(odpd::solver_names(), (std::vector<std::string>{"picard", "picard-deflated", "pcg",
                                                            "eigen-cg", "cholmod", "petsc"}));
}

TEST(SolverTable, AnUnknownNameIsAnsweredWithTheNames) {
  const std::string text = message([](auto& o) { o.name = "cholmd"; });
  EXPECT_NE(text.find("did you mean \"cholmod\"?"), std::string::npos) << text;
  for (const std::string& name : odpd::solver_names()) {
    EXPECT_NE(text.find(name), std::string::npos) << text;
  }
}

TEST(SolverTable, RefusesContradictions) {
  EXPECT_NE(message([](auto& o) { o.stopping = odpd::Stopping::increment; }).find("picard"),
            std::string::npos);
  EXPECT_NE(message([](auto& o) { o.petsc_options = "-pc_type icc"; }).find("petsc"),
            std::string::npos);
  EXPECT_NE(message([](auto& o) { o.tolerance = 0.0; }).find("solver.tolerance"),
            std::string::npos);
  EXPECT_NE(message([](auto& o) { o.max_iterations = 0; }).find("solver.max_iterations"),
            std::string::npos);
}

class WatchedSystem : public odpd::AssembledSystem {
 public:
  using AssembledSystem::AssembledSystem;
  const odpd::BlockCsr& matrix() const override {
    assembled = true;
    return AssembledSystem::matrix();
  }
  mutable bool assembled = false;
};

TEST(SolverTable, SaysWhichSolversWantAMatrix) {
  for (const std::string& name : odpd::available_solvers()) {
    const WatchedSystem system(toys::matrix(toys::clique(2, 20, 1), 0.5), false, true);
    const std::vector<double> b = toys::random_vector(system.size());
    std::vector<double> x(b.size());
    odpd::SolverOptions options;
    options.name = name;
    const auto solver = odpd::make_solver(options);
    solver->bind(system);
    EXPECT_TRUE(solver->solve(b, x).converged) << name;
    EXPECT_EQ(system.assembled, odpd::solver_traits(name).assembles) << name;
  }
}

TEST(SolverTable, SaysWhichOptionsASolverTakes) {
  for (const std::string& name : odpd::available_solvers()) {
    const odpd::SolverTraits& traits = odpd::solver_traits(name);
    const auto taken = [&](const auto& change) {
      return message([&](auto& o) {
               o.name = name;
               change(o);
             }) == "";
    };
    EXPECT_EQ(taken([](auto& o) { o.stopping = odpd::Stopping::increment; }),
              traits.knows_increment)
        << name;
    EXPECT_EQ(taken([](auto& o) { o.preconditioner = "block-jacobi"; }), traits.preconditioned)
        << name;
    EXPECT_EQ(taken([](auto& o) { o.petsc_options = "-pc_type icc"; }), traits.takes_options)
        << name;
  }
}

TEST(SolverTable, SaysWhatThisBuildLacks) {
  const std::string text = message([](auto& o) { o.name = "petsc"; });
#if ODPD_WITH_PETSC
  EXPECT_EQ(text, "");
#else
  EXPECT_NE(text.find("-DODPD_WITH_PETSC=ON"), std::string::npos) << text;
#endif
}

}  // namespace
