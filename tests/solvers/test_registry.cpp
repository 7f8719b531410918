#include <gtest/gtest.h>

#include <functional>

#include "odpd/core/error.h"
#include "odpd/solvers/solver.h"
#include "odpd/version.h"

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

TEST(SolverTable, SaysWhatThisBuildLacks) {
  const std::string text = message([](auto& o) { o.name = "petsc"; });
#if ODPD_WITH_PETSC
  EXPECT_EQ(text, "");
#else
  EXPECT_NE(text.find("-DODPD_WITH_PETSC=ON"), std::string::npos) << text;
#endif
}

}  // namespace
