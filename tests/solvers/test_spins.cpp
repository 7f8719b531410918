// Conjugate gradients where particles spin: the local part is definite, the grid sees what spins leave of the friction, and the
// iterations are those of the fluid without spins.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "odpd/core/parallel.h"
#include "odpd/solvers/galerkin.h"
#include "odpd/solvers/multilevel.h"
#include "odpd/solvers/solver.h"
#include "odpd/solvers/spin_blocks.h"
#include "solvers/resistance_toys.h"
#include "support/dimensions.h"
#include "support/spin_fluid.h"

namespace {

using odpd::SolveReport;
using support::SpinFluid;
using support::SpinFluidSpec;

template <class T>
class SpinSolvers : public ::testing::Test {};
TYPED_TEST_SUITE(SpinSolvers, support::Dimensions);

SolveReport solve_spins(const odpd::System& system, const std::string& preconditioner,
                        double tolerance, std::vector<double>& x) {
  const auto solver =
      odpd::make_solver({.name = "pcg", .tolerance = tolerance, .preconditioner = preconditioner});
  solver->bind(system);
  x.assign(static_cast<std::size_t>(system.size()), 0.0);
  return solver->solve(support::random_numbers(x.size(), 11), x);
}

/// The largest eigenvalue of D^-1 A, by Rayleigh's quotient after some steps of the power method. D: blocks of each particle, or
/// those of velocities and spins apart.
template <int D>
double largest_eigenvalue(const SpinFluid<D>& toy, bool whole) {
  const odpd::System& a = toy.system();
  const auto n = static_cast<std::size_t>(a.nodes()),
             front = static_cast<std::size_t>(toy.resistance.spins());
  std::vector<double> x = support::random_numbers(n * D, 7), y(n * D), blocks(n * D * D);
  a.block_diagonal(blocks);
  const auto quotient_and_step = [&] {
    a.apply(x, y);
    double above = 0.0, below = 0.0;
    std::vector<double> next(n * D, 0.0);
    const auto relax = [&](const std::vector<std::size_t>& unknowns, std::vector<double> block) {
      const std::size_t m = unknowns.size();
      for (std::size_t r = 0; r < m; ++r)
        for (std::size_t c = 0; c < m; ++c)
          below += x[unknowns[r]] * block[r * m + c] * x[unknowns[c]];
      ASSERT_TRUE(odpd::invert_definite(block, static_cast<int>(m)));
      for (std::size_t r = 0; r < m; ++r)
        for (std::size_t c = 0; c < m; ++c) next[unknowns[r]] += block[r * m + c] * y[unknowns[c]];
    };
    for (std::size_t row = 0; row < n - front; ++row) {
      const std::int32_t spin = toy.resistance.spin_of(row);
      std::vector<std::size_t> unknowns, spins;
      for (std::size_t c = 0; c < D; ++c) unknowns.push_back((front + row) * D + c);
      for (std::size_t c = 0; c < D && spin >= 0; ++c)
        spins.push_back(static_cast<std::size_t>(spin) * D + c);
      const auto block_of = [&](const std::vector<std::size_t>& of) {
        const auto at = blocks.begin() + static_cast<std::ptrdiff_t>(of[0] * D);
        return std::vector<double>(at, at + D * D);
      };
      if (spin >= 0 && whole) {
        const auto all = toy.resistance.particle_block(row);
        unknowns.insert(unknowns.end(), spins.begin(), spins.end());
        relax(unknowns, {all.begin(), all.end()});
      } else {
        relax(unknowns, block_of(unknowns));
        if (spin >= 0) relax(spins, block_of(spins));
      }
    }
    above = support::dot(x, y);
    const double size = support::norm(next);
    for (std::size_t k = 0; k < x.size(); ++k) x[k] = next[k] / size;
    return above / below;
  };
  double quotient = 0.0;
  for (int step = 0; step < 300; ++step) quotient = quotient_and_step();
  return quotient;
}

// q(L) = 2 (2.15 - L) is definite to 2.15. With blocks of velocity and spin together, 2 D - A >= 0 edge by edge, whatever the
// configuration; apart they reach twice that where particles have few neighbours.
TYPED_TEST(SpinSolvers, TheLocalPartIsDefinite) {
  constexpr int D = TypeParam::D;
  const SpinFluid<D> dense({.count = 600, .radius_spread = 0.5});
  EXPECT_LE(largest_eigenvalue(dense, true), 2.0 + 1e-9);
  EXPECT_GT(largest_eigenvalue(dense, true), 1.8);
  const SpinFluid<D> sparse(
      {.count = 300, .radius_spread = 0.5, .inertia = 1e-3, .density = D == 2 ? 0.8 : 0.4});
  EXPECT_LE(largest_eigenvalue(sparse, true), 2.0 + 1e-9);
  EXPECT_GT(largest_eigenvalue(sparse, false), 2.2);
}

// Friction across lines of centres up to that along them; with twice as much it is 1.2 to 1.3 times beside walls. Without spins: the
// same particles with friction along lines of centres alone, a viscous fluid as this one is.
TYPED_TEST(SpinSolvers, IterationsAreThoseOfTheFluidWithoutSpins) {
  constexpr int D = TypeParam::D;
  std::vector<double> x;
  for (const bool walls : {false, true})
    for (const std::size_t count : {std::size_t{4000}, std::size_t{12000}}) {
      const toys::RandomFluid<D> plain(count, walls ? toys::Ends::walls : toys::Ends::periodic);
      const std::int64_t central = solve_spins(plain.resistance, "multilevel", 1e-7, x).iterations;
      for (const double gamma_perp : {2.25, 4.5}) {
        const SpinFluid<D> toy({.count = count, .walls = walls, .gamma_perp = gamma_perp});
        const SolveReport report = solve_spins(toy.system(), "multilevel", 1e-7, x);
        ASSERT_TRUE(report.converged) << report.failure;
        EXPECT_EQ(report.note, "");
        EXPECT_LE(5 * report.iterations, 6 * central)
            << report.iterations << " of " << central << ", gamma_perp " << gamma_perp
            << (walls ? ", walls, N " : ", N ") << count;
      }
    }
}

TYPED_TEST(SpinSolvers, ServesWhereFewSpin) {
  constexpr int D = TypeParam::D;
  std::vector<double> x;
  const SpinFluid<D> none({.count = 6000, .spinning = 0.0}),
      few({.count = 6000, .spinning = 0.03, .radius_spread = 1.0});
  ASSERT_GT(few.resistance.spins(), 100);
  ASSERT_EQ(none.system().size(), none.velocities().size());
  const SolveReport with = solve_spins(few.system(), "multilevel", 1e-7, x);
  const SolveReport without = solve_spins(none.system(), "multilevel", 1e-7, x);
  ASSERT_TRUE(with.converged) << with.failure;
  EXPECT_EQ(with.note, "");
  EXPECT_LE(with.iterations, without.iterations + 4);
  EXPECT_LT(with.memory_bytes, 1.3 * static_cast<double>(without.memory_bytes));
}

TYPED_TEST(SpinSolvers, ReachesADoubleResidual) {
  constexpr int D = TypeParam::D;
  for (const SpinFluidSpec& spec :
       {SpinFluidSpec{.count = 1000, .walls = true, .spinning = 0.7, .radius_spread = 1.0},
        SpinFluidSpec{.count = 1000, .inertia = 0.2},
        // Nobody is in reach of friction across: spins and velocities know nothing of each other.
        SpinFluidSpec{.count = 1000, .gamma_perp = 0.0, .inertia = 0.2},
        SpinFluidSpec{.count = 1000, .walls = true, .s = 5.0}})
    for (const char* preconditioner : {"multilevel", "block-jacobi"}) {
      const SpinFluid<D> toy(spec);
      std::vector<double> x;
      const SolveReport report = solve_spins(toy.system(), preconditioner, 1e-12, x);
      ASSERT_TRUE(report.converged) << report.failure;
      EXPECT_EQ(report.note, "");
      const std::vector<double> b = support::random_numbers(x.size(), 11);
      std::vector<double> r(x.size());
      toy.system().apply(x, r);
      for (std::size_t k = 0; k < r.size(); ++k) r[k] = b[k] - r[k];
      EXPECT_LE(support::norm(r), 1.0001e-12 * support::norm(b));
    }
}

TYPED_TEST(SpinSolvers, IsTheSameOnAnyNumberOfThreads) {
  std::vector<std::vector<double>> answers(3);
  for (const int threads : {1, 2, 3}) {
    odpd::set_threads(threads, 0);
    const SpinFluid<TypeParam::D> toy({.count = 5000, .spinning = 0.6});
    EXPECT_TRUE(solve_spins(toy.system(), "multilevel", 1e-6,
                            answers[static_cast<std::size_t>(threads - 1)])
                    .converged);
  }
  odpd::set_threads(1, 0);
  EXPECT_EQ(answers[0], answers[1]);
  EXPECT_EQ(answers[0], answers[2]);
}

// P V P^T with P of velocities and spins: a . P V P^T b = b . P V P^T a.
TYPED_TEST(SpinSolvers, TheGridsPartIsSymmetric) {
  constexpr int D = TypeParam::D;
  const SpinFluid<D> toy({.count = 2000, .radius_spread = 1.0});
  odpd::SlicedRows<D> rows;
  rows.pack(toy.velocities());
  odpd::Multilevel<D> grid;
  grid.set_up(toy.velocities(), rows, nullptr, &toy.resistance);
  const std::int64_t places = rows.places() + odpd::SpinRows<D>::places_of(toy.resistance.spins());
  const std::int64_t stride = odpd::SlicedRows<D>::stride;
  const auto at_places = [&](std::uint64_t seed) {
    const std::vector<double> numbers =
        support::random_numbers(static_cast<std::size_t>(places * stride), seed);
    std::vector<float> v(numbers.begin(), numbers.end());
    for (std::int64_t k = 0; k < places * stride; ++k) {
      const std::int64_t place = k / stride;
      const bool used = place < rows.places()
                            ? rows.node_of_place()[static_cast<std::size_t>(place)] >= 0
                            : place - rows.places() < toy.resistance.spins();
      // Velocities weigh nothing in one of the vectors: it is the spins that are looked at.
      if (k % stride >= D || !used || (seed == 1 && place < rows.places()))
        v[static_cast<std::size_t>(k)] = 0.0F;
    }
    return v;
  };
  const auto applied = [&](const std::vector<float>& r) {
    for (std::int64_t chunk = 0; chunk < grid.chunks(); ++chunk) {
      grid.clear_chunk(chunk);
      grid.restrict_chunk(chunk, r.data(), odpd::chunk_begin(places, chunk),
                          odpd::chunk_begin(places, chunk + 1));
    }
    grid.cycle();
    std::vector<float> p(r.size(), 0.0F);
    const std::vector<float> zero(r.size(), 0.0F);
    grid.interpolate(zero.data(), p.data(), 0.0F, 0, places);
    return p;
  };
  const auto dot = [](const std::vector<float>& a, const std::vector<float>& b) {
    return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
  };
  const std::vector<float> a = at_places(1), b = at_places(2);
  const std::vector<float> ma = applied(a), mb = applied(b);
  EXPECT_NEAR(dot(b, ma), dot(a, mb), 1e-4 * std::sqrt(dot(a, ma) * dot(b, mb)));
  EXPECT_GT(dot(a, ma), 0.0);
}

/// v_x = sin(k r_c) and w = 1/2 curl v: x . A x, and that of the grid's operator, built with the spins and without.
template <int D>
struct WaveEnergy {
  WaveEnergy(const SpinFluid<D>& toy, int c) {
    const odpd::Resistance<D>& velocities = toy.velocities();
    const double k = 2.0 * std::numbers::pi / toy.fluid.box.size[c];
    std::vector<double> x(static_cast<std::size_t>(toy.system().size()), 0.0), y(x.size());
    const auto front = static_cast<std::size_t>(toy.resistance.spins());
    for (std::size_t row = 0; row < static_cast<std::size_t>(velocities.nodes()); ++row) {
      const double phase = k * velocities.position(row)[c];
      x[(front + row) * D] = std::sin(phase);
      const auto spin = static_cast<std::size_t>(toy.resistance.spin_of(row));
      const double turn = c == 1 ? -0.5 * k * std::cos(phase) : 0.0;
      x[spin * D + (D == 2 ? 0 : 2)] = turn * toy.resistance.length(spin);
    }
    toy.system().apply(x, y);
    exact = support::dot(x, y);
    const odpd::GridShape<D> shape = odpd::choose_grid(toy.fluid.box, velocities.positions(), 1.0);
    const auto of_grid = [&](const odpd::SpinResistance<D>* spins) {
      odpd::GridOperator<D> a = odpd::galerkin<D>(velocities, shape, nullptr, 0.0, spins);
      odpd::FloatArray b, v, r;
      for (odpd::FloatArray* of : {&b, &v, &r}) {
        of->resize(shape.pitch() * D);
        of->fill(0.0F);
      }
      odpd::for_each_point(shape, [&](const auto& point) {
        const double at = shape.low[c] + static_cast<double>(point[static_cast<std::size_t>(c)]) /
                                             shape.per_length[c];
        v.data()[shape.margin() + shape.number_of(point)] = static_cast<float>(std::sin(k * at));
      });
      a.fill_ghosts(v.data());
      a.residual(b.data(), v.data(), r.data());
      double sum = 0.0;
      odpd::for_each_point(shape, [&](const auto& point) {
        const std::int64_t n = shape.margin() + shape.number_of(point);
        sum -= static_cast<double>(v.data()[n]) * static_cast<double>(r.data()[n]);
      });
      return sum;
    };
    with_spins = of_grid(&toy.resistance);
    without = of_grid(nullptr);
  }
  double exact, with_spins, without;
};

// Without spins the grid would see the transverse friction of a fluid that cannot turn. A compression does not turn anything.
TYPED_TEST(SpinSolvers, TheGridSeesTheStrainRateAlone) {
  constexpr int D = TypeParam::D;
  const SpinFluid<D> toy({.count = D == 2 ? std::size_t{4000} : std::size_t{16000},
                          .gamma_perp = 9.0,
                          .radius_spread = 0.5});
  const WaveEnergy<D> shear(toy, 1), compression(toy, 0);
  EXPECT_NEAR(shear.with_spins, shear.exact, 0.05 * shear.exact);
  EXPECT_GT(shear.without, 2.0 * shear.exact);
  EXPECT_NEAR(compression.with_spins, compression.exact, 0.05 * compression.exact);
  EXPECT_NEAR(compression.without, compression.exact, 0.05 * compression.exact);
}

}  // namespace
