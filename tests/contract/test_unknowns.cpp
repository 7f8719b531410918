// Unknowns per node that are not the dimension of space: every generic solver on particles that spin (blocks of spin and
// velocity) and on a scalar field, against a dense solution of the edges.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "contract.h"
#include "edge_system.h"

namespace {

using contract::Asked;
using contract::CoupledEdge;
using contract::EdgeSystem;
using contract::Matrix;
using odpd::NodeMap;
using odpd::SolveReport;
using odpd::SolverOptions;

enum class Field { spin, scalar };
enum class Problem { regular, null_space, held };

/// Edges, who has unknowns, and a load; the fluid as in support/network.h.
struct Toy {
  std::vector<CoupledEdge> edges;
  NodeMap map;
  int dimension = 0, translated = 0;
  std::vector<double> load;

  void remove_torque() {
    const auto block = static_cast<std::size_t>(map.block_size()),
               spins = block - static_cast<std::size_t>(translated);
    std::vector<double> mean(spins, 0.0);
    const double n = static_cast<double>(map.nodes());
    for (std::size_t k = 0; k < load.size(); ++k)
      if (k % block < spins) mean[k % block] += load[k] / n;
    for (std::size_t k = 0; k < load.size(); ++k)
      if (k % block < spins) load[k] -= mean[k % block];
  }
  Matrix translations() const {
    const auto n = static_cast<std::size_t>(map.unknowns());
    const auto block = static_cast<std::size_t>(map.block_size()),
               count = static_cast<std::size_t>(translated);
    Matrix E{n, count};
    for (std::size_t r = 0; r < n; ++r)
      if (r % block >= block - count) E(r, r % block + count - block) = 1.0;
    return E;
  }
};

template <int D>
Toy make(Field field, Problem problem) {
  support::Fluid<D> fluid(D == 2 ? 4.0 : 2.6, true, D == 2 ? 64 : 70, 3);
  odpd::DpdParameters p;
  p.gamma_perp = 3.0;
  fluid.connect(odpd::DpdModel<D>(1, {p}));
  Toy toy;
  toy.dimension = D;
  toy.translated = field == Field::spin ? D : 1;
  toy.edges = field == Field::spin ? contract::spinning(fluid.network)
                                   : contract::conducting(fluid.network);
  // A temperature is known at other places than a velocity would be.
  std::vector<char> known;
  for (const odpd::Vec<D>& r : fluid.particles.position)
    known.push_back(problem != Problem::null_space && r[field == Field::spin ? 0 : 1] < 0.7 ? 1
                                                                                            : 0);
  toy.map = NodeMap(known, field == Field::spin ? D + odpd::rotation_components<D> : 1);
  toy.load = support::random_numbers(static_cast<std::size_t>(toy.map.unknowns()), 9);
  return toy;
}

class Unknowns : public ::testing::TestWithParam<std::tuple<std::string, Field, Problem, int>> {
 protected:
  std::string solver() const { return std::get<0>(GetParam()).substr(0, solver_end()); }
  Field field() const { return std::get<1>(GetParam()); }
  Problem problem() const { return std::get<2>(GetParam()); }
  Toy toy() const {
    const Field field = std::get<1>(GetParam());
    return std::get<3>(GetParam()) == 2 ? make<2>(field, problem()) : make<3>(field, problem());
  }
  SolverOptions options() const {
    SolverOptions o;
    o.name = solver();
    if (o.name != std::get<0>(GetParam()))
      o.petsc_options = "-pc_type" + std::get<0>(GetParam()).substr(solver_end());
    const bool picard = o.name.starts_with("picard");
    o.tolerance = picard ? 1e-7 : 1e-11;
    o.max_iterations = picard ? 500000 : 20000;
    return o;
  }

