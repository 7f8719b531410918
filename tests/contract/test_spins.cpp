// Particles that spin, some of them, with lever radii of all sizes: every solver on their operator, against a dense solution of
// the edges.
#include <gtest/gtest.h>

#include <map>

#include "contract.h"
#include "edge_system.h"
#include "odpd/core/rotation.h"
#include "support/spin_fluid.h"

namespace {

using contract::Matrix;

enum class SpinProblem { walls, inertia, null_space, held };

std::string name_of(SpinProblem problem) {
  return problem == SpinProblem::walls        ? "walls"
         : problem == SpinProblem::inertia    ? "inertia"
         : problem == SpinProblem::null_space ? "null"
                                              : "held";
}

template <int D>
struct SpinInstant {
  explicit SpinInstant(SpinProblem problem)
      : toy({.count = D == 2 ? std::size_t{128} : std::size_t{180},
             .walls = problem == SpinProblem::walls || problem == SpinProblem::held,
             .gamma_perp = 3.0,
             .spinning = 0.8,
             .radius_spread = 1.0,
             .inertia = problem == SpinProblem::inertia ? 0.5 : 0.0,
             .held = problem == SpinProblem::held,
             .density = D == 2 ? 8.0 : 5.5}),
        A{size(), size()},
        load(support::random_numbers(size(), 9)) {
    const std::size_t n = size(), front = static_cast<std::size_t>(toy.resistance.spins()) * D;
    for (std::size_t k = 0; k < static_cast<std::size_t>(toy.fluid.network.size()); ++k)
      add_edge(k);
    const double inertia = problem == SpinProblem::inertia ? 0.5 : 0.0;
    for (std::size_t k = 0; k < n; ++k) {
      const bool used = k >= front || D == 3 || k % D == 0;
      A(k, k) += k >= front ? inertia : used ? 0.3 * inertia : 1.0;
    }
    E = Matrix{n, toy.system().projected() ? static_cast<std::size_t>(D) : 0};
    for (std::size_t k = front; k < n; ++k)
      if (E.columns > 0) E(k, k % D) = 1.0;
    exact = contract::dense_solution(A, E, load);
  }
  std::size_t size() const { return static_cast<std::size_t>(toy.system().size()); }

  /// J^T Z J with J the slip in the unknowns R w and v of both ends.
  void add_edge(std::size_t k) {
    const auto& network = toy.fluid.network;
    const std::size_t front = static_cast<std::size_t>(toy.resistance.spins()) * D;
    std::vector<std::size_t> unknowns;
    std::vector<odpd::Vec<D>> slip;
    for (const bool first : {true, false}) {
      const auto p = static_cast<std::size_t>(first ? network.i[k] : network.j[k]);
      const std::int32_t row = toy.dofs.mobile_of(p);
      if (row < 0) continue;
      const auto& levers = toy.fluid.particles.spin_of_species;
      const auto radius = [&](std::int32_t q) {
        return levers[static_cast<std::size_t>(
                          toy.fluid.particles.species[static_cast<std::size_t>(q)])]
            .lever_radius;
      };
      const double sum = radius(network.i[k]) + radius(network.j[k]);
      for (std::size_t c = 0; c < D; ++c) {
        odpd::Vec<D> unit{};
        unit.x[c] = 1.0;
        unknowns.push_back(front + static_cast<std::size_t>(row) * D + c);
        slip.push_back(first ? unit : -1.0 * unit);
        const std::int32_t spin = toy.dofs.spin_of(p);
        if (spin < 0) continue;
        unknowns.push_back(static_cast<std::size_t>(spin) * D + c);
        // In 2D there is one spin, and `swing` looks at no other.
        slip.push_back(-network.r[k] / sum * odpd::swing(unit, network.e[k]));
      }
    }
    for (std::size_t a = 0; a < unknowns.size(); ++a)
      for (std::size_t b = 0; b < unknowns.size(); ++b)
        A(unknowns[a], unknowns[b]) += network.zeta_perp[k] * dot(slip[a], slip[b]) +
                                       (network.zeta_par[k] - network.zeta_perp[k]) *
                                           dot(network.e[k], slip[a]) * dot(network.e[k], slip[b]);
  }

