#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "odpd/core/error.h"
#include "odpd/pairs/dpd.h"
#include "support/errors.h"

namespace {

using odpd::DpdModel;
using odpd::DpdParameters;
using odpd::PairTerms;
using odpd::Site;

DpdParameters standard() {
  DpdParameters p;
  p.a = 18.5;
  p.s_bar = 1.5;
  p.gamma = 4.5;
  p.gamma_perp = 1.25;
  p.s = 0.5;
  p.cutoff = 1.2;
  p.kT = 0.8;
  return p;
}

PairTerms terms(const DpdParameters& p, double r) {
  return DpdModel<2>(1, {p}).pair(r, Site{0}, Site{0});
}

TEST(Dpd, TermsFollowTheFormulas) {
  const DpdParameters p = standard();
  for (const double r : {0.0, 0.1, 0.6, 1.1, 1.1999}) {
    const double x = 1.0 - r / p.cutoff;
    const PairTerms t = terms(p, r);
    EXPECT_NEAR(t.f_c, p.a * std::pow(x, 1.5), 1e-13);
    EXPECT_NEAR(t.u, p.a * p.cutoff / 2.5 * std::pow(x, 2.5), 1e-13);
    EXPECT_NEAR(t.k_c, p.a * 1.5 / p.cutoff * std::pow(x, 0.5), 1e-13);
    EXPECT_NEAR(t.zeta_par, p.gamma * std::sqrt(x), 1e-13);
    EXPECT_NEAR(t.zeta_perp, p.gamma_perp * std::sqrt(x), 1e-13);
    EXPECT_EQ(t.kT, p.kT);
  }
}

TEST(Dpd, NothingActsFromTheCutoffOn) {
  for (const double r : {1.2, 1.3, 50.0}) {
    const PairTerms t = terms(standard(), r);
    for (const double value : {t.u, t.f_c, t.k_c, t.zeta_par, t.zeta_perp}) EXPECT_EQ(value, 0.0);
  }
  EXPECT_EQ(DpdModel<3>(1, {standard()}).cutoff(), 1.2);
}

// Central differences of step h: error of order h^2 times the third derivative, far below the
// bound.
TEST(Dpd, ForceAndStiffnessAreDerivatives) {
  for (const double s_bar : {0.5, 1.0, 1.7, 2.0, 3.0}) {
    DpdParameters p = standard();
    p.s_bar = s_bar;
    constexpr double h = 1e-5;
    for (const double r : {0.05, 0.4, 0.8, 1.1}) {
      const PairTerms t = terms(p, r), before = terms(p, r - h), after = terms(p, r + h);
      EXPECT_NEAR(t.f_c, -(after.u - before.u) / (2.0 * h), 1e-7) << "s_bar " << s_bar;
      EXPECT_NEAR(t.k_c, -(after.f_c - before.f_c) / (2.0 * h), 1e-6) << "s_bar " << s_bar;
    }
  }
}

TEST(Dpd, FrictionExponents) {
  for (const double s : {0.0, 0.25, 0.5, 1.0, 2.0}) {
    DpdParameters p = standard();
    p.s = s;
    EXPECT_NEAR(terms(p, 0.9).zeta_par, p.gamma * std::pow(0.25, s), 1e-13);
  }
}

TEST(Dpd, FarFrictionIsAddedAlongTheLineOnly) {
  DpdParameters p = standard();
  const PairTerms near = terms(p, 0.7);
  p.gamma_far = 0.1;
  p.cutoff_far = 2.0;
  EXPECT_EQ(DpdModel<2>(1, {p}).cutoff(), 2.0);
  const PairTerms both = terms(p, 0.7);
  EXPECT_NEAR(both.zeta_par, near.zeta_par + 0.1 * std::sqrt(1.0 - 0.35), 1e-14);
  EXPECT_EQ(both.zeta_perp, near.zeta_perp);
  EXPECT_EQ(both.f_c, near.f_c);
  const PairTerms far = terms(p, 1.6);
  EXPECT_NEAR(far.zeta_par, 0.1 * std::sqrt(0.2), 1e-14);
  EXPECT_EQ(far.f_c, 0.0);
  EXPECT_EQ(far.u, 0.0);
  EXPECT_EQ(far.zeta_perp, 0.0);
  EXPECT_EQ(terms(p, 2.0).zeta_par, 0.0);
}

// Beyond the core as without it, at the part of the way to the cutoff; nearer, one force.
TEST(Dpd, ACoreMovesBothWeightsOutwards) {
  DpdParameters p = standard();
  p.core = 0.4;
  const double width = 0.8;
  EXPECT_EQ(DpdModel<2>(1, {p}).kinks(Site{0}, Site{0}), (std::vector{0.4, 1.2}));
  for (const double r : {0.0, 0.2, 0.39, 0.4, 0.7, 1.1, 1.2}) {
    const double x = std::max(0.0, std::min(1.0, (1.2 - r) / width));
    const PairTerms t = terms(p, r);
    EXPECT_NEAR(t.zeta_par, p.gamma * std::sqrt(x), 1e-7);
    EXPECT_NEAR(t.zeta_perp, p.gamma_perp * std::sqrt(x), 1e-7);
    EXPECT_NEAR(t.f_c, p.a * std::pow(x, 1.5), 1e-13);
    EXPECT_NEAR(t.u, p.a * (width / 2.5 * std::pow(x, 2.5) + std::max(0.0, 0.4 - r)), 1e-13);
    EXPECT_NEAR(t.k_c, r < 0.4 ? 0.0 : p.a * 1.5 / width * std::sqrt(x), 1e-6);
  }
}

TEST(Dpd, RefusesParametersOutOfRange) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refuse = [](const char* name, const std::function<void(DpdParameters&)>& spoil) {
    DpdParameters p = standard();
    spoil(p);
    support::expect_error<odpd::ConfigError>([&] { terms(p, 0.5); }, {name});
  };
  refuse("parameter a ", [](auto& p) { p.a = -1.0; });
  refuse("parameter a ", [&](auto& p) { p.a = nan; });
  refuse("s_bar", [](auto& p) { p.s_bar = 0.0; });
  refuse("gamma ", [](auto& p) { p.gamma = -1e-9; });
  refuse("gamma_perp", [](auto& p) { p.gamma_perp = -1.0; });
  refuse("parameter s ", [](auto& p) { p.s = -0.5; });
  refuse("cutoff", [](auto& p) { p.cutoff = 0.0; });
  refuse("cutoff", [&](auto& p) { p.cutoff = nan; });
  refuse("core", [](auto& p) { p.core = p.cutoff; });
  refuse("core", [](auto& p) { p.core = -0.1; });
  refuse("kT", [](auto& p) { p.kT = -0.1; });
  refuse("gamma_far", [](auto& p) { p.gamma_far = -0.1; });
  refuse("cutoff_far", [](auto& p) {
    p.gamma_far = 0.1;
    p.cutoff_far = p.cutoff;
  });
}

