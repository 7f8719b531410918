// Bonds as edges: laws, place and order in the network, exclusions, errors.
#include <gtest/gtest.h>

#include <cmath>

#include "odpd/pairs/bonds.h"
#include "support/dimensions.h"
#include "support/errors.h"
#include "support/network.h"

namespace odpd {
namespace {

BondedModel<2> with_bonds(std::vector<Bond> bonds) {
  return {std::make_unique<DpdModel<2>>(1, std::vector{DpdParameters{}}), std::move(bonds)};
}

TEST(BondLaws, ForceAndStiffnessAreDerivativesOfTheEnergy) {
  for (const BondParameters& p :
       {BondParameters{.H = 12.0, .r_0 = 0.4},
        BondParameters{.law = BondLaw::fene, .H = 12.0, .r_0 = 0.4, .r_max = 0.9}})
    for (const double r : {0.1, 0.4, 0.75, 1.1}) {
      constexpr double h = 1e-5;
      const PairTerms low = bond_terms(p, r - h), at = bond_terms(p, r),
                      high = bond_terms(p, r + h);
      EXPECT_NEAR(at.f_c, -(high.u - low.u) / (2.0 * h), 1e-5);
      EXPECT_NEAR(at.k_c, -(high.f_c - low.f_c) / (2.0 * h), 1e-4 * at.k_c);
    }
  EXPECT_NEAR(bond_terms({.H = 2.0, .r_0 = 1.0}, 3.0).u, 4.0, 1e-15);
  const BondParameters fene{.law = BondLaw::fene, .H = 2.0, .r_0 = 0.0, .r_max = 2.0};
  EXPECT_NEAR(bond_terms(fene, 1.0).u, -4.0 * std::log(0.75), 1e-14);
  EXPECT_TRUE(std::isinf(bond_terms(fene, 2.0).u));
}

template <class T>
class BondEdges : public ::testing::Test {};
TYPED_TEST_SUITE(BondEdges, support::Dimensions);

TYPED_TEST(BondEdges, FollowThePairsAndTheIdentities) {
  constexpr int D = TypeParam::D;
  support::Fluid<D> fluid(4.0, true, 150, 3);
  // Across the boundary, beyond the cutoff; on one particle several.
  fluid.particles.position[7] = support::uniform_vec<D>(0.1);
  fluid.particles.position[9] = support::uniform_vec<D>(0.1);
  fluid.particles.position[9][0] = 2.8;
  fluid.particles.position[0] = support::uniform_vec<D>(0.5);
  fluid.particles.position[149] = support::uniform_vec<D>(3.9);
  std::vector<Bond> bonds{{7, 9, {.H = 3.0, .r_0 = 0.5}},
                          {9, 0, {.H = 4.0, .r_0 = 0.6}},
                          {149, 7, {.H = 5.0, .r_0 = 0.7}}};
  const DpdModel<D> pairs(1, {DpdParameters{}});
  const BondedModel<D> model(std::make_unique<DpdModel<D>>(1, std::vector{DpdParameters{}}), bonds);
  for (int round = 0; round < 3; ++round) {
    fluid.connect(pairs);
    const PairNetwork<D> plain = fluid.network;
    EXPECT_EQ(plain.bonds, 0);
    fluid.connect(model);
    const PairNetwork<D>& n = fluid.network;
    ASSERT_EQ(n.size(), plain.size() + 3);
    EXPECT_EQ(n.pairs(), plain.size());
    for (std::size_t k = 0; k < static_cast<std::size_t>(plain.size()); ++k) {
      EXPECT_EQ(n.u[k], plain.u[k]);
      EXPECT_EQ(n.f_c[k], plain.f_c[k]);
      EXPECT_EQ(n.k_c[k], plain.k_c[k]);
      EXPECT_EQ(n.kT[k], plain.kT[k]);
      EXPECT_EQ(n.zeta_par[k], plain.zeta_par[k]);
    }
    for (std::size_t b = 0; b < 3; ++b) {
      const auto k = static_cast<std::size_t>(plain.size()) + b;
      const auto i = static_cast<std::size_t>(n.i[k]), j = static_cast<std::size_t>(n.j[k]);
      EXPECT_EQ(fluid.particles.id[i], bonds[b].i);
      EXPECT_EQ(fluid.particles.id[j], bonds[b].j);
      const Vec<D> d =
          fluid.box.separation(fluid.particles.position[i], fluid.particles.position[j]);
      EXPECT_NEAR(norm(n.r[k] * n.e[k] - d), 0.0, 1e-12);
      EXPECT_EQ(n.f_c[k], bond_terms(bonds[b].p, n.r[k]).f_c);
      EXPECT_EQ(n.k_c[k], bonds[b].p.H);
      EXPECT_EQ(n.zeta_par[k], 0.0);
      EXPECT_EQ(n.zeta_perp[k], 0.0);
      EXPECT_EQ(n.kT[k], 1.0);
    }
    const auto first = static_cast<std::size_t>(plain.size());
    EXPECT_NEAR(n.r[first], 1.3, 1e-12);
    EXPECT_NEAR(n.e[first][0], 1.0, 1e-12);
    PairNetwork<D> again = n;
    again.index_edges();
    EXPECT_EQ(n.start, again.start);
    EXPECT_EQ(n.edge, again.edge);
    fluid.particles.reorder(support::random_order(150, static_cast<std::uint32_t>(round + 1)));
  }
}

TYPED_TEST(BondEdges, ExcludeWhatTheyReplace) {
  constexpr int D = TypeParam::D;
  support::Fluid<D> fluid(4.0, true, 100, 3);
  fluid.particles.position[5] = fluid.particles.position[70] + support::uniform_vec<D>(0.2);
  fluid.box.wrap(fluid.particles.position[5]);
  const DpdModel<D> pairs(1, {DpdParameters{}});
  fluid.connect(pairs);
  const PairNetwork<D> plain = fluid.network;
  for (const BondExclusion exclude :
       {BondExclusion::repulsion, BondExclusion::all, BondExclusion::none}) {
    const BondedModel<D> model(std::make_unique<DpdModel<D>>(1, std::vector{DpdParameters{}}),
                               {{70, 5, {.H = 9.0, .r_0 = 0.2, .exclude = exclude}}});
    fluid.connect(model);
    const PairNetwork<D>& n = fluid.network;
    int found = 0;
    for (std::size_t k = 0; k < static_cast<std::size_t>(n.pairs()); ++k) {
      const bool bonded = n.i[k] == 5 && n.j[k] == 70;
      const bool soft = bonded && exclude != BondExclusion::none;
      found += bonded ? 1 : 0;
      EXPECT_EQ(n.u[k], soft ? 0.0 : plain.u[k]);
      EXPECT_EQ(n.f_c[k], soft ? 0.0 : plain.f_c[k]);
      EXPECT_EQ(n.k_c[k], soft ? 0.0 : plain.k_c[k]);
      EXPECT_EQ(n.zeta_par[k], bonded && exclude == BondExclusion::all ? 0.0 : plain.zeta_par[k]);
    }
    EXPECT_EQ(found, 1);
  }
  // The columns that were constant are so again.
  fluid.connect(pairs);
  EXPECT_EQ(fluid.network.k_c, plain.k_c);
}

TEST(BondErrors, NameTheParticles) {
  const auto refused = [](const Bond& bond, std::initializer_list<const char*> parts) {
    support::expect_error<ConfigError>([&] { with_bonds({bond}); }, parts);
  };
  refused({3, 3, {.H = 1.0}}, {"3 and 3"});
  refused({3, 4, {.H = 0.0}}, {"particles 3 and 4", "H = 0"});
  refused({3, 4, {.H = 1.0, .r_0 = -1.0}}, {"r_0 = -1"});
  refused({3, 4, {.law = BondLaw::fene, .H = 1.0}}, {"r_max = 0"});
  support::expect_error<ConfigError>(
      [] {
        with_bonds({{3, 4, {.H = 1.0}}, {4, 3, {.H = 1.0}}});
      },
      {"bonded twice", "3", "4"});
  support::Fluid<2> fluid(4.0, true, 20, 3);
  fluid.particles.position[3] = {{1.0, 1.0}};
  fluid.particles.position[4] = {{1.0, 2.5}};
  support::expect_error<ConfigError>(
      [&] {
        fluid.connect(with_bonds({{3, 20, {.H = 1.0}}}));
      },
      {"particle 20", "20 particles"});
  support::expect_error<BlowUpError>(
      [&] {
        fluid.connect(
            with_bonds({{3, 4, {.law = BondLaw::fene, .H = 1.0, .r_0 = 0.5, .r_max = 1.0}}}));
      },
      {"particles 3 and 4", "1.5 long", "integrator.dt", "r_max"});
  fluid.particles.position[4] = {{2.9, 2.9}};
  support::expect_error<BondTooLongError>(
      [&] {
        fluid.connect(with_bonds({{3, 4, {.H = 1.0}}}));
      },
      {"particles 3 and 4", "half the shortest periodic edge", "a larger box, a larger H"});
}

}  // namespace
}  // namespace odpd
