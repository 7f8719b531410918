// Smoothing kernels, the equation of state and the viscosities of SDPD, by definition; its keys.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "odpd/core/quadrature.h"
#include "odpd/pairs/kinetic_theory.h"
#include "odpd/pairs/pair_moments.h"
#include "odpd/pairs/sdpd.h"
#include "support/dimensions.h"
#include "support/errors.h"

namespace {

using odpd::Config;
using odpd::Derivatives;
using odpd::EquationOfState;
using odpd::SdpdFriction;
using odpd::SdpdModel;
using odpd::SdpdParameters;
using odpd::Site;
using odpd::SmoothingKernel;
using odpd::Vec;

constexpr std::array sdpd_shapes{SmoothingKernel::Shape::wendland_c2,
                                 SmoothingKernel::Shape::wendland_c4, SmoothingKernel::Shape::lucy,
                                 SmoothingKernel::Shape::quintic};

template <class T>
class SdpdTest : public ::testing::Test {};
TYPED_TEST_SUITE(SdpdTest, support::Dimensions);

TYPED_TEST(SdpdTest, KernelsHaveTheIntegralOne) {
  constexpr int D = TypeParam::D;
  constexpr double h = 1.7;
  for (const auto shape : sdpd_shapes) {
    const SmoothingKernel W(shape, D, h);
    double integral = 0.0, moment = 0.0;
    for (int third = 0; third < 3; ++third) {
      const auto part = odpd::integrate<2>(
          [&](double r) {
            const double shell = (D == 2 ? 2.0 : 4.0 * r) * std::numbers::pi * r;
            return std::array{shell * W(r).value, shell * r * r * W.slope(r)};
          },
          h * third / 3.0, h * (third + 1) / 3.0);
      integral += part[0];
      moment += part[1];
    }
    EXPECT_NEAR(integral, 1.0, 1e-10);
    // By parts: what A and B are made for.
    EXPECT_NEAR(moment, D, 1e-9);
  }
}

TYPED_TEST(SdpdTest, KernelsHaveTheirDerivatives) {
  constexpr int D = TypeParam::D;
  constexpr double h = 1.7, step = 1e-4;
  for (const auto shape : sdpd_shapes) {
    const SmoothingKernel W(shape, D, h);
    const double scale = W(0.0).value;
    for (const double q : {0.05, 0.2, 0.32, 0.4, 0.6, 0.7, 0.9, 0.98}) {
      const double r = q * h;
      const Derivatives low = W(r - step), at = W(r), high = W(r + step);
      EXPECT_NEAR(at.first, (high.value - low.value) / (2.0 * step), 1e-6 * scale) << q;
      EXPECT_NEAR(at.second, (high.first - low.first) / (2.0 * step), 1e-5 * scale) << q;
      EXPECT_NEAR(W.slope(r), -at.first / r, 1e-12 * scale) << q;
    }
    EXPECT_NEAR(W.slope(0.0), -W(0.0).second, 1e-12 * scale) << "W' = W''(0) r next to 0";
    for (const double r : {h, 1.5 * h}) {
      EXPECT_EQ(W(r).value, 0.0);
      EXPECT_EQ(W(r).second, 0.0);
      EXPECT_EQ(W.slope(r), 0.0);
    }
  }
}

TEST(Sdpd, EnergyOfADensityIsTheIntegralOfItsPressure) {
  for (const double exponent : {0.0, 2.0, 7.0}) {
    const EquationOfState state{
        .d_0 = 4.0, .modulus = 30.0, .background = 11.0, .exponent = exponent};
    EXPECT_NEAR(state.pressure(4.0), 11.0, 1e-12);
    EXPECT_NEAR((state.pressure(4.0001) - state.pressure(3.9999)) / 2e-4, 30.0 / 4.0, 1e-6);
    EXPECT_NEAR(state.energy(4.0).value, 0.0, 1e-14);
    for (const double d : {2.5, 3.9, 6.0}) {
      const Derivatives low = state.energy(d - 1e-4), at = state.energy(d),
                        high = state.energy(d + 1e-4);
      EXPECT_NEAR(at.first, state.pressure(d) / (d * d), 1e-13);
      EXPECT_NEAR(at.first, (high.value - low.value) / 2e-4, 1e-6);
      EXPECT_NEAR(at.second, (high.first - low.first) / 2e-4, 1e-6);
    }
  }
}

// Both forms are what Espanol & Revenga (2003), eq. 14, and the review's eq. 1 give, the latter with the prefactor of its dimension.
TYPED_TEST(SdpdTest, ViscositiesAndFrictionFollowFromEachOther) {
  constexpr int D = TypeParam::D;
  const SdpdFriction central = SdpdFriction::central(3.0, D),
                     classical = SdpdFriction::classical(3.0, D);
  EXPECT_NEAR(central.eta(D), 3.0, 1e-14);
  EXPECT_NEAR(central.zeta_b(D), (D == 2 ? 2.0 : 5.0 / 3.0) * 3.0, 1e-14);
  EXPECT_NEAR(classical.eta(D), 3.0, 1e-14);
  EXPECT_NEAR(classical.A, (D == 2 ? 8.0 / 5.0 : 5.0 / 3.0) * 3.0, 1e-14);
  EXPECT_NEAR(classical.zeta_b(D), D == 2 ? 2.0 / 5.0 * 3.0 : 0.0, 1e-14);
  const SdpdFriction spinning = SdpdFriction::classical(3.0, D, true);
  EXPECT_NEAR(spinning.eta(D), 3.0, 1e-14);
  EXPECT_NEAR(spinning.A, (D == 2 ? 8.0 / 3.0 : 20.0 / 7.0) * 3.0, 1e-14);
  EXPECT_NEAR(spinning.B, spinning.A, 1e-14);
  for (const SdpdFriction& f :
       {central, classical, SdpdFriction{0.7, 2.3}, spinning, SdpdFriction{0.7, 2.3, true}}) {
    const SdpdFriction back = SdpdFriction::of(f.eta(D), f.zeta_b(D), D, f.spin);
    EXPECT_NEAR(back.A, f.A, 1e-13);
    EXPECT_NEAR(back.B, f.B, 1e-13);
  }
}

/// Viscosities of a lattice of spacing 1 whose particles follow the flow u = G r.
struct LatticeViscosities {
  double eta, zeta_b;
};
template <int D>
LatticeViscosities of_lattice(const SdpdModel<D>& model, bool spin) {
  // Stress per volume of the gradient's component xy in xy, and of xx in xx and yy: longitudinal = zeta_b + 2 eta (1 - 1/d).
  double shear = 0.0, longitudinal = 0.0;
  const int n = static_cast<int>(model.cutoff()) + 1;
  std::array<int, 3> x{};
  for (x[0] = -n; x[0] <= n; ++x[0])
    for (x[1] = -n; x[1] <= n; ++x[1])
      for (x[2] = D == 3 ? -n : 0; x[2] <= (D == 3 ? n : 0); ++x[2]) {
        Vec<D> r;
        for (int c = 0; c < D; ++c) r[c] = x[static_cast<std::size_t>(c)];
        const double length = norm(r);
        if (length == 0.0 || length >= model.cutoff()) continue;
        const odpd::PairTerms t = model.pair(length, {}, {});
        const auto dissipated = [&](const Vec<D>& v) {
          const double along = dot(v, r) / length;
          return t.zeta_par * along * along + t.zeta_perp * (dot(v, v) - along * along);
        };
        Vec<D> sheared{}, stretched{};
        sheared[0] = spin ? 0.5 * r[1] : r[1];  // with w = 1/2 curl v
        if (spin) sheared[1] = 0.5 * r[0];
        stretched[0] = r[0];
        shear += 0.5 * dissipated(sheared);
        longitudinal += 0.5 * dissipated(stretched);
      }
  return {shear, longitudinal - 2.0 * shear * (1.0 - 1.0 / D)};
}

// Vectors of the register's width, of any length: nothing is written behind the last.
TYPED_TEST(SdpdTest, ManyDistancesAtOnceGiveWhatEachGives) {
  constexpr int D = TypeParam::D;
  constexpr double h = 1.7;
  for (const auto shape : sdpd_shapes) {
    const SmoothingKernel W(shape, D, h);
    const double scale = W(0.0).value;
    for (std::size_t n = 1; n < 20; ++n) {
      std::vector<double> r;
      for (std::size_t k = 0; k < n; ++k)
        r.push_back(1.1 * h * static_cast<double>(k) / static_cast<double>(n));
      std::vector<std::vector<double>> column(4, std::vector<double>(n + 1, -7.0));
      W(r, {column[0].data(), column[1].data(), column[2].data(), column[3].data()});
      for (std::size_t k = 0; k < n; ++k) {
        const Derivatives w = W(r[k]);
        EXPECT_NEAR(column[0][k], w.value, 1e-14 * scale);
        EXPECT_NEAR(column[1][k], w.first, 1e-13 * scale);
        EXPECT_NEAR(column[2][k], w.second, 1e-13 * scale);
        EXPECT_NEAR(column[3][k], W.slope(r[k]), 1e-13 * scale);
      }
      for (const auto& values : column) EXPECT_EQ(values[n], -7.0);
    }
  }
}

// The relations of A and B are those of many neighbours: 1300 in 2D, 5600 in 3D.
TYPED_TEST(SdpdTest, LatticeOfManyNeighboursHasTheViscositiesAskedFor) {
  constexpr int D = TypeParam::D;
  const SdpdParameters p{.state = {.d_0 = 1.0}, .support = D == 2 ? 20.5 : 11.0};
  for (const SdpdFriction& f :
       {SdpdFriction::central(1.0, D), SdpdFriction::classical(1.0, D),
        SdpdFriction::of(1.0, 0.5, D), SdpdFriction{2.0, 0.0},
        SdpdFriction::classical(1.0, D, true), SdpdFriction::of(1.0, 0.5, D, true)}) {
    const LatticeViscosities v = of_lattice(SdpdModel<D>(p, 1, {f}), f.spin);
    EXPECT_NEAR(v.eta, f.eta(D), 1e-3);
    EXPECT_NEAR(v.zeta_b, f.zeta_b(D), 1e-3);
  }
}

// Kinetic theory has no structure, so it says what was asked for, and the pressure of the equation of state.
TYPED_TEST(SdpdTest, KineticTheoryReturnsWhatWasAskedFor) {
  constexpr int D = TypeParam::D;
  const SdpdParameters p{.state = {.d_0 = 4.0, .modulus = 70.0, .background = 9.0},
                         .kernel = SmoothingKernel::Shape::quintic,
                         .support = 1.4,
                         .kT = 0.5};
  const SdpdModel<D> model(p, 1, {SdpdFriction::of(3.0, 1.0, D)});
  EXPECT_EQ(model.lever_radius(), 0.0);
  const auto k = odpd::kinetic_theory<D>(odpd::pair_moments(model, 1), {1.0}, 4.0, 0.0,
                                         model.reference_state(0.0));
  EXPECT_NEAR(k.eta_friction, 3.0, 1e-9);
  EXPECT_EQ(k.eta_rotational, 0.0);
  const SdpdModel<D> spinning(p, 1, {SdpdFriction::of(3.0, 1.0, D, true)});
  EXPECT_NEAR(spinning.lever_radius(), 0.5 * std::pow(4.0, -1.0 / D), 1e-14);
  EXPECT_NEAR(odpd::kinetic_theory<D>(odpd::pair_moments(spinning, 1), {1.0}, 4.0, 0.0, {},
                                      {{spinning.lever_radius(), 0.0}})
                  .eta_friction,
              3.0, 1e-9);
  EXPECT_NEAR(k.pressure, 9.0 + 4.0 * 0.5, 1e-9);
  EXPECT_NEAR(k.bulk_modulus, 70.0 + 4.0 * 0.5, 1e-9);
  // The force of the pair at the reference density has the same pressure.
  const odpd::PairMoments m = odpd::pair_moments(model, Site{}, Site{});
  EXPECT_NEAR(16.0 * *m.virial / (2.0 * D), 9.0, 1e-8);
  // eta = 3, zeta_b = 1.
  EXPECT_NEAR(model.reference_state(0.0)->stable_step, 2.0 * (1.0 + 6.0 * (1.0 - 1.0 / D)) / 70.0,
              1e-13);
  EXPECT_GT(model.reference_state(1.0)->stable_step, model.reference_state(0.0)->stable_step);
}

template <int D>
std::shared_ptr<const odpd::PairModel<D>> model_of_keys(const std::string& more, double mass = 0.0,
                                                        double density = 4.0) {
  const Config config =
      Config::from_text("[fluid]\nmodel = \"sdpd\"\nkT = 1.0\n" + more, "case.toml");
  odpd::FluidKeys keys{.fluid = config.table("fluid"), .pairs = {}, .calibration = {}};
  keys.density = density;
  keys.mass = mass;
  const auto model = odpd::read_pair_model<D>(keys);
  config.reject_unread();
  return model;
}

double parameter(const odpd::PairModel<2>& model, const std::string& name) {
  for (const auto& [key, value] : model.parameters().values)
    if (key == name) return value;
  return std::nan("");
}

TEST(Sdpd, KeysSayWhatTheFluidShallBe) {
  const auto usual = model_of_keys<2>("eta = 2.0\nbulk_modulus = 400.0\n");
  EXPECT_DOUBLE_EQ(usual->cutoff(), 1.5) << "three spacings of 1/2";
  EXPECT_DOUBLE_EQ(parameter(*usual, "background_pressure"), 400.0);
  EXPECT_DOUBLE_EQ(parameter(*usual, "A"), 0.0);
  const auto heavy = model_of_keys<2>("eta = 2.0\nsound_speed = 5.0\nsupport = 4.0\n", 0.5);
  EXPECT_DOUBLE_EQ(parameter(*heavy, "bulk_modulus"), 4.0 * 0.5 * 25.0);
  EXPECT_DOUBLE_EQ(heavy->cutoff(), 2.0);
  const auto bulk = model_of_keys<2>("eta = 2.0\nzeta_b = 1.0\nbulk_modulus = 400.0\n");
  EXPECT_NEAR(parameter(*bulk, "zeta_b"), 1.0, 1e-13);
  const auto tait = model_of_keys<2>(
      "eta = 2.0\nform = \"classical\"\nbulk_modulus = 400.0\nequation_of_state = \"tait\"\n");
  EXPECT_DOUBLE_EQ(parameter(*tait, "tait_exponent"), 7.0);
  EXPECT_DOUBLE_EQ(parameter(*tait, "A"), 3.2);
}

TEST(Sdpd, RefusesWhatItCannotBe) {
  const auto refused = [](const std::string& keys, std::initializer_list<const char*> parts,
                          double mass = 0.0, double density = 4.0) {
    support::expect_error<odpd::ConfigError>([&] { model_of_keys<2>(keys, mass, density); }, parts);
  };
  const std::string fluid = "eta = 2.0\nbulk_modulus = 400.0\n";
  refused(fluid + "kernel = \"gauss\"\n", {"case.toml:6", "kernel", "wendland-c2"});
  refused(fluid + "kernel = \"cubic-spline\"\n", {"kernel", "pair"});
  refused(fluid + "support = 0.9\n", {"support", "neighbours"});
  refused(fluid + "a = 18.5\n", {"case.toml:6", "a", "DPD"});
  refused(fluid + "gamma = 4.5\n", {"gamma", "DPD"});
  refused(fluid + "form = \"central\"\nzeta_b = 1.0\n", {"zeta_b", "never both"});
  refused(fluid + "zeta_b = 5.0\n", {"zeta_b", "4"});
  refused(fluid + "sound_speed = 5.0\n", {"bulk_modulus", "sound_speed"}, 1.0);
  refused("eta = 2.0\nsound_speed = 5.0\n", {"sound_speed", "mass"});
  refused("eta = 2.0\n", {"bulk_modulus"});
  refused("bulk_modulus = 400.0\n", {"eta"});
  refused(fluid + "tait_exponent = 7.0\n", {"tait_exponent", "tait"});
  refused(fluid + "equation_of_state = \"tait\"\ntait_exponent = 1.0\n", {"tait_exponent", "1"});
  refused(fluid, {"density", "start file"}, 0.0, 0.0);
  refused(fluid + "Sc = 400.0\n", {"Sc"});
}

}  // namespace
