// Conjugate gradients on suspensions of rigid bodies: iterations of the fluid, and the answer of a factorisation.
#include <gtest/gtest.h>

#include <cmath>

#include "odpd/core/parallel.h"
#include "odpd/solvers/preconditioner.h"
#include "odpd/solvers/solver.h"
#include "solvers/suspension_toys.h"
#include "support/dimensions.h"
#include "support/memory_archive.h"

namespace {

using odpd::SolveReport;

template <class T>
class Suspensions : public ::testing::Test {};
TYPED_TEST_SUITE(Suspensions, support::Dimensions);

SolveReport answer_of(const odpd::System& system, const std::string& solver, double tolerance,
                      std::vector<double>& x, const std::string& preconditioner = "multilevel") {
  odpd::SolverOptions options{.name = solver, .tolerance = tolerance};
  if (solver == "pcg") options.preconditioner = preconditioner;
  const auto made = odpd::make_solver(options);
  made->bind(system);
  x.assign(static_cast<std::size_t>(system.size()), 0.0);
  return made->solve(support::random_numbers(x.size(), 11), x);
}

template <int D>
std::int64_t iterations_of(const toys::Suspension<D>& toy,
                           const std::string& preconditioner = "multilevel") {
  std::vector<double> x;
  const SolveReport report = answer_of(toy.resistance, "pcg", 1e-7, x, preconditioner);
  EXPECT_TRUE(report.converged) << report.failure;
  EXPECT_EQ(report.note, "");
  return report.iterations;
}

template <int D>
std::int64_t iterations_of_fluid(std::int64_t particles) {
  const toys::RandomFluid<D> toy(static_cast<std::size_t>(particles));
  std::vector<double> x;
  return answer_of(toy.resistance, "pcg", 1e-7, x).iterations;
}

// Bodies of half a grid cell, and of one and a half: 20, 21 (2D) and 18, 20 iterations, where random fluids take 25, 27, 21 and
// 21. Without the stiffness inside bodies the large disks take 50.
TYPED_TEST(Suspensions, TakeHardlyMoreIterationsThanTheirFluid) {
  constexpr int D = TypeParam::D;
  const auto small = toys::ball<D>(0.85, 0.4);
  const auto large = toys::ball<D>(D == 2 ? 3.0 : 2.0, 0.5);
  for (const bool big : {false, true}) {
    const toys::Suspension<D> toy(big ? large : small, D == 2 ? (big ? 5 : 12) : (big ? 2 : 4),
                                  D == 2 ? (big ? 6.6 : 2.3) : (big ? 4.6 : 2.3));
    const std::int64_t taken = iterations_of(toy);
    const std::int64_t fluid = iterations_of_fluid<D>(toy.resistance.mobile().nodes());
    EXPECT_LE(static_cast<double>(taken), 1.3 * static_cast<double>(fluid));
    EXPECT_GT(iterations_of(toy, "block-jacobi"), 2 * taken);
  }
}

// The grid is tilted with the box, and the stiffness inside bodies with it. Tilted wrongly it takes 46 and 49 iterations
// (2D), 31 and 28, where 20 are enough.
TYPED_TEST(Suspensions, AreNotSlowerUnderShear) {
  constexpr int D = TypeParam::D;
  const auto shape = toys::ball<D>(1.25, 0.4);
  const auto taken = [&](double slid) {
    return iterations_of(toys::Suspension<D>(shape, D == 2 ? 6 : 3, 3.1, 0.0, 3, false, slid));
  };
  const std::int64_t straight = taken(0.0);
  for (const double slid : {0.15, 0.5}) EXPECT_LE(taken(slid), straight + 4) << slid;
}

TEST(Suspensions, OfRodsToo) {
  const toys::Suspension<3> toy(toys::rod<3>(3.0, 0.5), 3, 3.2);
  EXPECT_LE(static_cast<double>(iterations_of(toy)),
            1.3 * static_cast<double>(iterations_of_fluid<3>(toy.resistance.mobile().nodes())));
}

// Block-Jacobi on the whole blocks of bodies. Of V and w apart the largest eigenvalue may be 3.
TYPED_TEST(Suspensions, TheLargestEigenvalueOfTheLocalPartIsTwo) {
  constexpr int D = TypeParam::D;
  const toys::Suspension<D> toy(toys::ball<D>(0.8, 0.4), 3, 1.75);
  const auto& a = toy.resistance;
  const auto n = static_cast<std::size_t>(a.size());
  constexpr std::size_t own = 2 * D;
  std::vector<double> blocks, all(n * D);
  a.body_blocks(blocks);
  a.block_diagonal(all);
  const auto bodies = static_cast<std::size_t>(a.map().bodies());
  const auto solve = [&](std::vector<double> r) {
    for (std::size_t node = bodies; node < a.linear_node(0); ++node) {
      std::vector<double> m(&all[node * D * D], &all[node * D * D] + D * D), z(D, 0.0);
      EXPECT_TRUE(odpd::invert_definite(m, D));
      for (std::size_t i = 0; i < D * D; ++i) z[i / D] += m[i] * r[node * D + i % D];
      std::copy(z.begin(), z.end(), &r[node * D]);
    }
    for (std::size_t b = 0; b < bodies; ++b) {
      std::vector<double> m(&blocks[b * own * own], &blocks[b * own * own] + own * own),
          z(own, 0.0);
      EXPECT_TRUE(odpd::invert_definite(m, own));
      const auto at = [&](std::size_t k) -> double& {
        return k < D ? r[b * D + k] : r[a.linear_node(b) * D + k - D];
      };
      for (std::size_t i = 0; i < own * own; ++i) z[i / own] += m[i] * at(i % own);
      for (std::size_t k = 0; k < own; ++k) at(k) = z[k];
    }
    return r;
  };
  std::vector<double> x = support::random_numbers(n, 5), ax(n);
  double largest = 0.0;
  for (int k = 0; k < 200; ++k) {
    a.apply(x, ax);
    const std::vector<double> y = solve(ax);
    largest = support::norm(y) / support::norm(x);
    const double scale = 1.0 / support::norm(y);
    for (std::size_t i = 0; i < n; ++i) x[i] = scale * y[i];
  }
  EXPECT_LT(largest, 2.0 + 1e-9);
  EXPECT_GT(largest, 1.5);
}

// Hardly a particle beside the bodies, or none: the grid's spacing and stiffness come from constituents.
TYPED_TEST(Suspensions, OfBodiesAlone) {
  constexpr int D = TypeParam::D;
  const toys::Suspension<D> toy(toys::ball<D>(0.9, 0.45), D == 2 ? 12 : 5, 1.35, 0.0, 3, false, 0.0,
                                0.8);
  EXPECT_LE(toy.resistance.mobile().nodes() - toy.resistance.map().constituents(), 8);
  EXPECT_LE(iterations_of(toy), 24);
}

// Two edges meet each disk or ball, so that not all of its block is definite: it does not move where nothing resists.
TYPED_TEST(Suspensions, OfBodiesThatFewEdgesMeet) {
  constexpr int D = TypeParam::D;
  support::Fluid<D> fluid(4.0, true);
  for (const double x : {1.0, 3.0}) {
    odpd::RigidBody<D> body;
    body.frame = toys::ball<D>(0.5, 0.5);
    body.pose.centre = support::uniform_vec<D>(2.0);
    body.pose.centre[0] = x;
    fluid.particles.add_body(body, fluid.box, 0);
  }
  fluid.connect(odpd::DpdModel<D>(1, {odpd::DpdParameters{.cutoff = 1.05}}));
  ASSERT_EQ(fluid.network.size(), 2);
  const odpd::DofMap<D> dofs(fluid.particles);
  std::vector<odpd::Vec<D>> arms;
  for (const auto& body : fluid.particles.bodies)
    arms.insert(arms.end(), body.frame.begin(), body.frame.end());
  odpd::RigidResistance<D> resistance(fluid.box);
  resistance.rebuild(fluid.network, dofs, fluid.particles, fluid.particles.position, arms, 0.0);
  // Pair forces along the edges, as noise and repulsion are.
  std::vector<odpd::Vec<D>> force(arms.size());
  for (std::size_t k = 0; k < 2; ++k) {
    const odpd::Vec<D> f = (k == 0 ? 1.0 : -0.4) * fluid.network.e[k];
    force[static_cast<std::size_t>(fluid.network.i[k])] += f;
    force[static_cast<std::size_t>(fluid.network.j[k])] -= f;
  }
  std::vector<double> load, x;
  dofs.gather(arms, force, load);
  resistance.scale_load(load);
  x.assign(load.size(), 0.0);
  const auto solver = odpd::make_solver({.name = "pcg", .tolerance = 1e-6});
  solver->bind(resistance);
  const SolveReport report = solver->solve(load, x);
  EXPECT_TRUE(report.converged) << report.failure;
  EXPECT_GT(support::norm(x), 0.01);
}

// Bound to a suspension, to the particles alone and back: nothing of the bodies is left over.
TYPED_TEST(Suspensions, LeaveNothingBehindInTheSolver) {
  constexpr int D = TypeParam::D;
  const toys::Suspension<D> toy(toys::ball<D>(0.8, 0.4), 3, 2.1);
  const auto solver = odpd::make_solver({.name = "pcg", .preconditioner = "block-jacobi"});
  const auto answer = [](odpd::Solver& with, const odpd::System& system) {
    const auto n = static_cast<std::size_t>(system.size());
    std::vector<double> x(n, 0.0);
    with.bind(system);
    EXPECT_TRUE(with.solve(support::random_numbers(n, 11), x).converged);
    return x;
  };
  const toys::RandomFluid<D> fluid(300);
  const std::vector<double> bodies = answer(*solver, toy.resistance);
  const auto fresh = odpd::make_solver({.name = "pcg", .preconditioner = "block-jacobi"});
  EXPECT_EQ(answer(*solver, fluid.resistance), answer(*fresh, fluid.resistance));
  EXPECT_EQ(answer(*solver, toy.resistance), bodies);
}

// Velocities of particles, so of the unknowns, agree to 1e-10.
TYPED_TEST(Suspensions, HaveTheAnswerOfAFactorisation) {
  constexpr int D = TypeParam::D;
  for (const bool hold : {false, true})
    for (const double shift : {0.0, 3.0})
      for (const auto& shape : {toys::ball<D>(0.8, 0.4), toys::rod<D>(1.2, 0.4)}) {
        if (hold && shift == 0.0) continue;  // nothing is held that is not null
        const toys::Suspension<D> toy(shape, 3, 2.0, shift, 3, hold);
        std::vector<double> exact;
        ASSERT_TRUE(answer_of(toy.resistance, "cholmod", 1e-13, exact).converged);
        for (const char* preconditioner : {"multilevel", "block-jacobi"}) {
          std::vector<double> x;
          const SolveReport report = answer_of(toy.resistance, "pcg", 1e-12, x, preconditioner);
          ASSERT_TRUE(report.converged) << report.failure;
          double difference = 0.0;
          for (std::size_t k = 0; k < x.size(); ++k)
            difference += (x[k] - exact[k]) * (x[k] - exact[k]);
          EXPECT_LT(std::sqrt(difference), 1e-10 * support::norm(exact))
              << preconditioner << ", shift " << shift << ", held " << hold;
        }
      }
}

TYPED_TEST(Suspensions, AreTheSameOnAnyNumberOfThreads) {
  constexpr int D = TypeParam::D;
  std::vector<std::vector<double>> answers(3);
  toys::Suspension<D> toy(toys::ball<D>(0.8, 0.4), D == 2 ? 13 : 4, 2.1);
  EXPECT_GT(toy.resistance.map().constituents(), 2048) << "fewer stay on one thread";
  for (const int threads : {1, 2, 3}) {
    odpd::set_threads(threads, 0);
    toy.rebuild(0.0);
    EXPECT_TRUE(
        answer_of(toy.resistance, "pcg", 1e-6, answers[static_cast<std::size_t>(threads - 1)])
            .converged);
  }
  odpd::set_threads(1, 0);
  EXPECT_EQ(answers[0], answers[1]);
  EXPECT_EQ(answers[0], answers[2]);
}

// The grid's operator is that of the old positions, before and after a restart; a fresh one gives other bits.
TYPED_TEST(Suspensions, GoOnFromWhatWasSaved) {
  constexpr int D = TypeParam::D;
  const auto shape = toys::ball<D>(0.8, 0.4);
  const toys::Suspension<D> old(shape, 3, 2.1), now(shape, 3, 2.1, 0.0, 4);
  const auto make = [] {
    return odpd::make_solver({.name = "pcg", .preconditioner = "multilevel"});
  };
  const auto answer = [&](odpd::Solver& solver, const toys::Suspension<D>& toy) {
    const auto n = static_cast<std::size_t>(toy.resistance.size());
    std::vector<double> x(n, 0.0);
    solver.bind(toy.resistance);
    EXPECT_TRUE(solver.solve(support::random_numbers(n, 11), x).converged);
    return x;
  };
  const auto unbroken = make(), restarted = make(), fresh = make();
  answer(*unbroken, old);
  support::MemoryArchive archive;
  unbroken->save(archive);
  restarted->load(archive, now.resistance.mobile());  // what there is before the first step
  const std::vector<double> expected = answer(*unbroken, now);
  EXPECT_EQ(answer(*restarted, now), expected);
  EXPECT_NE(answer(*fresh, now), expected);
}

}  // namespace