TEST(Dpd, RefusesATableThatIsNotOnePerPair) {
  const DpdParameters p = standard();
  DpdParameters q = p;
  q.a = 3.0;
  EXPECT_NO_THROW(DpdModel<2>(2, {p, q, q, p}));
  EXPECT_THROW(DpdModel<2>(2, {p, q, p}), odpd::ConfigError);
  EXPECT_THROW(DpdModel<2>(2, {p, q, p, p}), odpd::ConfigError) << "A with B unlike B with A";
}

TEST(Dpd, KnowsWhetherItRepelsAndHeats) {
  DpdParameters p = standard();
  EXPECT_TRUE(DpdModel<2>(1, {p}).conservative());
  EXPECT_TRUE(DpdModel<2>(1, {p}).thermal());
  p.a = 0.0;
  p.kT = 0.0;
  const DpdModel<2> gas(1, {p});
  EXPECT_FALSE(gas.conservative());
  EXPECT_FALSE(gas.thermal());
  EXPECT_EQ(gas.pair(0.5, Site{0}, Site{0}).f_c, 0.0);
}

TEST(Dpd, EveryPairOfSpeciesHasItsParameters) {
  DpdParameters aa = standard(), ab = standard(), bb = standard();
  ab.a = 60.0;
  ab.gamma = 9.0;
  bb.a = 5.0;
  bb.cutoff = 0.8;
  const DpdModel<3> model(2, {aa, ab, ab, bb});
  EXPECT_EQ(model.cutoff(), 1.2);
  const auto at = [&](std::int32_t a, std::int32_t b) { return model.pair(0.6, Site{a}, Site{b}); };
  EXPECT_NEAR(at(0, 0).f_c, 18.5 * std::pow(0.5, 1.5), 1e-13);
  EXPECT_NEAR(at(0, 1).f_c, 60.0 * std::pow(0.5, 1.5), 1e-13);
  EXPECT_NEAR(at(1, 1).f_c, 5.0 * std::pow(0.25, 1.5), 1e-13);
  EXPECT_NEAR(at(1, 0).zeta_par, 9.0 * std::sqrt(0.5), 1e-13);
  EXPECT_EQ(at(1, 0).f_c, at(0, 1).f_c);
  EXPECT_EQ(model.pair(0.9, Site{1}, Site{1}).zeta_par, 0.0);
}

}  // namespace
