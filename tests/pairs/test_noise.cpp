#include <gtest/gtest.h>

#include <map>

#include "odpd/core/parallel.h"
#include "odpd/pairs/noise.h"
#include "support/dimensions.h"
#include "support/network.h"

namespace {

using odpd::DpdModel;
using odpd::DpdParameters;
using odpd::Vec;
using support::Fluid;

DpdParameters transverse() {
  DpdParameters p;
  p.gamma_perp = 2.0;
  return p;
}

template <int D>
std::vector<Vec<D>> draw(const Fluid<D>& fluid, std::uint64_t seed, std::uint64_t step, double dt) {
  std::vector<Vec<D>> force;
  odpd::draw_edge_noise(fluid.network, fluid.particles, seed, step, dt, force);
  return force;
}

template <class T>
class NoiseTest : public ::testing::Test {};
TYPED_TEST_SUITE(NoiseTest, support::Dimensions);

TYPED_TEST(NoiseTest, IsAFunctionOfIdentitiesAndStep) {
  constexpr int D = TypeParam::D;
  Fluid<D> fluid(3.2, true, 120, 3);
  // Two particles at one point: there e itself is a convention.
  fluid.particles.position[17] = fluid.particles.position[90];
  const DpdModel<D> model(1, {transverse()});
  using Key = std::pair<std::int64_t, std::int64_t>;
  const auto by_identity = [&] {
    fluid.connect(model);
    const auto force = draw(fluid, 5, 77, 0.01);
    std::map<Key, Vec<D>> on_lower;
    for (std::size_t k = 0; k < force.size(); ++k) {
      const auto i = fluid.particles.id[static_cast<std::size_t>(fluid.network.i[k])];
      const auto j = fluid.particles.id[static_cast<std::size_t>(fluid.network.j[k])];
      on_lower[std::minmax(i, j)] = (i < j ? 1.0 : -1.0) * force[k];
    }
    return on_lower;
  };
  const auto before = by_identity();
  for (std::uint32_t seed = 0; seed < 3; ++seed) {
    fluid.particles.reorder(support::random_order(120, seed));
    EXPECT_EQ(by_identity(), before);
  }
  EXPECT_NE(draw(fluid, 5, 78, 0.01), draw(fluid, 5, 77, 0.01)) << "another step";
  EXPECT_NE(draw(fluid, 6, 77, 0.01), draw(fluid, 5, 77, 0.01)) << "another seed";
}

TYPED_TEST(NoiseTest, HasTheSameBitsOnAnyThreadCount) {
  constexpr int D = TypeParam::D;
  Fluid<D> fluid(D == 2 ? 12.0 : 5.0, true, 600, 3);
  fluid.connect(DpdModel<D>(1, {transverse()}));
  ASSERT_GT(fluid.network.size(), 1000);
  const auto one = draw(fluid, 5, 1, 0.01);
  for (const int threads : {2, 3}) {
    odpd::set_threads(threads, 0);
    const auto many = draw(fluid, 5, 1, 0.01);
    odpd::set_threads(1, 0);
    EXPECT_EQ(many, one);
  }
}

TYPED_TEST(NoiseTest, IsZeroWithoutTemperatureAndAlongTheLineWithoutGammaPerp) {
  constexpr int D = TypeParam::D;
  Fluid<D> fluid(3.0, true, 60, 3);
  DpdParameters p;
  fluid.connect(DpdModel<D>(1, {p}));
  const auto central = draw(fluid, 1, 1, 0.01);
  for (std::size_t k = 0; k < central.size(); ++k) {
    const double along = dot(central[k], fluid.network.e[k]);
    EXPECT_NEAR(norm(central[k] - along * fluid.network.e[k]), 0.0, 1e-13 * std::abs(along));
  }
  p.kT = 0.0;
  p.gamma_perp = 1.0;
  fluid.connect(DpdModel<D>(1, {p}));
  for (const Vec<D>& force : draw(fluid, 1, 1, 0.01)) EXPECT_EQ(norm(force), 0.0);
}

// Covariance of one edge's force, 2 kT (zeta_par e e^T + zeta_perp (I - e e^T))/dt, from n draws.
// Estimator: mean of f_a f_b; standard error sqrt((C_aa C_bb + C_ab^2)/n); bound 5 of them.
TYPED_TEST(NoiseTest, CovarianceOfAnEdge) {
  constexpr int D = TypeParam::D;
  constexpr int n = 20000;
  constexpr double dt = 0.02;
  Fluid<D> fluid(4.0, true);
  fluid.particles.add(support::uniform_vec<D>(1.0), 0);
  fluid.particles.add(support::uniform_vec<D>(1.2), 0);
  fluid.particles.position[1][0] = 1.4;
  DpdParameters p = transverse();
  p.kT = 1.3;
  fluid.connect(DpdModel<D>(1, {p}));
  std::array<double, D * D> sum{};
  Vec<D> mean{};
  for (std::uint64_t step = 0; step < n; ++step) {
    const Vec<D> f = draw(fluid, 9, step, dt)[0];
    mean += (1.0 / n) * f;
    for (std::size_t k = 0; k < D * D; ++k) sum[k] += f.x[k / D] * f.x[k % D] / n;
  }
  const Vec<D>& e = fluid.network.e[0];
  const auto exact = [&](int a, int b) {
    const double along = e[a] * e[b], one = a == b ? 1.0 : 0.0;
    return 2.0 * p.kT / dt *
           (fluid.network.zeta_par[0] * along + fluid.network.zeta_perp[0] * (one - along));
  };
  for (int a = 0; a < D; ++a) {
    EXPECT_LT(std::abs(mean[a]), 5.0 * std::sqrt(exact(a, a) / n));
    for (int b = 0; b < D; ++b) {
      const double error = std::sqrt((exact(a, a) * exact(b, b) + exact(a, b) * exact(a, b)) / n);
      const double estimate = sum[static_cast<std::size_t>(a * D + b)];
      EXPECT_LT(std::abs(estimate - exact(a, b)), 5.0 * error);
      if (a != b) continue;
      EXPECT_GT(std::abs(estimate - 1.1 * exact(a, a)), 5.0 * error) << "the test has no power";
    }
  }
}

}  // namespace