 private:
  std::size_t solver_end() const {
    return std::min(std::get<0>(GetParam()).find(' '), std::get<0>(GetParam()).size());
  }
};

std::vector<std::string> all_solvers() {
  std::vector<std::string> names = odpd::available_solvers();
  if (std::find(names.begin(), names.end(), "petsc") != names.end())
    names.insert(names.end(), {"petsc gamg", "petsc hypre", "petsc pbjacobi"});
  return names;
}

INSTANTIATE_TEST_SUITE_P(All, Unknowns,
                         ::testing::Combine(::testing::ValuesIn(all_solvers()),
                                            ::testing::Values(Field::spin, Field::scalar),
                                            ::testing::Values(Problem::regular, Problem::null_space,
                                                              Problem::held),
                                            ::testing::Values(2, 3)),
                         [](const auto& test) {
                           std::string name = std::get<0>(test.param);
                           std::erase_if(name, [](char c) { return c == '-' || c == ' '; });
                           return name +
                                  (std::get<1>(test.param) == Field::spin ? "_spin" : "_scalar") +
                                  (std::get<2>(test.param) == Problem::regular      ? "_regular"
                                   : std::get<2>(test.param) == Problem::null_space ? "_null"
                                                                                    : "_held") +
                                  std::to_string(std::get<3>(test.param)) + "D";
                         });

/// E^T x.
std::vector<double> sums(const Matrix& E, const std::vector<double>& x) {
  std::vector<double> s(E.columns, 0.0);
  for (std::size_t r = 0; r < E.rows; ++r)
    for (std::size_t c = 0; c < E.columns; ++c) s[c] += E(r, c) * x[r];
  return s;
}

TEST_P(Unknowns, EverySolverFindsTheDenseSolution) {
  if (solver() == "picard-deflated" && problem() == Problem::regular)
    GTEST_SKIP() << "solves projected problems only";
  Toy toy = this->toy();
  const EdgeSystem system(toy.edges, toy.map, toy.dimension,
                          {problem() == Problem::held, toy.translated});
  const bool projected = problem() != Problem::regular;
  ASSERT_EQ(system.translations_are_null(), problem() == Problem::null_space);
  ASSERT_EQ(system.projected(), projected);
  ASSERT_NE(system.block_size(), toy.dimension);
  // Spins that are all alike are an eigenvector of D^-1 A with eigenvalue 2, where block-Jacobi only changes sign for ever, unless
  // known particles stop them: it needs a load that does not drive them.
  if (solver().starts_with("picard") && field() == Field::spin) toy.remove_torque();
  const Matrix E = projected ? toy.translations() : Matrix{toy.load.size(), 0};
  const auto exact = contract::dense_solution(toy.edges, toy.map, E, toy.load);
  const auto engine = odpd::make_solver(options());
  engine->bind(system);
  std::vector<double> x(toy.load.size(), 0.0);
  const SolveReport report = engine->solve(toy.load, x);
  ASSERT_TRUE(report.converged) << report.failure;
  const double residual = contract::true_residual(system, toy.load, x);
  EXPECT_LE(residual, 1.01 * options().tolerance);
  EXPECT_NEAR(report.residual, residual, 0.01 * residual + 1e-15);
  EXPECT_LT(contract::distance(x, exact), solver().starts_with("picard") ? 1e-3 : 1e-8);
  for (const double sum : sums(E, x)) EXPECT_NEAR(sum, 0.0, 1e-12 * support::norm(x));
}

// What translations are said to move decides: with the spins counted in, the answer is another one, or none.
TEST_P(Unknowns, AWrongChoiceOfComponentsShows) {
  const auto& [name, field, problem, dimension] = GetParam();
  if (field != Field::spin || problem == Problem::regular) GTEST_SKIP() << "nothing to choose";
  const Toy toy = this->toy();
  const EdgeSystem right(toy.edges, toy.map, toy.dimension,
                         {problem == Problem::held, toy.translated});
  const EdgeSystem wrong(toy.edges, toy.map, toy.dimension,
                         {problem == Problem::held, toy.map.block_size()});
  if (problem == Problem::null_space) {
    for (const EdgeSystem* system : {&right, &wrong}) {
      const odpd::Translations t = system->translations();
      double worst = 0.0;
      for (std::size_t c = 0; c < static_cast<std::size_t>(t.components); ++c) {
        std::vector<double> unit(static_cast<std::size_t>(t.components), 0.0),
            v(toy.load.size(), 0.0);
        unit[c] = 1.0;
        t.add(unit, v);
        worst = std::max(worst, support::norm(contract::product(*system, v)) / support::norm(v));
      }
      EXPECT_EQ(worst < 1e-12, system == &right) << "A E = 0 for translations: " << worst;
    }
  }
  const auto exact = contract::dense_solution(toy.edges, toy.map, toy.translations(), toy.load);
  SolverOptions options = this->options();
  options.max_iterations = 5000;
  const auto engine = odpd::make_solver(options);
  engine->bind(wrong);
  std::vector<double> x(toy.load.size(), 0.0);
  const SolveReport report = engine->solve(toy.load, x);
  EXPECT_TRUE(!report.converged || contract::distance(x, exact) > 1e-2)
      << contract::distance(x, exact);
}

// Between a hot and a cold layer every temperature lies between theirs, and without sources the heat of one is that of the other.
TEST(Conduction, HasItsOwnNotionOfKnown) {
  support::Fluid<2> fluid(5.0, true, 100, 4);
  fluid.connect(odpd::DpdModel<2>(1, {odpd::DpdParameters{}}));
  const auto edges = contract::conducting(fluid.network);
  std::vector<char> known(fluid.particles.position.size());
  std::vector<double> T(known.size(), 0.0);
  for (std::size_t i = 0; i < known.size(); ++i) {
    const double y = fluid.particles.position[i][1];
    known[i] = y < 0.8 || (y > 2.5 && y < 3.3) ? 1 : 0;
    T[i] = y < 0.8 ? 2.0 : known[i] == 1 ? 1.0 : 0.0;
  }
  const NodeMap map(known, 1);
  // Heat that flows into each particle: at the known temperatures it is the load, at the end it vanishes but at them.
  const auto heating = [&](const std::vector<double>& temperature) {
    std::vector<double> heat(temperature.size(), 0.0);
    for (const CoupledEdge& e : edges) {
      const double flow = e.Z.value[0] * (temperature[e.particle[1]] - temperature[e.particle[0]]);
      heat[e.particle[0]] += flow;
      heat[e.particle[1]] -= flow;
    }
    return heat;
  };
  std::vector<double> load(static_cast<std::size_t>(map.unknowns())), x(load.size(), 0.0);
  map.gather(heating(T), load);
  const EdgeSystem system(edges, map, 2, {false, 1});
  const auto engine = odpd::make_solver({.tolerance = 1e-12});
  engine->bind(system);
  ASSERT_TRUE(engine->solve(load, x).converged);
  map.scatter(x, T);
  double in = 0.0, out = 0.0;
  const std::vector<double> heat = heating(T);
  for (std::size_t i = 0; i < T.size(); ++i) {
    EXPECT_GE(T[i], 1.0 - 1e-12);
    EXPECT_LE(T[i], 2.0 + 1e-12);
    if (known[i] == 0) {
      EXPECT_NEAR(heat[i], 0.0, 1e-9);
    } else {
      (T[i] == 2.0 ? out : in) += heat[i];
    }
  }
  EXPECT_GT(in, 1.0);
  EXPECT_NEAR(in, -out, 1e-9 * in);
}

// The fast path is for particles with D velocities; where it was asked for by name and is none, the report says so.
TEST(UnknownsPerNode, PcgSaysThatTheGridIsForParticles) {
  const Toy toy = make<2>(Field::spin, Problem::null_space);
  const EdgeSystem system(toy.edges, toy.map, 2, {false, 2});
  for (const std::string preconditioner : {"auto", "multilevel"}) {
    const auto engine = odpd::make_solver({.preconditioner = preconditioner});
    engine->bind(system);
    std::vector<double> x(toy.load.size(), 0.0);
    const SolveReport report = engine->solve(toy.load, x);
    ASSERT_TRUE(report.converged) << report.failure;
    EXPECT_EQ(report.note.find("block-Jacobi") != std::string::npos, preconditioner == "multilevel")
        << report.note;
  }
}

}  // namespace
