#include <gtest/gtest.h>

#include "odpd/core/parallel.h"
#include "odpd/operator/resistance.h"
#include "support/dimensions.h"
#include "support/network.h"

namespace {

using odpd::BlockCsr;
using odpd::DofMap;
using odpd::DpdModel;
using odpd::DpdParameters;
using odpd::PairNetwork;
using odpd::Resistance;
using odpd::Vec;
using support::Fluid;

enum class Friction { central, transverse, mostly_transverse };

DpdParameters parameters(Friction friction) {
  DpdParameters p;
  if (friction == Friction::transverse) p.gamma_perp = 1.5;
  if (friction == Friction::mostly_transverse) p.gamma_perp = 7.0;  // more than gamma
  return p;
}

std::vector<double> product(const odpd::System& system, const std::vector<double>& x) {
  std::vector<double> y(x.size(), -99.0);
  system.apply(x, y);
  return y;
}

std::vector<double> times(const std::vector<double>& matrix, const std::vector<double>& x) {
  std::vector<double> y(x.size(), 0.0);
  for (std::size_t r = 0; r < x.size(); ++r) {
    for (std::size_t c = 0; c < x.size(); ++c) y[r] += matrix[r * x.size() + c] * x[c];
  }
  return y;
}

std::vector<double> dense(const BlockCsr& a) {
  const auto b = static_cast<std::size_t>(a.block), n = static_cast<std::size_t>(a.rows) * b;
  std::vector<double> matrix(n * n, 0.0);
  for (std::size_t row = 0; row < static_cast<std::size_t>(a.rows); ++row) {
    for (auto k = static_cast<std::size_t>(a.start[row]);
         k < static_cast<std::size_t>(a.start[row + 1]); ++k) {
      const auto column = static_cast<std::size_t>(a.column[k]);
      if (k > static_cast<std::size_t>(a.start[row])) {
        EXPECT_LT(a.column[k - 1], a.column[k]) << "columns must ascend";
      }
      for (std::size_t e = 0; e < b * b; ++e) {
        matrix[(row * b + e / b) * n + column * b + e % b] = a.value[k * b * b + e];
      }
    }
  }
  return matrix;
}

void expect_near(const std::vector<double>& a, const std::vector<double>& b, double bound) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t k = 0; k < a.size(); ++k) EXPECT_NEAR(a[k], b[k], bound) << "entry " << k;
}

// apply, the assembled matrix and the block diagonal against the definition, for one network.
template <int D>
void expect_definition(const Fluid<D>& fluid, double shift) {
  const DofMap<D> dofs(fluid.particles);
  Resistance<D> resistance(fluid.box);
  resistance.rebuild(fluid.network, dofs, fluid.particles, fluid.particles.position, shift);
  const auto definition = support::dense_resistance(fluid.network, dofs, shift);
  const auto n = static_cast<std::size_t>(dofs.unknowns());
  ASSERT_EQ(resistance.size(), dofs.unknowns());
  const auto x = support::random_numbers(n, 12);
  expect_near(product(resistance, x), times(definition, x), 1e-12);
  expect_near(dense(resistance.matrix()), definition, 1e-12);
  std::vector<double> blocks(n * D, -99.0);
  resistance.block_diagonal(blocks);
  for (std::size_t node = 0; node < n / D; ++node) {
    for (std::size_t e = 0; e < D * D; ++e) {
      const std::size_t row = node * D + e / D, column = node * D + e % D;
      EXPECT_NEAR(blocks[node * D * D + e], definition[row * n + column], 1e-12);
    }
  }
}

template <class T>
class ResistanceTest : public ::testing::Test {};
TYPED_TEST_SUITE(ResistanceTest, support::Dimensions);

TYPED_TEST(ResistanceTest, IsTheSumOverEdges) {
  constexpr int D = TypeParam::D;
  for (const Friction friction :
       {Friction::central, Friction::transverse, Friction::mostly_transverse}) {
    Fluid<D> fluid(3.0, true, D == 2 ? 70 : 130, 1, 0.8);
    fluid.connect(DpdModel<D>(1, {parameters(friction)}));
    for (const double shift : {0.0, 3.7}) expect_definition(fluid, shift);
  }
}

