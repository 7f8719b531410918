// The grid below the particles: its shape, its operator, and the cycle that inverts it.
#include <gtest/gtest.h>

#include <cmath>

#include "odpd/solvers/galerkin.h"
#include "solvers/resistance_toys.h"
#include "support/dimensions.h"
#include "support/points.h"

namespace {

using odpd::GridOperator;
using odpd::GridShape;

template <class T>
class Grid : public ::testing::Test {};
TYPED_TEST_SUITE(Grid, support::Dimensions);

template <int D>
GridShape<D> grid_of(const toys::RandomFluid<D>& toy, double spacing) {
  return odpd::choose_grid(toy.resistance.box(), toy.resistance.positions(), spacing);
}

TYPED_TEST(Grid, HasNearlyTheSpacingAskedForAndCanBeHalved) {
  constexpr int D = TypeParam::D;
  for (double length = 2.0; length < 200.0; length *= 1.07) {
    odpd::Box<D> box;
    box.size = support::uniform_vec<D>(length);
    box.periodic.fill(true);
    const GridShape<D> shape = odpd::choose_grid(box, {}, 1.7);
    const double spacing = length / static_cast<double>(shape.cells[0]);
    EXPECT_LT(spacing, 1.7 * 1.35) << length;
    if (length > 4.0) {
      EXPECT_GT(spacing, 1.7 / 1.35) << length;
    }
    GridShape<D> coarse = shape;
    while (coarse.coarser().cells != coarse.cells) coarse = coarse.coarser();
    EXPECT_LE(coarse.cells[0], 7) << "the dense solve must stay small; length " << length;
  }
}

TYPED_TEST(Grid, NeighboursLieAtFixedOffsets) {
  constexpr int D = TypeParam::D;
  typename GridShape<D>::Index cells;
  std::array<bool, D> periodic{};
  for (std::size_t c = 0; c < D; ++c) cells[c] = 3 + static_cast<std::int64_t>(c);
  periodic[0] = true;
  const GridShape<D> shape({}, support::uniform_vec<D>(1.0), cells, periodic);
  EXPECT_EQ(shape.points(0), 3);
  EXPECT_EQ(shape.points(1), 5);
  std::int64_t count = 0;
  odpd::for_each_point(shape, [&](const auto& point) {
    ++count;
    auto right = point;
    ++right[0];
    const int entry = GridShape<D>::entries / 2 + 1;
    EXPECT_EQ(shape.number_of(right), shape.number_of(point) + shape.entry_offset(entry));
    EXPECT_GE(shape.number_of(point), 0);
    EXPECT_LT(shape.number_of(point), shape.total());
  });
  EXPECT_EQ(count, shape.points());
}

template <int D>
using PointValues = std::vector<odpd::Vec<D>>;  // in the order of for_each_point

template <int D>
std::size_t number_of(const GridShape<D>& shape, typename GridShape<D>::Index point) {
  std::int64_t number = 0;
  for (int c = D - 1; c >= 0; --c) {
    const auto i = static_cast<std::size_t>(c);
    if (shape.periodic[i]) point[i] %= shape.points(c);
    number = number * shape.points(c) + point[i];
  }
  return static_cast<std::size_t>(number);
}

/// x^T A x by the operator.
template <int D>
double energy_of(const GridOperator<D>& a, const PointValues<D>& values) {
  const GridShape<D>& shape = a.shape();
  odpd::FloatArray x, b, r;
  for (odpd::FloatArray* f : {&x, &b, &r}) {
    f->resize(D * shape.pitch());
    f->fill(0.0F);
  }
  const auto at = [&](odpd::FloatArray& f, const auto& point, int c) -> float& {
    return f.data()[shape.margin() + c * shape.pitch() + shape.number_of(point)];
  };
  std::size_t k = 0;
  odpd::for_each_point(shape, [&](const auto& point) {
    for (int c = 0; c < D; ++c) at(x, point, c) = static_cast<float>(values[k][c]);
    ++k;
  });
  a.residual(b.data(), x.data(), r.data());
  double energy = 0.0;
  odpd::for_each_point(shape, [&](const auto& point) {
    for (int c = 0; c < D; ++c)
      energy -= static_cast<double>(at(x, point, c)) * static_cast<double>(at(r, point, c));
  });
  return energy;
}

// x^T A x of a velocity that is linear in space is the same on the grid and among the particles.
TYPED_TEST(Grid, TheOperatorIsExactForLinearVelocities) {
  constexpr int D = TypeParam::D;
  for (const double gamma_perp : {0.0, 1.5}) {
    const toys::RandomFluid<D> toy(400, toys::Ends::open, 0.7, gamma_perp);
    const auto gradient = support::random_numbers(D * D, 5);
    const auto velocity = [&](const odpd::Vec<D>& r) {
      odpd::Vec<D> v = support::uniform_vec<D>(0.3);
      for (std::size_t row = 0; row < D; ++row)
        for (std::size_t col = 0; col < D; ++col) v.x[row] += gradient[row * D + col] * r.x[col];
      return v;
    };
    std::vector<double> v, rv(static_cast<std::size_t>(toy.resistance.size()));
    for (std::size_t n = 0; n < static_cast<std::size_t>(toy.resistance.nodes()); ++n) {
      odpd::Vec<D> r;
      for (std::size_t c = 0; c < D; ++c) r.x[c] = toy.resistance.positions()[n * D + c];
      for (const double x : velocity(r).x) v.push_back(x);
    }
    toy.resistance.apply(v, rv);
    // The finest grid and those below it.
    GridOperator<D> a = odpd::galerkin(toy.resistance, grid_of(toy, 0.9));
    for (int level = 0; level < 2; ++level) {
      const GridShape<D>& shape = a.shape();
      PointValues<D> values;
      odpd::for_each_point(shape, [&](const auto& point) {
        odpd::Vec<D> at;
        for (std::size_t c = 0; c < D; ++c)
          at.x[c] = shape.low.x[c] + static_cast<double>(point[c]) / shape.per_length.x[c];
        values.push_back(velocity(at));
      });
      EXPECT_NEAR(energy_of(a, values), support::dot(v, rv), 2e-5 * support::dot(v, rv))
          << "level " << level;
      a = a.coarsened();
    }
  }
}

/// The same by definition (solvers/galerkin.h): each half of an edge with the gradient at its end.
template <int D>
double energy_by_half_edges(const odpd::Resistance<D>& resistance, const GridShape<D>& shape,
                            const PointValues<D>& values) {
  double energy = 0.0;
  const auto position = [&](std::size_t n) {
    odpd::Vec<D> r;
    for (std::size_t c = 0; c < D; ++c) r.x[c] = resistance.positions()[n * D + c];
    return r;
  };
  for (std::size_t n = 0; n < static_cast<std::size_t>(resistance.nodes()); ++n) {
    const odpd::GridPosition<D> at =
        odpd::locate(shape, odpd::grid_position(resistance, n).x.data());
    odpd::Vec<D> value, slope[D];
    for (int corner = 0; corner < GridShape<D>::corners; ++corner) {
      auto point = at.cell;
      double hat[D], weight = 1.0;
      for (int c = 0; c < D; ++c) {
        const auto i = static_cast<std::size_t>(c);
        const bool high = (corner >> c) % 2 == 1;
        point[i] += high ? 1 : 0;
        hat[c] = static_cast<double>(high ? at.in_cell[i] : 1.0F - at.in_cell[i]);
        weight *= hat[c];
      }
      const odpd::Vec<D>& u = values[number_of(shape, point)];
      value += weight * u;
      for (int c = 0; c < D; ++c) {
        double w = (corner >> c) % 2 == 1 ? 1.0 : -1.0;
        for (int other = 0; other < D; ++other) w *= other == c ? 1.0 : hat[other];
        slope[c] += w * u;
      }
    }
    for (const auto& link : resistance.links(n)) {
      const odpd::Vec<D> d =
          resistance.box().separation(position(n), position(static_cast<std::size_t>(link.node)));
      odpd::Vec<D> slip;
      for (int c = 0; c < D; ++c) slip += d[c] * shape.per_length[c] * slope[c];
      const double along = dot(resistance.g(link), slip);
      const bool across = resistance.transverse();
      energy += 0.5 * (across ? resistance.across(link).sign : 1.0) * along * along;
      if (across) energy += 0.5 * resistance.across(link).zeta_perp * dot(slip, slip);
    }
    if (resistance.anchors().empty()) continue;
    for (std::size_t row = 0; row < D; ++row)
      for (std::size_t col = 0; col < D; ++col)
        energy += value.x[row] * resistance.anchors()[n][row * D + col] * value.x[col];
  }
  return energy;
}

template <int D>
PointValues<D> random_values(const GridShape<D>& shape) {
  return support::random_vectors<D>(static_cast<std::size_t>(shape.points()), 11);
}

TYPED_TEST(Grid, TheOperatorIsTheSumOverHalvesOfEdges) {
  constexpr int D = TypeParam::D;
  for (const toys::Ends ends : {toys::Ends::periodic, toys::Ends::walls, toys::Ends::open})
    for (const double gamma_perp : {0.0, 1.5, 9.0}) {  // the last above gamma
      const toys::RandomFluid<D> toy(800, ends, 0.3, gamma_perp);
      const GridShape<D> shape = grid_of(toy, 1.3);
      const PointValues<D> values = random_values(shape);
      const double exact = energy_by_half_edges(toy.resistance, shape, values);
      EXPECT_NEAR(energy_of(odpd::galerkin(toy.resistance, shape), values), exact, 2e-5 * exact)
          << static_cast<int>(ends) << ' ' << gamma_perp;
    }
}

/// A coarse grid's values on the finer one, multilinear.
template <int D>
PointValues<D> refined(const GridShape<D>& coarse, const GridShape<D>& fine,
                       const PointValues<D>& values) {
  PointValues<D> result;
  odpd::for_each_point(fine, [&](const auto& point) {
    odpd::Vec<D> sum;
    for (int corner = 0; corner < GridShape<D>::corners; ++corner) {
      auto at = point;
      double weight = 1.0;
      for (int c = 0; c < D; ++c) {
        const auto i = static_cast<std::size_t>(c);
        const bool high = (corner >> c) % 2 == 1;
        if (!fine.coarsened(c) || point[i] % 2 == 0) {
          weight *= high ? 0.0 : 1.0;
          at[i] = fine.coarsened(c) ? point[i] / 2 : point[i];
        } else {
          weight *= 0.5;
          at[i] = point[i] / 2 + (high ? 1 : 0);
        }
      }
      if (weight > 0.0) sum += weight * values[number_of(coarse, at)];
    }
    result.push_back(sum);
  });
  return result;
}

TYPED_TEST(Grid, CoarseOperatorsAreThoseOfTheirValuesOnTheFineGrid) {
  constexpr int D = TypeParam::D;
  const toys::RandomFluid<D> toy(300, toys::Ends::periodic, 0.3);
  using Index = typename GridShape<D>::Index;
  for (const Index& cells : {Index{2, 3}, Index{1, 4}, Index{4, 6}, Index{6, 2}})
    for (const bool bounded : {false, true}) {
      Index all = cells;
      std::array<bool, D> periodic{};
      periodic.fill(true);
      if (D == 3) all.back() = 4;
      periodic.front() = !bounded;
      GridOperator<D> a = odpd::galerkin(
          toy.resistance, GridShape<D>({}, toy.resistance.box().size, all, periodic));
      for (int level = 0; level < 2; ++level) {
        const GridOperator<D> coarse = a.coarsened();
        const PointValues<D> values = random_values(coarse.shape());
        const double exact = energy_of(a, refined(coarse.shape(), a.shape(), values));
        EXPECT_NEAR(energy_of(coarse, values), exact, 2e-5 * exact)
            << cells[0] << ' ' << cells[1] << ' ' << bounded << ' ' << level;
        a = a.coarsened();
      }
    }
}

template <int D>
std::vector<float> cycled(odpd::Multigrid<D>& grid, const std::vector<float>& b) {
  const GridShape<D>& shape = grid.finest().shape();
  std::size_t k = 0;
  odpd::for_each_point(shape, [&](const auto& point) {
    for (int c = 0; c < D; ++c) grid.b()[c * shape.pitch() + shape.number_of(point)] = b[k++];
  });
  grid.cycle();
  std::vector<float> x;
  odpd::for_each_point(shape, [&](const auto& point) {
    for (int c = 0; c < D; ++c) x.push_back(grid.x()[c * shape.pitch() + shape.number_of(point)]);
  });
  return x;
}

double inner(const std::vector<float>& a, const std::vector<float>& b) {
  double s = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k)
    s += static_cast<double>(a[k]) * static_cast<double>(b[k]);
  return s;
}

