// Conjugate gradients with the multilevel preconditioner: iterations that do not grow, an operator that is kept and
// rebuilt by its rule, and block-Jacobi where the grid does not help.
#include <gtest/gtest.h>

#include <cmath>

#include "odpd/core/parallel.h"
#include "odpd/solvers/galerkin.h"
#include "odpd/solvers/multilevel.h"
#include "odpd/solvers/solver.h"
#include "solvers/resistance_toys.h"
#include "support/dimensions.h"
#include "support/memory_archive.h"

namespace {

using odpd::SolveReport;

template <class T>
class MultilevelCg : public ::testing::Test {};
TYPED_TEST_SUITE(MultilevelCg, support::Dimensions);

template <int D>
SolveReport solve(const toys::RandomFluid<D>& toy, const std::string& preconditioner,
                  double tolerance, std::vector<double>& x) {
  const auto solver =
      odpd::make_solver({.name = "pcg", .tolerance = tolerance, .preconditioner = preconditioner});
  solver->bind(toy.resistance);
  x.assign(static_cast<std::size_t>(toy.resistance.size()), 0.0);
  return solver->solve(support::random_numbers(x.size(), 11), x);
}

TYPED_TEST(MultilevelCg, IterationsDoNotGrowWithTheBox) {
  constexpr int D = TypeParam::D;
  for (const toys::Ends ends : {toys::Ends::periodic, toys::Ends::walls}) {
    std::vector<std::int64_t> grid, plain;
    for (const std::size_t count : {std::size_t{4000}, std::size_t{20000}}) {
      const toys::RandomFluid<D> toy(count, ends);
      std::vector<double> x;
      const SolveReport with = solve(toy, "multilevel", 1e-7, x);
      ASSERT_TRUE(with.converged) << with.failure;
      EXPECT_EQ(with.note, "");
      grid.push_back(with.iterations);
      plain.push_back(solve(toy, "block-jacobi", 1e-7, x).iterations);
    }
    EXPECT_LE(grid[1], 32) << "random points are worse than a fluid";
    EXPECT_LE(grid[1], grid[0] + 8);
    EXPECT_GT(plain[1], 2 * grid[1]) << "without the grid they grow";
    EXPECT_GT(static_cast<double>(plain[1]), 1.2 * static_cast<double>(plain[0]));
  }
}

// Steep weights bind clusters of particles that move together against weak ties. D^-1 beside the grid takes 43 (2D) and 49
// iterations here, and a local part that is not definite more than 100.
TYPED_TEST(MultilevelCg, SteepWeightsNeedNotManyMore) {
  constexpr int D = TypeParam::D;
  const toys::RandomFluid<D> toy(8000, toys::Ends::periodic, 0.0, 0.0, 3, 2.0);
  std::vector<double> x;
  const SolveReport report = solve(toy, "multilevel", 1e-7, x);
  ASSERT_TRUE(report.converged) << report.failure;
  EXPECT_EQ(report.note, "");
  EXPECT_LE(report.iterations, 38);
}

// So steep that three neighbours share a particle's friction: four local steps. Two of them take 86 (2D)
// and 97 iterations.
TYPED_TEST(MultilevelCg, TakesMoreLocalStepsForSteeperWeights) {
  constexpr int D = TypeParam::D;
  const toys::RandomFluid<D> toy(8000, toys::Ends::periodic, 0.0, 0.0, 3, 5.0);
  const odpd::FrictionSpread friction = odpd::friction_spread(toy.resistance);
  EXPECT_GT(friction.ties, 2.0);
  EXPECT_LT(friction.ties, 5.0);
  std::vector<double> x;
  const SolveReport report = solve(toy, "multilevel", 1e-7, x);
  ASSERT_TRUE(report.converged) << report.failure;
  EXPECT_EQ(report.note, "");
  EXPECT_LE(report.iterations, 74);
}

TYPED_TEST(MultilevelCg, ReachesADoubleResidual) {
  const toys::RandomFluid<TypeParam::D> toy(1000, toys::Ends::walls);
  for (const char* preconditioner : {"multilevel", "block-jacobi"}) {
    std::vector<double> x, r;
    const SolveReport report = solve(toy, preconditioner, 1e-12, x);
    ASSERT_TRUE(report.converged) << report.failure;
    const std::vector<double> b = support::random_numbers(x.size(), 11);
    r.resize(x.size());
    toy.resistance.apply(x, r);
    for (std::size_t k = 0; k < r.size(); ++k) r[k] = b[k] - r[k];
    EXPECT_LE(support::norm(r), 1.0001e-12 * support::norm(b));
  }
}

TYPED_TEST(MultilevelCg, IsTheSameOnAnyNumberOfThreads) {
  std::vector<std::vector<double>> answers(3);
  for (const int threads : {1, 2, 3}) {
    odpd::set_threads(threads, 0);
    const toys::RandomFluid<TypeParam::D> toy(5000);
    EXPECT_TRUE(
        solve(toy, "multilevel", 1e-6, answers[static_cast<std::size_t>(threads - 1)]).converged);
  }
  odpd::set_threads(1, 0);
  EXPECT_EQ(answers[0], answers[1]);
  EXPECT_EQ(answers[0], answers[2]);
}

TYPED_TEST(MultilevelCg, KeepsItsGridOperatorUntilItHasAged) {
  constexpr int D = TypeParam::D;
  toys::RandomFluid<D> toy(1000);
  odpd::SlicedRows<D> rows;
  rows.pack(toy.resistance);
  odpd::Multilevel<D> grid;
  grid.set_up(toy.resistance, rows);
  EXPECT_EQ(grid.builds(), 1);
  grid.note_rate(0.20);  // the fresh one's
  grid.set_up(toy.resistance, rows);
  grid.note_rate(0.161);
  grid.set_up(toy.resistance, rows);
  EXPECT_EQ(grid.builds(), 1) << "as good as new";
  grid.note_rate(0.159);
  grid.set_up(toy.resistance, rows);
  EXPECT_EQ(grid.builds(), 2) << "below 0.8 of the fresh rate";
  grid.note_rate(0.10);
  grid.set_up(toy.resistance, rows);
  EXPECT_EQ(grid.builds(), 2) << "the new operator is measured by its own first rate";
  toy.rebuild(0.5);
  grid.set_up(toy.resistance, rows);
  EXPECT_EQ(grid.builds(), 3) << "another shift is another operator";
}

TYPED_TEST(MultilevelCg, GoesOnFromWhatItSaved) {
  constexpr int D = TypeParam::D;
  const toys::RandomFluid<D> old(1000, toys::Ends::periodic, 0.0, 0.0, 3);
  const toys::RandomFluid<D> now(1000, toys::Ends::periodic, 0.0, 0.0, 4);
  const auto b = support::random_numbers(static_cast<std::size_t>(now.resistance.size()), 11);
  const auto make = [] {
    return odpd::make_solver({.name = "pcg", .preconditioner = "multilevel"});
  };
  const auto answer = [&](odpd::Solver& solver) {
    std::vector<double> x(b.size(), 0.0);
    solver.bind(now.resistance);
    EXPECT_TRUE(solver.solve(b, x).converged);
    return x;
  };
  const auto unbroken = make(), restarted = make(), fresh = make();
  unbroken->bind(old.resistance);
  std::vector<double> unused(b.size(), 0.0);
  unbroken->solve(b, unused);
  support::MemoryArchive archive;
  unbroken->save(archive);
  restarted->load(archive, now.resistance);
  const std::vector<double> expected = answer(*unbroken);
  EXPECT_EQ(answer(*restarted), expected);
  EXPECT_NE(answer(*fresh), expected) << "the operator of the old positions makes a difference";
}

// auto: as multilevel, or as block-jacobi, whichever was measured to be faster.
TYPED_TEST(MultilevelCg, TakesTheGridWhereItPays) {
  constexpr int D = TypeParam::D;
  const auto same = [](const toys::RandomFluid<D>& toy, const char* preconditioner) {
    std::vector<double> a, b;
    const std::int64_t automatic = solve(toy, "auto", 1e-6, a).iterations;
    return automatic == solve(toy, preconditioner, 1e-6, b).iterations && a == b;
  };
  EXPECT_TRUE(same(toys::RandomFluid<D>(300), "block-jacobi")) << "few particles";
  toys::RandomFluid<D> toy(6000);
  EXPECT_TRUE(same(toy, "multilevel"));
  EXPECT_FALSE(same(toy, "block-jacobi"));
  toy.rebuild(0.001);
  EXPECT_TRUE(same(toy, "multilevel"));
  toy.rebuild(10.0);
  EXPECT_TRUE(same(toy, "block-jacobi")) << "the shift outweighs the friction";
}

// Few particles in a large box: no more grid points than particles, and a coarsest operator of low rank does no harm.
TYPED_TEST(MultilevelCg, SurvivesAnEmptyBox) {
  constexpr int D = TypeParam::D;
  for (const std::size_t count :
       {std::size_t{3}, std::size_t{8}, std::size_t{14}, std::size_t{60}}) {
    odpd::Box<D> box;
    box.size = support::uniform_vec<D>(40.0);
    box.periodic.fill(true);
    support::Fluid<D> fluid(40.0, true);
    for (const auto& r : support::random_points<D>({}, support::uniform_vec<D>(2.0), count, count))
      fluid.particles.add(r, 0);
    fluid.connect(odpd::DpdModel<D>(1, {odpd::DpdParameters{}}));
    for (const double shift : {1e-6, 1e-2, 10.0}) {
      odpd::Resistance<D> resistance(box);
      resistance.rebuild(fluid.network, odpd::DofMap<D>(fluid.particles), fluid.particles,
                         fluid.particles.position, shift);
      const auto solver =
          odpd::make_solver({.name = "pcg", .tolerance = 1e-6, .preconditioner = "multilevel"});
      solver->bind(resistance);
      std::vector<double> x(static_cast<std::size_t>(resistance.size()), 0.0);
      const SolveReport report = solver->solve(support::random_numbers(x.size(), 5), x);
      EXPECT_TRUE(report.converged) << count << " particles, shift " << shift << report.failure;
      EXPECT_LT(report.memory_bytes, 4000000);
    }
  }
}

// The grid's operator is that of friction 10^10 times weaker: what it answers drowns everything else.
TYPED_TEST(MultilevelCg, FallsBackToBlockJacobiAndThenTriesTheGridAgain) {
  constexpr int D = TypeParam::D;
  toys::RandomFluid<D> toy(1000);
  const auto b = support::random_numbers(static_cast<std::size_t>(toy.resistance.size()), 11);
  const auto solver = odpd::make_solver({.name = "pcg", .preconditioner = "multilevel"});
  const auto solved = [&](double friction) {
    for (double& zeta : toy.fluid.network.zeta_par) zeta *= friction;
    toy.rebuild(0.0);
    solver->bind(toy.resistance);
    std::vector<double> x(b.size(), 0.0);
    const SolveReport report = solver->solve(b, x);
    EXPECT_TRUE(report.converged) << report.failure;
    return report;
  };
  EXPECT_EQ(solved(1e-10).note, "");
  const SolveReport fallen = solved(1e10);
  EXPECT_TRUE(fallen.note.starts_with("multilevel gave up")) << fallen.note;
  EXPECT_TRUE(fallen.note.ends_with("block-Jacobi instead")) << fallen.note;
  EXPECT_EQ(solved(1.0).note, "") << "its operator is built anew";
}

// Particles on top of each other in a corner, held by next to nothing: the last resort of either preconditioner.
TYPED_TEST(MultilevelCg, LeavesToDoublePrecisionWhatSinglePrecisionCannotDo) {
  constexpr int D = TypeParam::D;
  support::Fluid<D> fluid(40.0, true);
  for (const auto& r : support::random_points<D>({}, support::uniform_vec<D>(2.0), 60, 60))
    fluid.particles.add(r, 0);
  fluid.connect(odpd::DpdModel<D>(1, {odpd::DpdParameters{}}));
  odpd::Resistance<D> resistance(fluid.box);
  resistance.rebuild(fluid.network, odpd::DofMap<D>(fluid.particles), fluid.particles,
                     fluid.particles.position, 1e-7);
  for (const char* preconditioner : {"multilevel", "block-jacobi"}) {
    const auto solver =
        odpd::make_solver({.name = "pcg", .tolerance = 1e-8, .preconditioner = preconditioner});
    solver->bind(resistance);
    std::vector<double> x(static_cast<std::size_t>(resistance.size()), 0.0), r(x.size());
    const auto b = support::random_numbers(x.size(), 5);
    const SolveReport report = solver->solve(b, x);
    ASSERT_TRUE(report.converged) << report.failure;
    EXPECT_TRUE(report.note.ends_with("double precision instead")) << report.note;
    EXPECT_LT(report.iterations, 6000);
    resistance.apply(x, r);
    for (std::size_t k = 0; k < r.size(); ++k) r[k] -= b[k];
    EXPECT_LE(support::norm(r), 1.001e-8 * support::norm(b));
    solver->bind(resistance);
    std::fill(x.begin(), x.end(), 0.0);
    EXPECT_EQ(solver->solve(b, x).iterations, report.iterations) << "single precision comes first";
  }
}

TYPED_TEST(MultilevelCg, NamesOtherPreconditioners) {
  EXPECT_THROW(odpd::make_solver({.name = "pcg", .preconditioner = "ilu"}), odpd::ConfigError);
  EXPECT_THROW(odpd::make_solver({.name = "cholmod", .preconditioner = "multilevel"}),
               odpd::ConfigError);
}

}  // namespace
