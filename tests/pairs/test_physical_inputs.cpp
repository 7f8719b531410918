// The formulas of physical inputs against integrals done by quadrature, their inverses, and the numbers printed in
// Nguyen 2021, chapters 3 and 4. Water there: kappa^-1 = 15.98.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "odpd/pairs/dpd.h"
#include "odpd/pairs/kinetic_theory.h"
#include "odpd/pairs/physical_keys.h"
#include "support/dimensions.h"
#include "support/errors.h"

namespace {

using odpd::dpd_parameters;
using odpd::DpdParameters;
using odpd::KineticTheory;
using odpd::PhysicalInputError;
using odpd::PhysicalInputs;
using support::expect_error;

constexpr double water = 15.98;

DpdParameters with_cutoff(double cutoff, double kT = 1.0) {
  DpdParameters p;
  p.cutoff = cutoff;
  p.kT = kT;
  return p;
}

template <int D>
KineticTheory kinetic_theory(const DpdParameters& p, double density, double mass) {
  return odpd::kinetic_theory<D>(odpd::pair_moments(*odpd::make_dpd<D>(p), 1), {1.0}, density,
                                 mass);
}

PhysicalInputs like_water(double eta, double alpha) {
  PhysicalInputs in;
  in.eta = eta;
  in.alpha = alpha;
  in.kappa_inverse = water;
  return in;
}

// The integral over d-dimensional space of f(R) up to `cutoff`, by the midpoint rule in (1 - R/r_c)^(1/2).
template <int D>
double integral(double cutoff, const std::function<double(double)>& f) {
  const int steps = 20000;
  double sum = 0.0;
  for (int k = 0; k < steps; ++k) {
    const double t = (k + 0.5) / steps, r = cutoff * (1.0 - t * t);
    sum += f(r) * 2.0 * (D - 1) * std::numbers::pi * std::pow(r, D - 1) * 2.0 * cutoff * t / steps;
  }
  return sum;
}

template <class Dimension>
class PhysicalInputsIn : public ::testing::Test {};
TYPED_TEST_SUITE(PhysicalInputsIn, support::Dimensions);

TYPED_TEST(PhysicalInputsIn, KineticTheoryIsItsIntegrals) {
  constexpr int D = TypeParam::D;
  const double n = 5.0, m = 0.3, kT = 1.7;
  DpdParameters p = with_cutoff(1.2, kT);
  p.a = 25.0;
  p.s_bar = 1.6;
  p.gamma = 3.0;
  p.s = 0.8;
  const auto w_c = [&](double r) { return std::pow(1.0 - r / p.cutoff, p.s_bar); };
  const auto w_d = [&](double r) { return std::pow(1.0 - r / p.cutoff, p.s); };
  const double virial = integral<D>(p.cutoff, [&](double r) { return r * p.a * w_c(r); });
  const double friction = integral<D>(p.cutoff, [&](double r) { return r * r * p.gamma * w_d(r); });
  const double drag = integral<D>(p.cutoff, [&](double r) { return p.gamma * w_d(r); });
  const KineticTheory k = kinetic_theory<D>(p, n, m);
  EXPECT_NEAR(k.pressure, n * kT + n * n * virial / (2.0 * D), 1e-6 * k.pressure);
  EXPECT_NEAR(k.kappa_inverse, 1.0 + n * virial / (D * kT), 1e-6 * k.kappa_inverse);
  EXPECT_NEAR(k.eta_friction, n * n * friction / (2.0 * D * (D + 2)), 1e-6 * k.eta_friction);
  EXPECT_NEAR(k.diffusion, D * kT / (n * drag), 1e-6 * k.diffusion);
  EXPECT_NEAR(k.eta_kinetic, 0.5 * n * m * k.diffusion, 1e-12);
  EXPECT_NEAR(k.Sc, k.eta() / (n * m * k.diffusion), 1e-9 * k.Sc);
  EXPECT_NEAR(k.alpha, p.gamma * p.gamma * p.cutoff / (m * p.a), 1e-12 * k.alpha);
  EXPECT_NEAR(k.w_0, n * drag / (D * m), 1e-6 * k.w_0);
  EXPECT_NEAR(k.l_0, std::sqrt(kT / m) / k.w_0, 1e-12 * k.l_0);
  EXPECT_NEAR(k.speed_of_sound * k.speed_of_sound * m, k.kappa_inverse * kT, 1e-9);
  EXPECT_NEAR(k.bulk_modulus, n * kT * k.kappa_inverse, 1e-9);
  EXPECT_EQ(k.rho, n * m);
}

// What is asked for comes back, also near the ends of the allowed ranges.
TYPED_TEST(PhysicalInputsIn, TheReverseGivesWhatWasAskedFor) {
  constexpr int D = TypeParam::D;
  const double n = 6.0, m = 0.7;
  for (const double Sc : {1600.0, 1e4, 1e6})
    for (const double kappa_inverse : {1.001, 2.0, 15.98, 60.0}) {
      PhysicalInputs in = like_water(20.0, 0.8);
      in.Sc = Sc;
      in.kappa_inverse = kappa_inverse;
      const DpdParameters p = dpd_parameters<D>(in, with_cutoff(1.3, 0.9), n, m);
      const KineticTheory k = kinetic_theory<D>(p, n, m);
      EXPECT_GT(p.s, 0.0);
      EXPECT_GT(p.s_bar, 0.0);
      EXPECT_NEAR(k.eta_friction, 20.0, 1e-9);
      EXPECT_NEAR(k.alpha, 0.8, 1e-9);
      EXPECT_NEAR(k.kappa_inverse, kappa_inverse, 1e-9 * kappa_inverse);
      // (3.12) takes the friction for the whole viscosity; the kinetic part rho D/2 adds 1/2.
      EXPECT_NEAR(k.Sc, Sc + 0.5, 1e-9 * Sc);
    }
}

// s_bar and s go to 0 at the conditions (3.16), (3.20) and C = (d + 1)!, and are refused beyond.
TYPED_TEST(PhysicalInputsIn, ConditionsAreThoseOfThePositiveExponents) {
  constexpr int D = TypeParam::D;
  const double n = 4.0, m = 0.5, eta = 12.0;
  const double smallest_Sc = (D < 3 ? 16.0 : 50.0 / 3.0) * eta * eta / (m * n * n);
  PhysicalInputs in;
  in.eta = eta;
  in.Sc = smallest_Sc * (1.0 + 1e-9);
  EXPECT_NEAR(dpd_parameters<D>(in, with_cutoff(1.0), n, m).s, 0.0, 1e-8);
  in.Sc = smallest_Sc * (1.0 - 1e-9);
  expect_error<PhysicalInputError>([&] { dpd_parameters<D>(in, with_cutoff(1.0), n, m); },
                                   {"Sc", "too small", "3.16", "3.20"});
  in = like_water(eta, 1.0);
  const double a = dpd_parameters<D>(in, with_cutoff(1.0), n, m).a;
  // C = 2 pi a n/(kappa^-1 - 1) > 6 in 2D, 8 pi a n/(kappa^-1 - 1) > 24 in 3D.
  const double largest = 1.0 + (D < 3 ? 2.0 / 6.0 : 8.0 / 24.0) * std::numbers::pi * a * n;
  in.kappa_inverse = largest * (1.0 - 1e-9);
  EXPECT_NEAR(dpd_parameters<D>(in, with_cutoff(1.0), n, m).s_bar, 0.0, 1e-8);
  in.kappa_inverse = largest * (1.0 + 1e-9);
  expect_error<PhysicalInputError>([&] { dpd_parameters<D>(in, with_cutoff(1.0), n, m); },
                                   {"kappa_inverse", "too stiff", "C = ", "3.6"});
}

TYPED_TEST(PhysicalInputsIn, RefusesWhatTheFormulasCannotGive) {
  constexpr int D = TypeParam::D;
  const auto refuse = [](const PhysicalInputs& in, double kT, double mass,
                         std::initializer_list<const char*> parts) {
    expect_error<PhysicalInputError>(
        [&] { dpd_parameters<D>(in, with_cutoff(1.0, kT), 4.0, mass); }, parts);
  };
  PhysicalInputs in = like_water(30.0, 1.0);
  refuse(in, 1.0, 0.0, {"alpha", "diverges at mass = 0"});
  refuse(in, 0.0, 1.0, {"kappa_inverse", "kT"});
  in.kappa_inverse = 1.0;
  refuse(in, 1.0, 1.0, {"kappa_inverse", "larger than 1"});
  in = {};
  in.alpha = 1.0;
  refuse(in, 1.0, 1.0, {"eta", "begin with the viscosity"});
  in.eta = -3.0;
  refuse(in, 1.0, 1.0, {"eta", "positive"});
  in = {};
  in.eta = 1.0;
  in.Sc = 1e6;
  refuse(in, 1.0, 0.0, {"Sc", "infinite at mass = 0"});
  refuse(in, 0.0, 1.0, {"Sc", "kT = 0"});
  in.tau_P = 1.0;
  refuse(in, 1.0, 1.0, {"tau_P", "Sc", "one of the two"});
  in.Sc.reset();
  refuse(in, 0.0, 1.0, {"tau_P", "kT = 0"});
  in.tau_P = -1.0;
  refuse(in, 1.0, 1.0, {"tau_P", "positive"});
}

TYPED_TEST(PhysicalInputsIn, WithoutMassEtaAndCompressibilityStillSetTheFluid) {
  constexpr int D = TypeParam::D;
  PhysicalInputs in;
  in.eta = 7.0;
  in.kappa_inverse = 20.0;
  in.keep_s_bar = true;
  DpdParameters base = with_cutoff(1.0);
  base.s_bar = 1.5;
  const DpdParameters p = dpd_parameters<D>(in, base, 4.0, 0.0);
  EXPECT_EQ(p.s_bar, 1.5);
  EXPECT_EQ(p.s, 0.5);
  const KineticTheory k = kinetic_theory<D>(p, 4.0, 0.0);
  EXPECT_NEAR(k.eta(), 7.0, 1e-12);
  EXPECT_NEAR(k.kappa_inverse, 20.0, 1e-12);
  EXPECT_TRUE(std::isinf(k.Sc) && std::isinf(k.alpha) && std::isinf(k.speed_of_sound));
  // The other way round: s_bar of that repulsion.
  in.keep_s_bar = false;
  base.a = p.a;
  EXPECT_NEAR(dpd_parameters<D>(in, base, 4.0, 0.0).s_bar, 1.5, 1e-10);
}

TEST(PhysicalInputs, MeanFieldOfTheStandardFluid) {
  // w_C = 1 - r: p = n kT + (pi/24 in 2D, pi/30 in 3D) a n^2.
  DpdParameters p;
  p.a = 18.5;
  EXPECT_NEAR(kinetic_theory<2>(p, 4.0, 0.0).pressure, 4.0 + std::numbers::pi / 24 * 18.5 * 16,
              1e-10);
  EXPECT_NEAR(kinetic_theory<3>(p, 4.0, 0.0).pressure, 4.0 + std::numbers::pi / 30 * 18.5 * 16,
              1e-10);
  // Groot & Warren 1997: D = 45 kT/(2 pi gamma n r_c^3) and eta = 2 pi gamma n^2 r_c^5/1575 + rho D/2 for s = 2.
  p.s = 2.0;
  const KineticTheory k = kinetic_theory<3>(p, 3.0, 1.0);
  EXPECT_NEAR(k.diffusion, 45.0 / (2.0 * std::numbers::pi * 4.5 * 3.0), 1e-12);
  EXPECT_NEAR(k.eta_friction, 2.0 * std::numbers::pi * 4.5 * 9.0 / 1575.0, 1e-12);
}

TEST(PhysicalInputs, ThesisTable31) {
  const DpdParameters p = dpd_parameters<2>(like_water(100.0, 10.0), with_cutoff(1.6), 10.0, 0.01);
  EXPECT_NEAR(p.gamma, 3.825, 5e-4);
  EXPECT_NEAR(p.a, 234.1, 0.05);
  EXPECT_NEAR(p.s_bar, 13.9, 0.05);
  EXPECT_EQ(p.s, 0.5);
}

TEST(PhysicalInputs, ThesisFigure36) {
  const DpdParameters p = dpd_parameters<2>(like_water(100.0, 1.0), with_cutoff(2.0), 8.0, 0.5);
  EXPECT_NEAR(p.a, 23.96, 0.0101);  // 23.9696, which the thesis cuts after two decimals
  EXPECT_NEAR(p.s_bar, 6.67, 5e-3);
}

// Section 3.1: "from the kinetic theory, the Schmidt number is estimated as 290, 319 and 365".
TEST(PhysicalInputs, ThesisSchmidtNumbersOfThreeLevels) {
  const struct {
    double n, m, cutoff, Sc;
  } levels[] = {{8.0, 1.0, 1.0, 290.0}, {6.0, 4.0 / 3.0, 1.1006, 319.0}, {4.0, 2.0, 1.2599, 365.0}};
  for (const auto& level : levels) {
    const DpdParameters p =
        dpd_parameters<3>(like_water(30.0, 1.0), with_cutoff(level.cutoff), level.n, level.m);
    const KineticTheory k = kinetic_theory<3>(p, level.n, level.m);
    EXPECT_NEAR(k.eta_friction / (k.rho * k.diffusion), level.Sc, 0.5);
    EXPECT_NEAR(k.kappa_inverse, water, 1e-9);
  }
}

// Figure 3.4: sigma = 3, a = 3.5320 is alpha = 8.5997, eta = 16.9721, Sc = 164.52 by kinetic theory.
TEST(PhysicalInputs, ThesisStandardFluidReadBackwards) {
  DpdParameters p = with_cutoff(1.5);
  p.a = 3.5320;
  const KineticTheory k = kinetic_theory<3>(p, 4.0, 1.0);
  EXPECT_NEAR(k.alpha, 8.5997, 3e-4);  // as far as the digits of a go
  EXPECT_NEAR(k.eta(), 16.9721, 5e-5);
  EXPECT_NEAR(k.Sc, 164.52, 0.01);  // 164.529, cut
  // It is water: the thesis chose a so. (3.37) is the same kinetic part.
  EXPECT_NEAR(k.kappa_inverse, water, 2e-3);
  EXPECT_NEAR(k.eta_kinetic, 0.6 * 4.0 * 4.0 * 2.25 / (k.eta_friction * 4.5 * 5.5), 1e-12);
}

PhysicalInputs with_number(double eta, double Sc) {
  PhysicalInputs in;
  in.eta = eta;
  in.Sc = Sc;
  return in;
}

PhysicalInputs with_time(double eta, double tau_P) {
  PhysicalInputs in;
  in.eta = eta;
  in.tau_P = tau_P;
  return in;
}

/// gamma and s of the thesis' fluids with m = 1, n = 4, r_c = 1.5.
DpdParameters of_chapter_4(const PhysicalInputs& in, double kT = 1.0) {
  return dpd_parameters<3>(in, with_cutoff(1.5, kT), 4.0, 1.0);
}

/// (4.52) with rho = 4.
double time_of(double eta, double Sc, double kT) {
  return std::pow(4.0 * Sc, 3) * kT * kT /
         (36.0 * std::pow(std::numbers::pi, 2) * std::pow(eta, 5));
}

TEST(PhysicalInputs, ThesisTable41BySchmidtNumberAndByDiffusionTime) {
  const struct {
    double eta, Sc, gamma, s;
  } rows[] = {{30.0, 500.0, 6.9710, 0.4244},  {28.0, 500.0, 11.7110, 0.7727},
              {26.0, 500.0, 19.6042, 1.1747}, {24.0, 500.0, 32.9714, 1.6441},
              {30.0, 600.0, 15.0263, 0.8898}, {30.0, 700.0, 27.4087, 1.3181},
              {30.0, 800.0, 44.9254, 1.7169}};
  for (const auto& row : rows) {
    const DpdParameters by_number = of_chapter_4(with_number(row.eta, row.Sc));
    EXPECT_NEAR(by_number.gamma, row.gamma, 5e-5);
    EXPECT_NEAR(by_number.s, row.s, 5e-5);
    const double tau_P = time_of(row.eta, row.Sc, 1.0);
    const DpdParameters by_time = of_chapter_4(with_time(row.eta, tau_P));
    EXPECT_NEAR(by_time.gamma, row.gamma, 5e-5);
    EXPECT_NEAR(by_time.s, row.s, 5e-5);
    const KineticTheory k = kinetic_theory<3>(by_time, 4.0, 1.0);
    EXPECT_NEAR(k.tau_P, tau_P, 1e-9 * tau_P);
    EXPECT_NEAR(k.eta_friction, row.eta, 1e-9 * row.eta);
  }
}

// "tau_P = (0.93, 1.12, 1.33, 1.57, 1.82)" at five temperatures of rho = 4, Sc = 500, eta = 30.
TEST(PhysicalInputs, ThesisDiffusionTimesOfFigure48) {
  const double kT[] = {1.0, 1.1, 1.2, 1.3, 1.4}, printed[] = {0.93, 1.12, 1.33, 1.57, 1.82};
  for (int k = 0; k < 5; ++k) {
    const DpdParameters p = of_chapter_4(with_number(30.0, 500.0), kT[k]);
    EXPECT_NEAR(kinetic_theory<3>(p, 4.0, 1.0).tau_P, printed[k], 5e-3);
  }
}

// Section 4.1: sigma = 3 and n = 3, 4 have l_0 = 0.5305, 0.3979 at s = 2 and 0.1161, 0.087 at s = 1/2; section 4.6:
// gamma = 6.97 and s = 0.42 have 0.0149.
TEST(PhysicalInputs, ThesisCorrelationLengths) {
  const double rows[][3] = {
      {3.0, 2.0, 0.5305}, {4.0, 2.0, 0.3979}, {3.0, 0.5, 0.1161}, {4.0, 0.5, 0.0870}};
  for (const auto& [n, s, printed] : rows) {
    DpdParameters p = with_cutoff(1.0);
    p.s = s;
    EXPECT_NEAR(kinetic_theory<3>(p, n, 1.0).l_0, printed, 5e-5);
  }
  DpdParameters p = with_cutoff(1.5);
  p.gamma = 6.97;
  p.s = 0.42;
  EXPECT_NEAR(kinetic_theory<3>(p, 4.0, 1.0).l_0, 0.0149, 5e-5);
}

// (4.50), also where kT, n and r_c are none of them 1; and (4.47) of the fluid that comes out, of any mass.
TEST(PhysicalInputs, DiffusionTimeNeedsNoMassButThreeDimensions) {
  const double n = 5.0, eta = 12.0, kT = 0.8;
  const DpdParameters base = with_cutoff(1.3, kT);
  const double pi_squared = std::pow(std::numbers::pi, 2);
  const double shortest =
      31250.0 * eta / (243.0 * pi_squared * kT * std::pow(n, 3) * std::pow(1.3, 6));
  PhysicalInputs in = with_time(eta, shortest * (1.0 + 1e-9));
  EXPECT_NEAR(dpd_parameters<3>(in, base, n, 0.0).s, 0.0, 1e-8);
  expect_error<PhysicalInputError>(
      [&] { dpd_parameters<3>(with_time(eta, shortest * (1.0 - 1e-9)), base, n, 0.0); },
      {"tau_P", "too short", "4.50"});
  in.tau_P = 3.0 * shortest;
  const DpdParameters p = dpd_parameters<3>(in, base, n, 0.0);
  EXPECT_EQ(dpd_parameters<3>(in, base, n, 2.0).s, p.s);
  const double drag = 8.0 * std::numbers::pi * std::pow(1.3, 3) * p.gamma * n /
                      (3.0 * kT * (p.s + 1.0) * (p.s + 2.0) * (p.s + 3.0));
  EXPECT_NEAR(kT * kT / (36.0 * pi_squared * eta * eta) * std::pow(drag, 3), 3.0 * shortest,
              1e-9 * shortest);
  EXPECT_NEAR(kinetic_theory<3>(p, n, 0.0).tau_P, 3.0 * shortest, 1e-9 * shortest);
  expect_error<PhysicalInputError>([&] { dpd_parameters<2>(in, base, n, 1.0); },
                                   {"tau_P", "3D only", "Sc or s"});
  EXPECT_TRUE(std::isnan(kinetic_theory<2>(p, n, 1.0).tau_P));
  EXPECT_TRUE(std::isinf(kinetic_theory<3>(p, n, 0.0).w_0));
  EXPECT_EQ(kinetic_theory<3>(p, n, 0.0).l_0, 0.0);
}

// Levels of one fluid by evaluating the formulas at another n, r_c and m; (3.22) would change eta (3.36).
TEST(PhysicalInputs, LevelsKeepViscosityAndCompressibility) {
  const double levels[][3] = {{8.0, 1.0, 1.0}, {6.0, 4.0 / 3.0, 4.0 / 3.0}, {4.0, 2.0, 2.0}};
  for (const auto& [n, cutoff, mass] : levels) {
    const DpdParameters p = dpd_parameters<2>(like_water(30.0, 1.0), with_cutoff(cutoff), n, mass);
    const KineticTheory k = kinetic_theory<2>(p, n, mass);
    EXPECT_NEAR(k.eta_friction, 30.0, 1e-10);
    EXPECT_NEAR(k.kappa_inverse, water, 1e-9);
    EXPECT_NEAR(k.alpha, 1.0, 1e-12);
    EXPECT_NEAR(k.rho, 8.0, 1e-12);
    EXPECT_LT(k.eta_kinetic, 0.01 * k.eta_friction);
  }
}

}  // namespace