std::vector<float> random_floats(std::size_t count, std::uint64_t seed, std::size_t components) {
  std::vector<double> x = support::random_numbers(count, seed);
  const auto block = static_cast<int>(components);
  odpd::Translations{block, static_cast<std::int64_t>(count / components), block}.remove_mean(x);
  return {x.begin(), x.end()};
}

// b . V b' = b' . V b, b . V b > 0, and one cycle leaves a small part of the error.
TYPED_TEST(Grid, TheCycleIsASymmetricNearInverse) {
  constexpr int D = TypeParam::D;
  for (const toys::Ends ends : {toys::Ends::periodic, toys::Ends::walls}) {
    const toys::RandomFluid<D> toy(D == 2 ? 4000 : 6000, ends);
    odpd::Multigrid<D> grid;
    grid.set_up(odpd::galerkin(toy.resistance, grid_of(toy, 1.5)),
                toy.resistance.translations_are_null());
    const auto size = static_cast<std::size_t>(grid.finest().shape().points() * D);
    const std::vector<float> b1 = random_floats(size, 1, D), b2 = random_floats(size, 2, D);
    const std::vector<float> x1 = cycled(grid, b1), x2 = cycled(grid, b2);
    const double scale = std::sqrt(inner(b1, x1) * inner(b2, x2));
    EXPECT_GT(inner(b1, x1), 0.0);
    EXPECT_NEAR(inner(b1, x2), inner(b2, x1), 1e-4 * scale);
    // b - A V b in the energy norm of V: the rate of V-cycles as an iteration of their own.
    std::vector<float> r = b1;
    const double before = inner(r, x1);
    for (int k = 0; k < 3; ++k) {
      const std::vector<float> x = cycled(grid, r);
      const GridShape<D>& shape = grid.finest().shape();
      odpd::FloatArray in, zero, out;
      for (odpd::FloatArray* f : {&in, &zero, &out}) {
        f->resize(D * shape.pitch());
        f->fill(0.0F);
      }
      std::size_t i = 0;
      odpd::for_each_point(shape, [&](const auto& point) {
        for (int c = 0; c < D; ++c)
          in.data()[shape.margin() + c * shape.pitch() + shape.number_of(point)] = x[i++];
      });
      grid.finest().residual(zero.data(), in.data(), out.data());
      i = 0;
      odpd::for_each_point(shape, [&](const auto& point) {
        for (int c = 0; c < D; ++c)
          r[i++] += out.data()[shape.margin() + c * shape.pitch() + shape.number_of(point)];
      });
    }
    EXPECT_LT(inner(r, cycled(grid, r)), 0.05 * before)
        << "three cycles leave less than a quarter of the error, in energy";
  }
}

}  // namespace
