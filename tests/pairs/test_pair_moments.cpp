// What follows from pair(r) by quadrature: DPD against its closed forms, and models without any.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "odpd/core/error.h"
#include "odpd/core/quadrature.h"
#include "odpd/pairs/dpd.h"
#include "odpd/pairs/kinetic_theory.h"
#include "support/dimensions.h"
#include "support/pair_functions.h"

namespace {

using odpd::DpdParameters;
using odpd::explicit_step_limit;
using odpd::pair_moments;
using odpd::PairMoments;
using odpd::PairTerms;
using odpd::Site;
using odpd::weight_moment;

template <int D>
PairMoments moments(const DpdParameters& p) {
  return pair_moments(*odpd::make_dpd<D>(p), Site{}, Site{});
}

double step_limit(const DpdParameters& p, double mass = 0.0) {
  return explicit_step_limit({moments<2>(p)}, mass).value();
}

template <class Dimension>
class PairMomentsIn : public ::testing::Test {};
TYPED_TEST_SUITE(PairMomentsIn, support::Dimensions);

TEST(Quadrature, TakesPowersAtBothEnds) {
  // Euler's beta function.
  for (const double p : {-0.9, -0.5, 0.0, 0.5, 3.7})
    for (const double q : {-0.5, 0.0, 0.07, 1.0, 20.0}) {
      const double exact =
          std::exp(std::lgamma(p + 1.0) + std::lgamma(q + 1.0) - std::lgamma(p + q + 2.0));
      const auto value = odpd::integrate<1>(
          [&](double x) { return std::array{std::pow(x, p) * std::pow(1.0 - x, q)}; }, 0.0, 1.0);
      // Near 1 the function itself sees its argument to a digit less, by 1 - x.
      EXPECT_NEAR(value[0], exact, (q < 0.0 ? 1e-7 : 1e-13) * exact) << p << " " << q;
    }
  const auto two = odpd::integrate<2>(
      [](double x) {
        return std::array{std::cos(x), std::abs(x - 0.7)};
      },
      -1.0, 2.0);
  EXPECT_NEAR(two[0], std::sin(2.0) + std::sin(1.0), 1e-14);
  EXPECT_NEAR(two[1], 0.5 * (1.7 * 1.7 + 1.3 * 1.3), 1e-6) << "a kink inside";
}

// As from row to row of a fine table: a few hundred values each, not the tens of thousands of one that does not settle.
TEST(Quadrature, NarrowIntervalsSettleAtOnce) {
  for (const double width : {1e-3, 1e-5, 1e-8}) {
    int values = 0;
    const auto integral = odpd::integrate<1>(
        [&](double x) {
          ++values;
          return std::array{std::exp(x)};
        },
        0.5, 0.5 + width);
    EXPECT_LT(values, 400) << width;
    EXPECT_NEAR(integral[0], std::exp(0.5) * std::expm1(width), 1e-15);
  }
}

TYPED_TEST(PairMomentsIn, OfDpdAreItsClosedForms) {
  constexpr int D = TypeParam::D;
  for (const double s : {0.0, 0.07, 0.5, 1.0, 2.0, 3.3})
    for (const double s_bar : {0.07, 0.5, 1.0, 2.0, 5.78, 40.0}) {
      const DpdParameters p{.a = 25.0,
                            .s_bar = s_bar,
                            .gamma = 3.0,
                            .gamma_perp = 0.7,
                            .s = s,
                            .cutoff = 1.3,
                            .kT = 0.4,
                            .gamma_far = 0.1,
                            .cutoff_far = 2.2};
      const PairMoments m = moments<D>(p);
      const auto expect = [&](const std::optional<double>& value, double exact) {
        ASSERT_TRUE(value.has_value());
        EXPECT_NEAR(*value, exact, 1e-13 * exact) << s << " " << s_bar;
      };
      const auto zeta = [&](int power, double share) {
        return (p.gamma + share * p.gamma_perp) * weight_moment<D>(power, s, p.cutoff) +
               p.gamma_far * weight_moment<D>(power, s, p.cutoff_far);
      };
      expect(m.energy, p.a * p.cutoff / (s_bar + 1.0) * weight_moment<D>(0, s_bar + 1.0, p.cutoff));
      expect(m.virial, p.a * weight_moment<D>(1, s_bar, p.cutoff));
      expect(m.drag, zeta(0, D - 1));
      expect(m.shear_par, zeta(2, 0));
      expect(m.shear_perp, p.gamma_perp * weight_moment<D>(2, s, p.cutoff));
      EXPECT_EQ(m.energy_beyond_core, m.energy);
      EXPECT_EQ(m.kT, 0.4);
      EXPECT_EQ(m.force, 25.0);
      EXPECT_EQ(m.zeta_par, 3.0 + 0.1);
      EXPECT_EQ(m.zeta_perp, 0.7);
      EXPECT_EQ(m.force_range, 1.3);
      EXPECT_EQ(m.range, 1.3) << "weak friction of longer range does not count";
    }
}

TEST(PairMoments, StepLimitOfDpd) {
  const auto expected = [](const DpdParameters& p) {
    return 0.2 * p.gamma * p.cutoff / (p.a * std::max(1.0, p.s_bar));
  };
  for (const double s_bar : {0.07, 0.5, 1.0, 1.6, 13.92})
    for (const double cutoff : {0.8, 1.0, 2.0}) {
      const DpdParameters p{.a = 40.0, .s_bar = s_bar, .gamma = 2.0, .cutoff = cutoff};
      EXPECT_NEAR(step_limit(p), expected(p), 1e-14 * expected(p));
    }
  const DpdParameters p{.gamma = 0.01};
  EXPECT_NEAR(step_limit(p, 2.0), 0.1 * std::sqrt(2.0 / p.a), 1e-14);
  EXPECT_TRUE(std::isinf(step_limit({.a = 0.0})));
  // Of two species the stiffest pair.
  const DpdParameters soft, stiff{.a = 100.0};
  const odpd::DpdModel<2> two(2, {soft, stiff, stiff, soft});
  const auto pairs = pair_moments(two, 2);
  EXPECT_NEAR(explicit_step_limit(pairs, 0.0).value(), expected(stiff), 1e-14);
  EXPECT_EQ(pairs[1].force, 100.0);
  EXPECT_EQ(pairs[2].force, 100.0);
  EXPECT_EQ(pairs[3].force, soft.a);
}

TEST(PairMoments, RangeWithoutForceIsThatOfFriction) {
  EXPECT_EQ(moments<2>({.a = 0.0, .gamma_far = 0.1, .cutoff_far = 2.0}).range, 1.0);
  EXPECT_EQ(moments<2>({.a = 0.0, .gamma_far = 3.0, .cutoff_far = 2.0}).range, 2.0);
  EXPECT_EQ(moments<2>({.a = 0.0, .gamma = 0.0}).range, 0.0);
}

// A force that rises from 0 at r = 0: integrals by hand in 2D.
TEST(PairMoments, OfAGaussian) {
  const double A = 18.5, w = 0.3, x = 0.5 / (w * w);
  const auto pairs = pair_moments(*support::gaussian<2>(A, w, 1.0), 1);
  const double virial =
      2.0 * std::numbers::pi * A / w * 2.0 * std::pow(w, 4) * (1.0 - (1.0 + x) * std::exp(-x));
  EXPECT_NEAR(pairs[0].virial.value(), virial, 1e-13 * virial);
  // u vanishes at the cutoff: [u] = [r f_c]/d by parts.
  EXPECT_NEAR(pairs[0].energy.value(), virial / 2.0, 1e-13 * virial);
  const auto k = odpd::kinetic_theory<2>(pairs, {1.0}, 4.0, 0.0);
  EXPECT_NEAR(k.pressure, 4.0 + 4.0 * virial, 1e-12);
  EXPECT_NEAR(k.energy, virial, 1e-12);
  EXPECT_NEAR(pairs[0].force, A * std::exp(-0.5), 1e-5 * A);
  EXPECT_NEAR(explicit_step_limit(pairs, 0.0).value(), 0.2 * 4.5 * w / A, 1e-14);
}

TYPED_TEST(PairMomentsIn, WhatDivergesIsUndefined) {
  constexpr int D = TypeParam::D;
  const PairMoments m = pair_moments(*support::lennard_jones<D>(1.0, 1.0), Site{}, Site{});
  EXPECT_FALSE(m.energy.has_value());
  EXPECT_FALSE(m.virial.has_value());
  EXPECT_TRUE(m.drag.has_value() && m.shear_par.has_value() && m.shear_perp.has_value());
  const auto k = odpd::kinetic_theory<D>({m}, {1.0}, 4.0, 0.0);
  EXPECT_TRUE(std::isnan(k.pressure) && std::isnan(k.energy) && std::isnan(k.kappa_inverse));
  EXPECT_GT(k.eta_friction, 0.0);
  // u = 10 kT at (l/r)^6 = y with 4 (y^2 - y) = 10 + shift.
  const double shift = 4.0 * (std::pow(0.4, 12) - std::pow(0.4, 6));
  const double y = 0.5 + std::sqrt(0.25 + (10.0 + shift) / 4.0);
  const double core = 0.4 * std::pow(y, -1.0 / 6.0);
  EXPECT_NEAR(m.force, 4.0 * (12.0 * y * y - 6.0 * y) / core, 1e-9 * m.force);
  EXPECT_NEAR(m.stiffness, 4.0 * (156.0 * y * y - 42.0 * y) / (core * core) * (1.0 - core),
              1e-9 * m.stiffness);
  ASSERT_TRUE(m.energy_beyond_core.has_value());
  EXPECT_LT(std::abs(*m.energy_beyond_core), 10.0);
  EXPECT_TRUE(explicit_step_limit({m}, 0.0).has_value());
  // Without kT nobody knows how near they come.
  const PairMoments cold = pair_moments(*support::lennard_jones<D>(1.0, 0.0), Site{}, Site{});
  EXPECT_FALSE(explicit_step_limit({cold}, 0.0).has_value());
  EXPECT_FALSE(cold.energy_beyond_core.has_value());
}

TEST(PairMoments, APullWithoutBoundHasNoLimit) {
  const auto force = [](double r, PairTerms& t) {
    t.u = 1.0 - 1.0 / (r * r);
    t.f_c = -2.0 / (r * r * r);
    t.k_c = -6.0 / (r * r * r * r);
  };
  const support::FunctionModel<2> model(force, {});
  const PairMoments m = pair_moments(model, Site{}, Site{});
  EXPECT_FALSE(m.energy.has_value());
  EXPECT_FALSE(explicit_step_limit({m}, 0.0).has_value());
}

// An integrable core: 1/r in three dimensions.
TEST(PairMoments, AnIntegrableCoreIsDefined) {
  const auto force = [](double r, PairTerms& t) {
    t.u = 1.0 / r - 1.0;
    t.f_c = 1.0 / (r * r);
    t.k_c = 2.0 / (r * r * r);
  };
  const support::FunctionModel<3> model(force, {});
  const PairMoments m = pair_moments(model, Site{}, Site{});
  EXPECT_NEAR(m.energy.value(), 4.0 * std::numbers::pi / 6.0, 1e-13);
  EXPECT_NEAR(m.virial.value(), 4.0 * std::numbers::pi / 2.0, 1e-13);
}

TEST(PairMoments, AForceThatJumpsAtItsEndIsTold) {
  for (const double s_bar : {0.07, 0.5, 1.0, 5.0})
    EXPECT_FALSE(moments<2>({.s_bar = s_bar, .gamma_far = 0.1, .cutoff_far = 2.0}).force_jumps);
  EXPECT_FALSE(moments<2>({.a = 0.0}).force_jumps);
  const auto cut = pair_moments(*support::gaussian<2>(18.5, 0.3, 1.0), 1);
  EXPECT_TRUE(cut[0].force_jumps && odpd::some_force_jumps(cut));
  EXPECT_TRUE(pair_moments(*support::lennard_jones<3>(1.0, 1.0), Site{}, Site{}).force_jumps);
  // 2e-5 of the largest.
  EXPECT_FALSE(pair_moments(*support::gaussian<2>(18.5, 0.2, 1.0), Site{}, Site{}).force_jumps);
}

// A model that refuses a distance has no integrals over it.
TEST(PairMoments, WhatAModelRefusesIsUndefined) {
  const auto force = [](double r, PairTerms& t) {
    if (r < 0.1) throw odpd::BlowUpError("nearer than the table");
    t.u = 1.0 - r;
    t.f_c = 1.0;
  };
  const support::FunctionModel<2> model(force, {.gamma = 2.0});
  const PairMoments m = pair_moments(model, Site{}, Site{});
  EXPECT_FALSE(m.energy.has_value());
  EXPECT_NEAR(m.force, 1.0, 1e-15);
  EXPECT_NEAR(explicit_step_limit({m}, 0.0).value(), 0.4 * std::sqrt(0.9), 1e-3);
}

TEST(KineticTheory, OfAMixtureIsTheMeanOverPairs) {
  const DpdParameters aa{.a = 10.0}, ab{.a = 30.0, .gamma = 9.0}, bb{.a = 20.0};
  const odpd::DpdModel<2> two(2, {aa, ab, ab, bb});
  const auto k = odpd::kinetic_theory<2>(pair_moments(two, 2), {0.25, 0.75}, 4.0, 0.0);
  const double a = 10.0 / 16.0 + 2.0 * 3.0 / 16.0 * 30.0 + 9.0 / 16.0 * 20.0;
  const double gamma = 4.5 * (10.0 / 16.0) + 9.0 * (6.0 / 16.0);
  EXPECT_NEAR(k.pressure, 4.0 + std::numbers::pi / 24.0 * a * 16.0, 1e-11);
  EXPECT_NEAR(k.eta_friction, gamma * 64.0 * std::numbers::pi / 315.0, 1e-11);
  EXPECT_NEAR(odpd::kinetic_theory<2>(pair_moments(two, 2), {0.0, 1.0}, 4.0, 0.0).pressure,
              4.0 + std::numbers::pi / 24.0 * 20.0 * 16.0, 1e-11);
}

}  // namespace