// A bead chain or a special contact may give several edges to one pair of nodes.
TYPED_TEST(ResistanceTest, SeveralEdgesMayJoinTheSameNodes) {
  constexpr int D = TypeParam::D;
  Fluid<D> fluid(2.5, true, 40, 4);
  fluid.connect(DpdModel<D>(1, {parameters(Friction::transverse)}));
  PairNetwork<D>& n = fluid.network;
  const auto edges = static_cast<std::size_t>(n.size());
  n.resize(n.size() + 6);
  for (std::size_t k = 0; k < 6; ++k) {
    const std::size_t from = 3 * (k / 2);  // three edges, each doubled twice
    n.i[edges + k] = n.j[from];            // and the other way round
    n.j[edges + k] = n.i[from];
    Vec<D> e{};
    e[static_cast<int>(k) % D] = 1.0;
    n.e[edges + k] = e;
    n.zeta_par[edges + k] = 2.0 + static_cast<double>(k);
    n.zeta_perp.each()[edges + k] = 0.5;
  }
  n.index_edges();
  expect_definition(fluid, 0.0);
  const DofMap<D> dofs(fluid.particles);
  Resistance<D> resistance(fluid.box);
  resistance.rebuild(n, dofs, fluid.particles, fluid.particles.position, 0.0);
  EXPECT_EQ(resistance.matrix().column.size(), 40 + 2 * edges) << "one block per pair of nodes";
}

TYPED_TEST(ResistanceTest, KnowsItsNullSpace) {
  constexpr int D = TypeParam::D;
  const DpdModel<D> model(1, {DpdParameters{}});
  for (const bool hold : {false, true}) {
    Fluid<D> periodic(3.0, true, 130, 4);
    periodic.connect(model);
    Resistance<D> resistance(periodic.box, hold);
    const auto rebuild = [&](const Fluid<D>& fluid, double shift) {
      resistance.rebuild(fluid.network, DofMap<D>(fluid.particles), fluid.particles,
                         fluid.particles.position, shift);
    };
    rebuild(periodic, 0.0);
    EXPECT_TRUE(resistance.translations_are_null());
    EXPECT_FALSE(resistance.holds_centre_of_mass()) << "nothing to hold in the null space";
    EXPECT_TRUE(resistance.projected());
    EXPECT_EQ(resistance.periodic_directions(), D);
    EXPECT_EQ(resistance.positions().size(), 130u * D);
    EXPECT_EQ(resistance.positions()[D], periodic.particles.position[1][0]);
    const auto before = resistance.generation();
    rebuild(periodic, 1.0);
    EXPECT_NE(resistance.generation(), before);
    EXPECT_FALSE(resistance.translations_are_null()) << "a shift makes it definite";
    EXPECT_EQ(resistance.holds_centre_of_mass(), hold);
    Fluid<D> anchored(3.0, true, 130, 4, 0.6);
    anchored.connect(model);
    rebuild(anchored, 0.0);
    EXPECT_FALSE(resistance.translations_are_null());
    EXPECT_EQ(resistance.holds_centre_of_mass(), hold);
    EXPECT_EQ(resistance.projected(), hold);
  }
}

TYPED_TEST(ResistanceTest, HasTheSameBitsOnAnyThreadCount) {
  constexpr int D = TypeParam::D;
  Fluid<D> fluid(D == 2 ? 16.0 : 7.0, true, 1300, 2, 0.5);
  fluid.connect(DpdModel<D>(1, {parameters(Friction::transverse)}));
  const DofMap<D> dofs(fluid.particles);
  ASSERT_GT(dofs.nodes(), 1000) << "enough nodes for threads to share";
  const auto x = support::random_numbers(static_cast<std::size_t>(dofs.unknowns()), 1);
  std::vector<double> first_y, first_blocks, first_values;
  for (const int threads : {1, 2, 3}) {
    odpd::set_threads(threads, 0);
    Resistance<D> resistance(fluid.box);
    resistance.rebuild(fluid.network, dofs, fluid.particles, fluid.particles.position, 1.0);
    const auto y = product(resistance, x);
    std::vector<double> blocks(x.size() * D);
    resistance.block_diagonal(blocks);
    const auto values = resistance.matrix().value;
    odpd::set_threads(1, 0);
    if (threads == 1) {
      first_y = y;
      first_blocks = blocks;
      first_values = values;
    }
    EXPECT_EQ(y, first_y);
    EXPECT_EQ(blocks, first_blocks);
    EXPECT_EQ(values, first_values);
  }
}

}  // namespace
