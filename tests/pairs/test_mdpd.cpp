// Many-body DPD: its force in the usual form, its densities, its keys.
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "odpd/core/quadrature.h"
#include "odpd/pairs/mdpd.h"
#include "odpd/pairs/registry.h"
#include "support/density_toy.h"
#include "support/dimensions.h"
#include "support/errors.h"

namespace {

using odpd::Config;
using odpd::MdpdFluid;
using odpd::MdpdModel;
using odpd::MdpdPair;

template <class T>
class MdpdTest : public ::testing::Test {};
TYPED_TEST_SUITE(MdpdTest, support::Dimensions);

TYPED_TEST(MdpdTest, WeightHasTheIntegralOne) {
  constexpr int D = TypeParam::D;
  const MdpdModel<D> model({.B = 25.0, .r_d = 0.75}, 1, {MdpdPair{}}, 6.0);
  const auto integral = odpd::integrate<1>(
      [&](double r) {
        const double shell = (D == 2 ? 2.0 : 4.0 * r) * std::numbers::pi * r;
        return std::array{shell * model.densities()->weight(r, {}, {}).value};
      },
      0.0, 0.75);
  EXPECT_NEAR(integral[0], 1.0, 1e-12);
  EXPECT_EQ(model.densities()->self({}), 0.0);
}

// f_c = A w_c + B (rho_i + rho_j) w_d, with b in the second part too (Warren 2003, eq. 1).
TYPED_TEST(MdpdTest, ForceHasTheUsualForm) {
  constexpr int D = TypeParam::D;
  support::Crowd<D> crowd(D == 2 ? 90 : 150, 3.2, true);
  MdpdPair like, unlike;
  unlike.A = -20.0;
  unlike.b = 0.7;
  unlike.friction.cutoff = 0.9;
  const MdpdFluid fluid{.B = 25.0, .r_d = 0.75};
  crowd.connect(MdpdModel<D>(fluid, 2, {like, unlike, unlike, like}, 5.0));
  const auto& n = crowd.network;
  int between = 0;
  for (std::size_t k = 0; k < n.i.size(); ++k) {
    const auto i = static_cast<std::size_t>(n.i[k]), j = static_cast<std::size_t>(n.j[k]);
    const MdpdPair& of = crowd.particles.species[i] == crowd.particles.species[j] ? like : unlike;
    between += of == unlike ? 1 : 0;
    const auto w = [&](double end) { return std::max(0.0, 1.0 - n.r[k] / end); };
    const double expected = of.A * w(of.friction.cutoff) +
                            of.b * fluid.B * (n.densities.d[i] + n.densities.d[j]) * w(fluid.r_d);
    EXPECT_NEAR(n.f_c[k], expected, 1e-11 * std::max(1.0, std::abs(expected)));
  }
  EXPECT_GT(between, 50);
}

// One kind of pair, that with a core too: its friction ends the fall of w outside of the core.
TYPED_TEST(MdpdTest, FrictionOfOneKindOfPairTakesItsCore) {
  constexpr int D = TypeParam::D;
  support::Crowd<D> crowd(D == 2 ? 90 : 150, 3.2, true);
  MdpdPair with_core;
  with_core.friction.core = 0.4;
  crowd.connect(
      MdpdModel<D>({.B = 25.0, .r_d = 0.75}, 2, std::vector<MdpdPair>(4, with_core), 5.0));
  const auto& n = crowd.network;
  const odpd::FrictionParameters& f = with_core.friction;
  ASSERT_GT(n.i.size(), 50u);
  for (std::size_t k = 0; k < n.i.size(); ++k) {
    const double x = std::clamp((f.cutoff - n.r[k]) / f.width(), 0.0, 1.0);
    EXPECT_NEAR(n.zeta_par[k], f.gamma * std::pow(x, f.s), 1e-6) << n.r[k];
  }
}

std::shared_ptr<const odpd::PairModel<2>> mdpd_of_keys(const std::string& fluid,
                                                       const std::string& pair, double mass) {
  const Config config = Config::from_text(
      "[fluid]\nmodel = \"mdpd\"\nkT = 1.0\ngamma = 4.5\n" + fluid + "[[pair]]\n" + pair,
      "case.toml");
  odpd::FluidKeys keys{
      .fluid = config.table("fluid"), .pairs = {}, .species = 2, .calibration = {}};
  keys.pairs = {{config.tables("pair")[0], 0, 1}};
  keys.density = 4.0;
  keys.mass = mass;
  const auto model = odpd::read_pair_model<2>(keys);
  config.reject_unread();
  return model;
}

TEST(Mdpd, TakesItsKeysAndRefusesWhatHasNoEnergy) {
  const std::string fluid = "A = -40.0\nB = 25.0\nr_d = 0.75\n";
  EXPECT_NO_THROW(mdpd_of_keys(fluid, "A = -30.0\ncutoff = 0.9\nb = 0.5\n", 1.0));
  EXPECT_NO_THROW(mdpd_of_keys(fluid + "filled = true\n", "", 0.0));
  const auto refused = [&](const std::string& keys, const std::string& pair,
                           std::initializer_list<const char*> parts, double mass = 1.0) {
    support::expect_error<odpd::ConfigError>([&] { mdpd_of_keys(keys, pair, mass); }, parts);
  };
  refused(fluid, "", {"mass", "turning", "1.11e+03 dt^2", "filled"}, 0.0);
  refused(fluid, "B = 30.0\n", {"case.toml", "B", "no energy", "b"});
  refused(fluid, "r_d = 0.5\n", {"r_d", "no energy"});
  refused(fluid + "a = 18.5\n", "", {"a", "DPD's"});
  refused("A = -40.0\nB = -1.0\nr_d = 0.75\n", "", {"B"});
  refused("B = 25.0\nr_d = 0.75\n", "", {"A"});
  refused("A = -40.0\nB = 25.0\n", "", {"r_d"});
  refused(fluid + "eta = 1.0\n", "", {"eta", "mdpd"});
}

}  // namespace
