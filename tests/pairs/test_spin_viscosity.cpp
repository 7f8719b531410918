// The viscosity of random points that follow the flow, friction across lines of centres included, with and without spin.
#include <gtest/gtest.h>

#include <cmath>

#include "odpd/core/random.h"
#include "odpd/pairs/dpd.h"
#include "odpd/pairs/kinetic_theory.h"
#include "support/dimensions.h"

namespace {

using odpd::KineticTheory;
using odpd::PairNetwork;
using odpd::Spin;
using odpd::Vec;

/// Stresses of the flow v_x = y whose particles turn with the angular velocity `part` times 1/2 curl v = -1/2, and of the stretch v = r.
struct Stresses {
  double yx = 0.0, xy = 0.0;
  double turning_power = 0.0;  ///< what 1/2 curl v - w = 1 about z dissipates per volume
};

template <int D>
struct RandomPoints {
  odpd::Box<D> box;
  odpd::Particles<D> particles;
  PairNetwork<D> network;

  RandomPoints(const odpd::PairModel<D>& model, double density, double edge, std::uint64_t seed) {
    for (int c = 0; c < D; ++c)
      box.size[c] = edge, box.periodic[static_cast<std::size_t>(c)] = true;
    const odpd::CounterRandom random(seed, odpd::Stream::start_positions);
    const auto count = static_cast<std::uint64_t>(std::llround(density * std::pow(edge, D)));
    for (std::uint64_t k = 0; k < count; ++k) {
      const auto u = random.uniforms(0, 0, k, 0);
      Vec<D> r;
      for (int c = 0; c < D; ++c) r[c] = edge * u[static_cast<std::size_t>(c)];
      particles.add(r, 0);
    }
    odpd::PairList<D> list(box, model.cutoff());
    list.update(particles.position, particles.owned());
    model.write_edges(list, box, particles.position, particles, network);
  }

  Stresses sheared(double part) const {
    Stresses s;
    for (std::size_t k = 0; k < network.r.size(); ++k) {
      const Vec<D> e = network.e[k];
      const double r = network.r[k];
      const auto force = [&](const Vec<D>& slip) {
        const double along = dot(slip, e);
        return -1.0 * (network.zeta_par[k] * along * e + network.zeta_perp[k] * (slip - along * e));
      };
      // About z an angular velocity w adds r w x e, whatever the ratio of the lever arms.
      const double w = -0.5 * part;
      Vec<D> slip{}, turned{};
      slip[0] = r * e[1] + r * w * e[1];
      slip[1] = -r * w * e[0];
      turned[0] = r * e[1];
      turned[1] = -r * e[0];
      const Vec<D> f = force(slip);
      s.yx -= r * e[1] * f[0] / box.volume();
      s.xy -= r * e[0] * f[1] / box.volume();
      s.turning_power -= dot(turned, force(turned)) / box.volume();
    }
    return s;
  }
};

template <class Dim>
class SpinViscosity : public testing::Test {};
TYPED_TEST_SUITE(SpinViscosity, support::Dimensions);

// 4e5 (2D) and 5e5 (3D) pairs: standard errors of 0.3 %, of the number of pairs and their directions.
TYPED_TEST(SpinViscosity, RandomPointsInAffineFlowHaveThatOfKineticTheory) {
  constexpr int D = TypeParam::D;
  const double n = 4.0;
  const odpd::DpdParameters p{.a = 0.0, .gamma = 3.0, .gamma_perp = 5.0, .s = 0.5, .kT = 0.0};
  const auto model = odpd::make_dpd<D>(p);
  const RandomPoints<D> points(*model, n, D == 2 ? 128.0 : 24.0, 11);
  const auto theory = [&](const std::vector<Spin>& spins) {
    return odpd::kinetic_theory<D>(odpd::pair_moments(*model, 1), {1.0}, n, 1.0, {}, spins);
  };
  const KineticTheory spinning = theory({{0.5, 0.1}}), plain = theory({});
  const Stresses with = points.sheared(1.0), without = points.sheared(0.0);
  EXPECT_NEAR(with.yx, spinning.eta_friction, 0.01 * spinning.eta_friction);
  // Equal where the torques balance, here as far as points are random.
  EXPECT_NEAR(with.xy, with.yx, 0.01 * with.yx);
  EXPECT_NEAR(without.yx, plain.eta_friction, 0.01 * plain.eta_friction);
  EXPECT_GT(std::abs(without.xy - without.yx), 0.3 * without.yx);
  EXPECT_NEAR(with.turning_power, 4.0 * spinning.eta_rotational, 0.04 * spinning.eta_rotational);
  EXPECT_EQ(plain.eta_rotational, 0.0);
  EXPECT_DOUBLE_EQ(spinning.spin_relaxation, n * 0.1 / (4.0 * spinning.eta_rotational));
}

}  // namespace
