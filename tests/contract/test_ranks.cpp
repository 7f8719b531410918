// Solves by several ranks: every product, norm, mean and decision is of all of them, so the answer is that of one rank, and the same
// bits on each.
#include <gtest/gtest.h>

#include <string>
#include <tuple>
#include <vector>

#include "contract.h"
#include "edge_system.h"
#include "on_ranks.h"
#include "support/errors.h"

namespace {

using contract::Geometry;
using contract::Instant;
using contract::Model;
using odpd::Communicator;
using odpd::SolverOptions;

constexpr double tolerance = 1e-10;

struct Solved {
  std::vector<double> x;
  odpd::SolveReport report;
};

Solved solve(const odpd::System& system, const std::vector<double>& load,
             const SolverOptions& options) {
  Solved s{std::vector<double>(load.size(), 0.0), {}};
  const auto solver = odpd::make_solver(options);
  solver->bind(system);
  s.report = solver->solve(load, s.x);
  return s;
}

void expect_the_answer_of(const Solved& one, const std::vector<Solved>& several) {
  ASSERT_TRUE(one.report.converged) << one.report.failure;
  for (const Solved& s : several) {
    ASSERT_TRUE(s.report.converged) << s.report.failure;
    EXPECT_EQ(s.x, several.front().x) << "ranks differ";
    EXPECT_EQ(s.report.iterations, several.front().report.iterations);
    EXPECT_EQ(s.report.residual, several.front().report.residual);
    EXPECT_EQ(s.report.problem, one.report.problem);
    EXPECT_EQ(s.report.note, one.report.note);
  }
  EXPECT_LT(contract::distance(several.front().x, one.x), 100.0 * tolerance);
  EXPECT_NEAR(static_cast<double>(several.front().report.iterations),
              static_cast<double>(one.report.iterations),
              1.0 + 0.01 * static_cast<double>(one.report.iterations));
}

struct RankedSolve {
  const char* label;
  const char* solver;
  const char* preconditioner;
  bool hold;
};

class RankedSolves : public testing::TestWithParam<std::tuple<RankedSolve, Geometry, int>> {};

INSTANTIATE_TEST_SUITE_P(
    All, RankedSolves,
    testing::Combine(testing::Values(RankedSolve{"picard", "picard", "auto", false},
                                     RankedSolve{"deflated", "picard-deflated", "auto", true},
                                     RankedSolve{"jacobi", "pcg", "block-jacobi", false},
                                     RankedSolve{"multilevel", "pcg", "multilevel", false},
                                     RankedSolve{"held", "pcg", "multilevel", true}),
                     testing::Values(Geometry::walls, Geometry::periodic, Geometry::sheared,
                                     Geometry::obstacles, Geometry::suspension, Geometry::rods),
                     testing::Values(2, 3)),
    [](const auto& test) {
      return std::string(std::get<0>(test.param).label) + "_" +
             contract::name(std::get<1>(test.param)) + "_" +
             std::to_string(std::get<2>(test.param)) + "D";
    });

template <int D>
void solve_on_ranks(const RankedSolve& choice, Geometry geometry) {
  const SolverOptions options{
      .name = choice.solver, .tolerance = tolerance, .preconditioner = choice.preconditioner};
  const Model model = geometry == Geometry::periodic ? Model::transverse : Model::central;
  struct Result {
    Solved solved;
    std::vector<odpd::Vec<D>> position;
  };
  const auto made = [&](const Communicator& ranks) {
    const Instant<D> instant(model, geometry, D == 2 ? 5.0 : 3.0, choice.hold, ranks);
    return Result{solve(*instant.system, instant.load, options),
                  instant.scene.particles().position};
  };
  const Result one = made(Communicator::alone());
  for (const int size : {2, 4}) {
    std::vector<Solved> several;
    for (Result& r : contract::on_ranks(size, made)) {
      EXPECT_EQ(r.position, one.position);
      several.push_back(std::move(r.solved));
    }
    expect_the_answer_of(one.solved, several);
  }
}

TEST_P(RankedSolves, GiveTheAnswerOfOneRank) {
  const auto& [choice, geometry, dimension] = GetParam();
  if (dimension == 2) {
    solve_on_ranks<2>(choice, geometry);
  } else {
    solve_on_ranks<3>(choice, geometry);
  }
}

// So many particles that each rank has blocks of places of its own, and the multigrid several levels.
TEST(Ranks, ShareTheBlocksOfALargeSolve) {
  odpd::SceneSettings<2> s =
      contract::settings<2>(Model::central, Geometry::periodic, 33.0);  // 4356 particles
  s.relax_sweeps = 5;
  for (const bool hold : {false, true}) {
    const auto made = [&](const Communicator& ranks) {
      odpd::Scene<2> scene(s, ranks);
      odpd::Dynamics<2> dynamics(scene.box(), scene.particles(), scene.model(), scene,
                                 odpd::make_solver({}), {.hold_centre_of_mass = hold});
      dynamics.reorder_if_due(0);
      odpd::Stage<2> stage;
      dynamics.evaluate(scene.particles().position, 0.0, stage);
      // With a shift that is no null space, so that the centre of mass is held where that is asked for.
      const odpd::System& system = dynamics.assemble(stage, {.inertia = hold ? 1e-3 : 0.0});
      return solve(system, dynamics.force(stage), {.tolerance = tolerance});
    };
    odpd::set_threads(1, 0);
    const Solved one = made(Communicator::alone());
    EXPECT_EQ(one.report.problem.find("held") != std::string::npos, hold);
    for (const int size : {2, 4}) expect_the_answer_of(one, contract::on_ranks(size, made));
  }
}

// Unknowns that are not velocities: pcg in double, and Picard, on spinning particles with a null space.
TEST(Ranks, ShareUnknownsThatAreNoVelocities) {
  support::Fluid<2> fluid(5.0, true, 100, 4);
  fluid.connect(odpd::DpdModel<2>(1, {odpd::DpdParameters{.gamma_perp = 1.5}}));
  const auto edges = contract::spinning<2>(fluid.network);
  for (const bool hold : {false, true}) {
    std::vector<char> known(fluid.particles.position.size(), 0);
    if (hold) std::fill_n(known.begin(), 20, 1);
    const odpd::NodeMap map(known, 3);
    const auto load = support::random_numbers(static_cast<std::size_t>(map.unknowns()), 8);
    const auto made = [&](const Communicator& ranks) {
      contract::EdgeSystem system(edges, map, 2, {hold, 2});
      system.share_among(ranks);
      return solve(system, load, {.tolerance = tolerance});
    };
    const Solved one = made(Communicator::alone());
    for (const int size : {2, 4}) expect_the_answer_of(one, contract::on_ranks(size, made));
  }
}

// What fails on one rank fails on all, with the words of one rank.
TEST(Ranks, FailTogether) {
  const auto message = [](const Communicator& ranks, const auto& act) -> std::string {
    try {
      act(ranks);
    } catch (const odpd::SolverError& e) {
      return e.what();
    }
    return "nothing was thrown";
  };
  const auto same = [&](const auto& act, const char* part) {
    const std::string one = message(Communicator::alone(), act);
    EXPECT_NE(one.find(part), std::string::npos) << one;
    for (const int size : {2, 4})
      for (const std::string& text :
           contract::on_ranks(size, [&](const Communicator& r) { return message(r, act); }))
        EXPECT_EQ(text, one);
  };
  // Of a crowd and one particle far from it, which the last rank owns.
  odpd::SceneSettings<2> lonely;
  lonely.box.size = {{8.0, 8.0}};
  lonely.box.periodic.fill(true);
  lonely.model = odpd::make_dpd<2>({});
  lonely.start = odpd::StartKind::file;
  lonely.relax_sweeps = 0;
  for (int k = 0; k < 16; ++k)
    lonely.start_positions.push_back({{1.0 + 0.5 * (k % 4), 1.0 + 0.5 * (k / 4)}});
  lonely.start_positions.push_back({{6.0, 6.0}});
  const auto solved_at = [&](const odpd::Vec<2>& last) {
    return [&lonely, last](const Communicator& ranks) {
      odpd::Scene<2> scene(lonely, ranks);
      odpd::Dynamics<2> dynamics(scene.box(), scene.particles(), scene.model(), scene,
                                 odpd::make_solver({}), {});
      odpd::Stage<2> stage;
      std::vector<odpd::Vec<2>> r = scene.particles().position;
      r.back() = last;
      dynamics.evaluate(r, 0.0, stage);
      dynamics.assemble(stage, {});
    };
  };
  same(solved_at({{6.0, 6.0}}), "is a rattler");
  same(solved_at({{std::nan(""), 6.0}}), "is not finite");
  const auto jumps = [](const Communicator& ranks) {
    Instant<2> instant(Model::central, Geometry::periodic, 5.0, false, ranks);
    std::vector<odpd::Vec<2>> v(instant.scene.particles().position.size());
    v[v.size() / 2][1] = v.back()[0] = 1e6;
    instant.dynamics.motion().move(v, 0.01, 0.0);
  };
  same(jumps, "more than half the box");
  const auto loose = [](const Communicator& ranks) {
    odpd::BlockCsr matrix{.block = 1,
                          .rows = 4,
                          .start = {0, 1, 2, 3, 4},
                          .column = {0, 1, 2, 3},
                          .value = {1.0, 1.0, -1.0, 1.0}};
    odpd::AssembledSystem system(matrix);
    system.share_among(ranks);
    odpd::make_solver({})->bind(system);
  };
  same(loose, "node 2 is not held");
}

TEST(Ranks, RefuseSolversOfWholeMatrices) {
  for (const std::string& name : odpd::available_solvers()) {
    if (!odpd::solver_traits(name).assembles) continue;
    support::ThreadTeam::run(2, [&](const Communicator& ranks) {
      Instant<2> instant(Model::central, Geometry::walls, 4.0, false, ranks);
      support::expect_error<odpd::SolverError>(
          [&] { odpd::make_solver({.name = name})->bind(*instant.system); },
          {name.c_str(), "one rank", "pcg"});
    });
  }
}

}  // namespace
