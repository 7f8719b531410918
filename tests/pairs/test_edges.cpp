#include <gtest/gtest.h>

#include <map>
#include <set>
#include <tuple>

#include "odpd/core/parallel.h"
#include "odpd/pairs/edge_writer.h"
#include "support/dimensions.h"
#include "support/network.h"

namespace {

using odpd::DpdModel;
using odpd::DpdParameters;
using odpd::PairNetwork;
using odpd::Vec;
using support::Fluid;

template <int D>
DpdModel<D> two_species() {
  DpdParameters aa, ab, bb;
  aa.gamma_perp = 1.0;
  ab.a = 40.0;
  bb.gamma = 9.0;
  bb.cutoff = 0.7;
  return DpdModel<D>(2, {aa, ab, ab, bb});
}

// What an edge says of its pair, by identities and seen from the lower one.
template <int D>
struct Seen {
  Vec<D> e;
  std::array<double, 7> numbers;
  bool operator==(const Seen&) const = default;
};

template <int D>
std::map<std::pair<std::int64_t, std::int64_t>, Seen<D>> by_identity(const Fluid<D>& fluid) {
  std::map<std::pair<std::int64_t, std::int64_t>, Seen<D>> edges;
  const PairNetwork<D>& n = fluid.network;
  for (std::size_t k = 0; k < static_cast<std::size_t>(n.size()); ++k) {
    const auto i = fluid.particles.id[static_cast<std::size_t>(n.i[k])];
    const auto j = fluid.particles.id[static_cast<std::size_t>(n.j[k])];
    const Seen<D> seen{
        (i < j ? 1.0 : -1.0) * n.e[k],
        {n.r[k], n.u[k], n.f_c[k], n.k_c[k], n.zeta_par[k], n.zeta_perp[k], n.kT[k]}};
    EXPECT_TRUE(edges.emplace(std::minmax(i, j), seen).second) << "an edge twice";
  }
  return edges;
}

template <class T>
class EdgesTest : public ::testing::Test {};
TYPED_TEST_SUITE(EdgesTest, support::Dimensions);

// Of those that may move relative to each other: not two of known velocity, nor two of one body. With and without a skin.
TYPED_TEST(EdgesTest, OneEdgeForEveryPairThatMoves) {
  constexpr int D = TypeParam::D;
  Fluid<D> fluid(3.3, true, D == 2 ? 60 : 120, 5, 1.2);
  const auto& r = fluid.particles.position;
  std::vector<std::int32_t> body(r.size(), -1);
  for (std::size_t i = 0; i < r.size(); i += 2) {
    if (!fluid.particles.is_free(i)) continue;
    body[i] = static_cast<std::int32_t>(i / 20);
    fluid.particles.group[i] = odpd::Group::free_body(body[i]);
  }
  const DpdModel<D> model(1, {DpdParameters{}});
  std::set<std::pair<std::int32_t, std::int32_t>> expected;
  std::int64_t known_pairs = 0, inner_pairs = 0;
  for (std::size_t i = 0; i < r.size(); ++i) {
    for (std::size_t j = i + 1; j < r.size(); ++j) {
      if (!(norm(fluid.box.separation(r[i], r[j])) < 1.0)) continue;
      if (fluid.particles.is_known(i) && fluid.particles.is_known(j)) {
        ++known_pairs;
      } else if (body[i] >= 0 && body[i] == body[j]) {
        ++inner_pairs;
      } else {
        expected.emplace(static_cast<std::int32_t>(i), static_cast<std::int32_t>(j));
      }
    }
  }
  ASSERT_GT(known_pairs, 0) << "edges between known particles must be there to be left out";
  ASSERT_GT(inner_pairs, 0);
  const PairNetwork<D>& n = fluid.network;
  for (const double skin : {0.3, 0.0}) {
    fluid.connect(model, skin);
    std::vector<std::pair<std::int32_t, std::int32_t>> found;
    for (std::size_t k = 0; k < static_cast<std::size_t>(n.size()); ++k) {
      found.emplace_back(n.i[k], n.j[k]);
      const auto i = static_cast<std::size_t>(n.i[k]), j = static_cast<std::size_t>(n.j[k]);
      const Vec<D> d = fluid.box.separation(r[i], r[j]);
      EXPECT_DOUBLE_EQ(n.r[k], norm(d));
      EXPECT_NEAR(norm(n.r[k] * n.e[k] - d), 0.0, 1e-15) << "e points from j to i";
      EXPECT_EQ(n.f_c[k], model.pair(n.r[k], {}, {}).f_c);
    }
    EXPECT_EQ(found, decltype(found)(expected.begin(), expected.end())) << "ordered by (i, j)";
  }
  EXPECT_EQ(n.particles, fluid.particles.size());
  EXPECT_FALSE(n.transverse);
}

// A colloid reaches far; the fluid's particles have no edges beyond their own cutoff.
TYPED_TEST(EdgesTest, EachPairOfSpeciesReachesAsFarAsItsOwnCutoff) {
  constexpr int D = TypeParam::D;
  Fluid<D> fluid(4.0, true, D == 2 ? 90 : 250, 9);
  for (std::size_t i = 0; i < fluid.particles.species.size(); i += 9)
    fluid.particles.species[i] = 1;
  DpdParameters aa, ab, bb;
  aa.cutoff = 0.8;
  ab.cutoff = 1.3;
  bb.cutoff = 1.6;
  const DpdModel<D> model(2, {aa, ab, ab, bb});
  const auto& r = fluid.particles.position;
  std::vector<std::pair<std::int32_t, std::int32_t>> expected;
  for (std::size_t i = 0; i < r.size(); ++i)
    for (std::size_t j = i + 1; j < r.size(); ++j) {
      const int colloids = fluid.particles.species[i] + fluid.particles.species[j];
      const double reach = colloids == 0 ? 0.8 : colloids == 1 ? 1.3 : 1.6;
      if (fluid.particles.is_known(i) && fluid.particles.is_known(j)) continue;
      if (norm(fluid.box.separation(r[i], r[j])) < reach)
        expected.emplace_back(static_cast<std::int32_t>(i), static_cast<std::int32_t>(j));
    }
  for (const double skin : {0.3, 0.0}) {
    fluid.connect(model, skin);
    std::vector<std::pair<std::int32_t, std::int32_t>> found;
    for (std::size_t k = 0; k < static_cast<std::size_t>(fluid.network.size()); ++k)
      found.emplace_back(fluid.network.i[k], fluid.network.j[k]);
    EXPECT_EQ(found, expected);
  }
}

TYPED_TEST(EdgesTest, TheIndexNamesTheEdgesOfEachParticle) {
  constexpr int D = TypeParam::D;
  Fluid<D> fluid(3.0, true, 80, 6, 0.5);
  fluid.connect(DpdModel<D>(1, {DpdParameters{}}));
  const PairNetwork<D>& n = fluid.network;
  std::int64_t incidences = 0;
  for (std::int32_t p = 0; p < 80; ++p) {
    std::vector<std::int32_t> expected;
    for (std::int32_t k = 0; k < static_cast<std::int32_t>(n.size()); ++k) {
      if (n.i[static_cast<std::size_t>(k)] == p || n.j[static_cast<std::size_t>(k)] == p) {
        expected.push_back(k);
      }
    }
    const auto edges = n.edges_of(p);
    EXPECT_EQ(std::vector<std::int32_t>(edges.begin(), edges.end()), expected);
    incidences += static_cast<std::int64_t>(edges.size());
  }
  EXPECT_EQ(incidences, 2 * n.size());
  EXPECT_GT(n.bytes(), 0);
}

TYPED_TEST(EdgesTest, DoNotDependOnTheOrderInMemory) {
  constexpr int D = TypeParam::D;
  Fluid<D> fluid(3.4, true, 150, 7, 0.5);
  for (std::size_t i = 0; i < 150; i += 3) fluid.particles.species[i] = 1;
  const DpdModel<D> model = two_species<D>();
  fluid.connect(model);
  EXPECT_TRUE(fluid.network.transverse);
  const auto before = by_identity(fluid);
  EXPECT_GT(before.size(), 100u);
  fluid.particles.reorder(support::random_order(150, 8));
  fluid.connect(model);
  EXPECT_EQ(by_identity(fluid), before);
}

TYPED_TEST(EdgesTest, HaveTheSameBitsOnAnyThreadCountAndSkin) {
  constexpr int D = TypeParam::D;
  Fluid<D> fluid(D == 2 ? 15.0 : 6.0, true, 900, 7);
  const DpdModel<D> model = two_species<D>();
  fluid.connect(model);
  const PairNetwork<D> one = fluid.network;
  for (const int threads : {1, 2, 3}) {
    odpd::set_threads(threads, 0);
    fluid.connect(model, 0.2 * (threads - 1));
    odpd::set_threads(1, 0);
    EXPECT_EQ(fluid.network.i, one.i);
    EXPECT_EQ(fluid.network.j, one.j);
    EXPECT_EQ(fluid.network.e, one.e);
    EXPECT_EQ(fluid.network.f_c, one.f_c);
    EXPECT_EQ(fluid.network.zeta_par, one.zeta_par);
    EXPECT_EQ(fluid.network.edge, one.edge);
  }
}

// Every exponent that has a kernel, and some that have none, with and without the rest of the model; the network is used again
// and again, as in a run, so that what one model leaves must not show in the next.
TYPED_TEST(EdgesTest, CarryTheTermsOfThePairModel) {
  constexpr int D = TypeParam::D;
  Fluid<D> fluid(3.3, true, D == 2 ? 61 : 121, 5, 0.6);
  for (const double s : {0.5, 1.0, 2.0, 0.0, 0.7})
    for (const double s_bar : {0.5, 1.0, 2.0, 1.5})
      for (int rest = 0; rest < 8; ++rest) {
        DpdParameters p;
        p.s = s;
        p.s_bar = s_bar;
        p.cutoff = 1.1;
        p.kT = 0.7;
        p.gamma_perp = rest % 2 == 1 ? 1.3 : 0.0;
        p.gamma_far = rest / 2 % 2 == 1 ? 0.2 : 0.0;
        p.cutoff_far = 1.5;
        p.a = rest / 4 == 1 ? 0.0 : 18.5;
        const DpdModel<D> model(1, {p});
        fluid.connect(model, 0.0);
        const PairNetwork<D>& n = fluid.network;
        EXPECT_EQ(n.transverse, p.gamma_perp > 0.0);
        ASSERT_GT(n.size(), 100);
        for (std::size_t k = 0; k < static_cast<std::size_t>(n.size()); ++k) {
          const odpd::PairTerms t = model.pair(n.r[k], {}, {});
          const auto expect_near = [](double value, double expected) {
            // 1 - r/r_c loses digits at the cutoff.
            EXPECT_NEAR(value, expected, 1e-7 * std::abs(expected) + 1e-13);
          };
          expect_near(n.u[k], t.u);
          expect_near(n.f_c[k], t.f_c);
          expect_near(n.k_c[k], t.k_c);
          expect_near(n.zeta_par[k], t.zeta_par);
          expect_near(n.zeta_perp[k], t.zeta_perp);
          EXPECT_EQ(n.kT[k], t.kT);
        }
      }
}

TYPED_TEST(EdgesTest, AnExactOverlapHasAFixedFiniteDirection) {
  constexpr int D = TypeParam::D;
  const Vec<D> first = odpd::overlap_direction<D>(3, 8);
  EXPECT_NEAR(norm(first), 1.0, 1e-15);
  EXPECT_EQ(first, -1.0 * odpd::overlap_direction<D>(8, 3));
  EXPECT_NE(first, odpd::overlap_direction<D>(3, 9));

  Fluid<D> fluid(4.0, true);
  for (int k = 0; k < 4; ++k) fluid.particles.add(support::uniform_vec<D>(1.0), 0);
  fluid.particles.position[3][0] = 1.0 + 1e-170;  // the square of this distance is zero
  const DpdModel<D> model(1, {DpdParameters{}});
  fluid.connect(model);
  ASSERT_EQ(fluid.network.size(), 6);
  for (std::size_t k = 0; k < 6; ++k) {
    EXPECT_EQ(fluid.network.r[k], 0.0);
    EXPECT_NEAR(norm(fluid.network.e[k]), 1.0, 1e-15);
    for (const double value : {fluid.network.u[k], fluid.network.f_c[k], fluid.network.k_c[k]}) {
      EXPECT_TRUE(std::isfinite(value));
      EXPECT_GT(value, 0.0);
    }
  }
  const auto before = by_identity(fluid);
  for (std::uint32_t seed = 0; seed < 5; ++seed) {
    fluid.particles.reorder(support::random_order(4, seed));
    fluid.connect(model);
    EXPECT_EQ(by_identity(fluid), before);
  }
}

TYPED_TEST(EdgesTest, FarFrictionJoinsParticlesBeyondTheCutoff) {
  constexpr int D = TypeParam::D;
  Fluid<D> fluid(6.0, true);
  fluid.particles.add(support::uniform_vec<D>(1.0), 0);
  fluid.particles.add(support::uniform_vec<D>(1.0), 0);
  fluid.particles.position[1][0] = 2.5;
  DpdParameters p;
  fluid.connect(DpdModel<D>(1, {p}));
  EXPECT_EQ(fluid.network.size(), 0);
  p.gamma_far = 0.1;
  p.cutoff_far = 2.0;
  fluid.connect(DpdModel<D>(1, {p}));
  ASSERT_EQ(fluid.network.size(), 1);
  EXPECT_NEAR(fluid.network.zeta_par[0], 0.1 * std::sqrt(0.25), 1e-15);
  EXPECT_EQ(fluid.network.f_c[0], 0.0);
  EXPECT_EQ(fluid.network.kT[0], p.kT) << "far friction carries its noise";
}

}  // namespace