  support::SpinFluid<D> toy;
  Matrix A, E;
  std::vector<double> load, exact;
};

template <int D>
const SpinInstant<D>& spin_instant(SpinProblem problem) {
  static std::map<SpinProblem, std::unique_ptr<SpinInstant<D>>> made;
  auto& one = made[problem];
  if (!one) one = std::make_unique<SpinInstant<D>>(problem);
  return *one;
}

class Spins : public ::testing::TestWithParam<std::tuple<std::string, SpinProblem, int>> {
 protected:
  template <int D>
  void check() {
    const auto& [name, problem, dimension] = GetParam();
    const SpinInstant<D>& instant = spin_instant<D>(problem);
    const odpd::System& system = instant.toy.system();
    ASSERT_EQ(system.translations_are_null(), problem == SpinProblem::null_space);
    ASSERT_EQ(system.projected(), instant.E.columns > 0);
    odpd::SolverOptions options{.name = name, .tolerance = 1e-11, .max_iterations = 20000};
    if (const auto space = name.find(' '); space != std::string::npos) {
      options.name = name.substr(0, space);
      if (options.name == "pcg")
        options.preconditioner = name.substr(space + 1);
      else
        options.petsc_options = "-pc_type" + name.substr(space);
    }
    const bool picard = name.starts_with("picard");
    if (picard) {
      options.tolerance = 1e-7;
      options.max_iterations = 500000;
    }
    const auto solver = odpd::make_solver(options);
    solver->bind(system);
    std::vector<double> x(instant.load.size(), 0.0);
    const odpd::SolveReport report = solver->solve(instant.load, x);
    ASSERT_TRUE(report.converged) << report.failure;
    EXPECT_EQ(report.note, "");
    EXPECT_LE(contract::true_residual(system, instant.load, x), 1.01 * options.tolerance);
    EXPECT_LT(contract::distance(x, instant.exact), picard ? 1e-3 : 1e-8);
  }
};

std::vector<std::string> spin_solvers() {
  std::vector<std::string> names = odpd::available_solvers();
  if (std::find(names.begin(), names.end(), "petsc") != names.end())
    names.insert(names.end(), {"petsc gamg", "petsc hypre", "petsc pbjacobi"});
  names.insert(names.end(), {"pcg multilevel", "pcg block-jacobi"});
  return names;
}

INSTANTIATE_TEST_SUITE_P(
    All, Spins,
    ::testing::Combine(::testing::ValuesIn(spin_solvers()),
                       ::testing::Values(SpinProblem::walls, SpinProblem::inertia,
                                         SpinProblem::null_space, SpinProblem::held),
                       ::testing::Values(2, 3)),
    [](const auto& test) {
      std::string name = std::get<0>(test.param);
      std::erase_if(name, [](char c) { return c == '-' || c == ' '; });
      return name + "_" + name_of(std::get<1>(test.param)) +
             std::to_string(std::get<2>(test.param)) + "D";
    });

TEST_P(Spins, EverySolverFindsTheDenseSolution) {
  const auto& [name, problem, dimension] = GetParam();
  if (name == "picard-deflated" &&
      (problem == SpinProblem::walls || problem == SpinProblem::inertia))
    GTEST_SKIP() << "solves projected problems only";
  if (dimension == 2)
    check<2>();
  else
    check<3>();
}

/// pcg with this preconditioner on bodies in a fluid that spins; its note.
template <int D>
std::string spins_beside_bodies(contract::Model model, double tolerance, std::vector<double>& x) {
  const auto& instant =
      contract::instant_of<D>(model, contract::Geometry::suspension, D == 2 ? 6.0 : 3.7);
  EXPECT_GT(instant.spins().spins(), 0);
  EXPECT_GT(instant.rigid().map().bodies(), 0);
  const auto solver = odpd::make_solver({.tolerance = tolerance, .preconditioner = "multilevel"});
  solver->bind(*instant.system);
  x.assign(instant.load.size(), 0.0);
  const odpd::SolveReport report = solver->solve(instant.load, x);
  EXPECT_TRUE(report.converged) << report.failure;
  EXPECT_LE(contract::true_residual(*instant.system, instant.load, x), 1.01 * tolerance);
  const auto exact = odpd::make_solver({.name = "cholmod", .tolerance = 1e-11});
  exact->bind(*instant.system);
  std::vector<double> y(x.size(), 0.0);
  EXPECT_TRUE(exact->solve(instant.load, y).converged);
  EXPECT_LT(contract::distance(x, y), 1e-7);
  return report.note;
}

// With its grid beside bodies without lever radius; their own spins are for double precision, and it says so.
TEST(SpinsAndBodies, PcgSaysWhereItsGridDoesNotServe) {
  std::vector<double> x;
  EXPECT_EQ(spins_beside_bodies<2>(contract::Model::spinning_fluid, 1e-10, x), "");
  EXPECT_EQ(spins_beside_bodies<3>(contract::Model::spinning_fluid, 1e-10, x), "");
  EXPECT_NE(spins_beside_bodies<2>(contract::Model::spinning, 1e-10, x).find("block-Jacobi"),
            std::string::npos);
  EXPECT_NE(spins_beside_bodies<3>(contract::Model::spinning, 1e-10, x).find("block-Jacobi"),
            std::string::npos);
}

}  // namespace
