// Edges in three phases: densities, terms and energy of a toy against sums over all pairs, exclusions, threads.
#include <gtest/gtest.h>

#include "odpd/core/parallel.h"
#include "odpd/pairs/bonds.h"
#include "odpd/pairs/dpd.h"
#include "support/density_toy.h"
#include "support/dimensions.h"

namespace {

using odpd::Derivatives;
using odpd::Vec;
using support::Crowd;
using support::ToyModel;
using support::ToyParameters;

template <class T>
class DensitiesTest : public ::testing::Test {};
TYPED_TEST_SUITE(DensitiesTest, support::Dimensions);

constexpr ToyParameters both_parts{.c = 0.8, .pair = 3.0, .gamma = 4.5, .crowding = 0.1};

// Walls and bodies among them, so that many a partner is not on an edge.
TYPED_TEST(DensitiesTest, AreSumsOverAllPartners) {
  constexpr int D = TypeParam::D;
  Crowd<D> crowd(D == 2 ? 70 : 150);
  const ToyModel<D> model(both_parts);
  const std::vector<double> expected = crowd.densities(model);
  for (const double skin : {0.0, 0.3}) {
    crowd.connect(model, skin);
    ASSERT_EQ(crowd.network.densities.d.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i)
      EXPECT_NEAR(crowd.network.densities.d[i], expected[i], 1e-13 * expected[i]);
    EXPECT_NEAR(crowd.network.energy(), crowd.energy(model), 1e-12 * crowd.energy(model));
  }
  // Without the pairs that are no edges they would be far from that.
  std::vector<double> edges_only(expected.size(), 1.0);
  for (std::size_t k = 0; k < crowd.network.i.size(); ++k)
    for (const std::int32_t p : {crowd.network.i[k], crowd.network.j[k]})
      edges_only[static_cast<std::size_t>(p)] += crowd.network.densities.W[k];
  std::array<int, 3> short_of{};  // walls, constituents of the free body, of the known one
  for (std::size_t i = 0; i < expected.size(); ++i) {
    if (!(edges_only[i] < expected[i] - 0.1)) continue;
    EXPECT_FALSE(crowd.particles.is_free(i));
    ++short_of[crowd.particles.body_of(i) < 0 ? 0 : crowd.particles.is_known(i) ? 2 : 1];
  }
  EXPECT_GT(short_of[0], 5);
  EXPECT_GT(short_of[1], D);
  EXPECT_GT(short_of[2], D);
}

TYPED_TEST(DensitiesTest, GiveEdgesTheForcesOfBothEnds) {
  constexpr int D = TypeParam::D;
  Crowd<D> crowd(D == 2 ? 70 : 150);
  const ToyModel<D> model(both_parts);
  crowd.connect(model);
  const auto& n = crowd.network;
  const std::vector<double> d = crowd.densities(model);
  ASSERT_GT(n.size(), 100);
  for (std::size_t k = 0; k < n.i.size(); ++k) {
    const auto i = static_cast<std::size_t>(n.i[k]), j = static_cast<std::size_t>(n.j[k]);
    ASSERT_FALSE(crowd.rigid(i, j));
    const odpd::Site site_i = site_of(crowd.particles, i, d[i]),
                     site_j = site_of(crowd.particles, j, d[j]);
    const Derivatives w = model.densities()->weight(n.r[k], site_i, site_j);
    const double slope =
        model.densities()->energy(site_i).first + model.densities()->energy(site_j).first;
    const odpd::PairTerms t = model.pair(n.r[k], site_i, site_j);
    EXPECT_EQ(n.u[k], t.u);
    EXPECT_NEAR(n.f_c[k], t.f_c - slope * w.first, 1e-11);
    EXPECT_NEAR(n.k_c[k], t.k_c + slope * w.second, 1e-10);
    EXPECT_NEAR(n.zeta_par[k], t.zeta_par, 1e-12 * t.zeta_par) << "friction at the densities";
    EXPECT_GT(t.zeta_par, model.pair(n.r[k], {}, {}).zeta_par);
  }
}

TYPED_TEST(DensitiesTest, HaveTheSameBitsOnAnyThreadCount) {
  constexpr int D = TypeParam::D;
  Crowd<D> crowd(D == 2 ? 900 : 1400, D == 2 ? 12.0 : 6.0);
  const ToyModel<D> model(both_parts);
  crowd.connect(model);
  const odpd::PairNetwork<D> one = crowd.network;
  for (const int threads : {1, 2, 4}) {
    odpd::set_threads(threads, 0);
    crowd.connect(model, 0.1 * (threads - 1));
    odpd::set_threads(1, 0);
    EXPECT_EQ(crowd.network.densities.d, one.densities.d);
    EXPECT_EQ(crowd.network.densities.psi, one.densities.psi);
    EXPECT_EQ(crowd.network.f_c, one.f_c);
    EXPECT_EQ(crowd.network.k_c, one.k_c);
    EXPECT_EQ(crowd.network.zeta_par, one.zeta_par);
    EXPECT_EQ(crowd.network.energy(), one.energy());
  }
}

TYPED_TEST(DensitiesTest, LeaveNothingInTheNetworkOfAnotherModel) {
  constexpr int D = TypeParam::D;
  Crowd<D> crowd(70);
  const odpd::DpdModel<D> plain(2, std::vector<odpd::DpdParameters>(4));
  crowd.connect(plain);
  const double energy = crowd.network.energy();
  EXPECT_EQ(energy, crowd.network.u.sum());
  EXPECT_TRUE(crowd.network.densities.empty());
  EXPECT_EQ(crowd.network.densities.bytes(), 0);
  crowd.connect(ToyModel<D>(both_parts));
  EXPECT_GT(crowd.network.densities.bytes(), 0);
  crowd.connect(plain);
  EXPECT_TRUE(crowd.network.densities.empty());
  EXPECT_EQ(crowd.network.densities.bytes(), 0);
  EXPECT_EQ(crowd.network.energy(), energy);
}

// What a bonded pair loses is its own terms; it stays in the densities, and so does their force on it.
TYPED_TEST(DensitiesTest, KeepBondedNeighbours) {
  constexpr int D = TypeParam::D;
  Crowd<D> crowd(70, 3.2, true);
  const auto index = crowd.particles.index_of_id();
  const auto a = static_cast<std::size_t>(index[3]), b = static_cast<std::size_t>(index[8]);
  crowd.particles.position[b] = crowd.particles.position[a] + support::uniform_vec<D>(0.25);
  crowd.box.wrap(crowd.particles.position[b]);
  const ToyModel<D> pairs(both_parts);
  for (const auto exclude : {odpd::BondExclusion::repulsion, odpd::BondExclusion::all}) {
    const odpd::BondedModel<D> model(std::make_unique<ToyModel<D>>(both_parts),
                                     {{3, 8, {.H = 7.0, .r_0 = 0.2, .exclude = exclude}}});
    ASSERT_NE(model.densities(), nullptr);
    crowd.connect(pairs);
    const odpd::PairNetwork<D> without = crowd.network;
    crowd.connect(model);
    const odpd::PairNetwork<D>& with = crowd.network;
    EXPECT_EQ(with.densities.d, without.densities.d);
    ASSERT_EQ(with.size(), without.size() + 1);
    int excluded = 0;
    for (std::size_t k = 0; k < without.i.size(); ++k) {
      const odpd::PairTerms t =
          pairs.pair(with.r[k], site_of(crowd.particles, a, with.densities.d[a]),
                     site_of(crowd.particles, b, with.densities.d[b]));
      if (std::minmax(with.i[k], with.j[k]) !=
          std::minmax(static_cast<std::int32_t>(a), static_cast<std::int32_t>(b))) {
        EXPECT_EQ(with.f_c[k], without.f_c[k]);
        continue;
      }
      ++excluded;
      EXPECT_GT(t.u, 0.0);
      EXPECT_EQ(with.u[k], 0.0);
      EXPECT_NEAR(with.f_c[k], without.f_c[k] - t.f_c, 1e-11);
      EXPECT_NEAR(with.k_c[k], without.k_c[k] - t.k_c, 1e-10);
      EXPECT_EQ(with.zeta_par[k], exclude == odpd::BondExclusion::all ? 0.0 : without.zeta_par[k]);
    }
    EXPECT_EQ(excluded, 1);
  }
}

}  // namespace
