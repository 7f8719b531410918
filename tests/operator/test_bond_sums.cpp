// Sums over edges with bonds among them, against brute force and the derivatives of the energy.
#include <gtest/gtest.h>

#include "odpd/core/parallel.h"
#include "odpd/operator/edge_sums.h"
#include "odpd/operator/resistance.h"
#include "odpd/pairs/bonds.h"
#include "odpd/pairs/edge_writer.h"
#include "support/dimensions.h"
#include "support/network.h"

namespace {

using odpd::Vec;

// Harmonic and fene bonds between neighbours in identity, up to half the box long.
template <int D>
odpd::BondedModel<D> bonded_fluid(support::Fluid<D>& fluid, int bonds) {
  std::vector<odpd::Bond> list;
  for (std::int64_t k = 0; k < bonds; ++k)
    list.push_back({2 * k,
                    2 * k + 1,
                    {.law = k % 2 == 0 ? odpd::BondLaw::harmonic : odpd::BondLaw::fene,
                     .H = 30.0,
                     .r_0 = 0.5,
                     .r_max = 2.0}});
  list.push_back({0, 2 * bonds, {.H = 20.0, .r_0 = 0.3}});
  for (const auto& bond : list) {
    auto& r = fluid.particles.position;
    auto& end = r[static_cast<std::size_t>(bond.j)];
    end = r[static_cast<std::size_t>(bond.i)] + (0.3 + 0.02 * static_cast<double>(bond.i % 40)) *
                                                    odpd::overlap_direction<D>(bond.i, bond.j);
    fluid.box.wrap(end);
  }
  return {std::make_unique<odpd::DpdModel<D>>(
              1, std::vector{odpd::DpdParameters{.s_bar = 3.0, .gamma_perp = 1.5}}),
          list};
}

template <class T>
class BondSumsTest : public ::testing::Test {};
TYPED_TEST_SUITE(BondSumsTest, support::Dimensions);

TYPED_TEST(BondSumsTest, AddTheForcesOfBothEnds) {
  constexpr int D = TypeParam::D;
  support::Fluid<D> fluid(3.0, true, 90, 3);
  const auto model = bonded_fluid(fluid, 20);
  fluid.particles.reorder(support::random_order(90, 4));
  fluid.connect(model);
  const auto& n = fluid.network;
  const auto edges = static_cast<std::size_t>(n.size());
  ASSERT_EQ(n.bonds, 21);
  const auto on_edge = support::random_vectors<D>(edges, 1);
  const auto velocity = support::random_vectors<D>(90, 2);
  std::vector<Vec<D>> expected(90), conservative(90), spring(90), bonds(90), friction(90);
  std::vector<double> curvature(90);
  for (std::size_t k = 0; k < edges; ++k) {
    const auto i = static_cast<std::size_t>(n.i[k]), j = static_cast<std::size_t>(n.j[k]);
    const Vec<D> slip = velocity[i] - velocity[j];
    const Vec<D> along = dot(slip, n.e[k]) * n.e[k];
    const auto add = [&](std::vector<Vec<D>>& sum, const Vec<D>& f) {
      sum[i] += f;
      sum[j] -= f;
    };
    add(expected, on_edge[k]);
    add(conservative, n.f_c[k] * n.e[k]);
    add(spring, -n.k_c[k] * along);
    if (k >= static_cast<std::size_t>(n.pairs())) add(bonds, -n.k_c[k] * along);
    add(friction, -n.zeta_par[k] * along - n.zeta_perp[k] * (slip - along));
    for (const std::size_t p : {i, j}) curvature[p] += n.k_c[k] - (D - 1) * n.f_c[k] / n.r[k];
  }
  const auto expect_sum = [](const std::vector<Vec<D>>& wanted, const auto& add) {
    std::vector<Vec<D>> sum(90);
    add(sum);
    for (std::size_t i = 0; i < 90; ++i) EXPECT_NEAR(norm(sum[i] - wanted[i]), 0.0, 1e-10);
  };
  expect_sum(expected, [&](auto& f) { odpd::add_edge_forces<D>(n, on_edge, f); });
  expect_sum(conservative, [&](auto& f) { odpd::add_conservative_forces(n, f); });
  expect_sum(spring, [&](auto& f) { odpd::add_spring_forces<D>(n, velocity, f); });
  expect_sum(bonds, [&](auto& f) { odpd::add_bond_springs<D>(n, velocity, f); });
  expect_sum(friction, [&](auto& f) { odpd::add_friction_forces<D>(n, velocity, f); });
  std::vector<double> laplacian(90);
  odpd::add_laplacian(n, laplacian);
  for (std::size_t i = 0; i < 90; ++i)
    EXPECT_NEAR(laplacian[i], curvature[i], 1e-10 * (1.0 + std::abs(curvature[i])));
  // R + t_bond K_bonds as an operator.
  const odpd::DofMap<D> dofs(fluid.particles);
  odpd::Resistance<D> resistance(fluid.box);
  resistance.rebuild(n, dofs, fluid.particles, fluid.particles.position, 0.0, 0.0, 0.25);
  std::vector<double> x, y(90 * D);
  for (const Vec<D>& v : velocity) x.insert(x.end(), v.x.begin(), v.x.end());
  resistance.apply(x, y);
  for (std::size_t i = 0; i < 90; ++i)
    for (std::size_t c = 0; c < D; ++c)
      EXPECT_NEAR(y[i * D + c], -friction[i].x[c] - 0.25 * bonds[i].x[c], 1e-10);
}

// Central differences of the total energy, also across the periodic boundary.
TYPED_TEST(BondSumsTest, ForceAndLaplacianAreDerivativesOfTheEnergy) {
  constexpr int D = TypeParam::D;
  support::Fluid<D> fluid(2.6, true, D == 2 ? 25 : 60, 3);
  const auto model = bonded_fluid(fluid, 5);
  // Bond 4-5 crosses it.
  fluid.particles.position[4] = support::uniform_vec<D>(0.1);
  fluid.particles.position[5] = support::uniform_vec<D>(2.4);
  const auto energy = [&] {
    fluid.connect(model);
    return fluid.network.u.sum();
  };
  const double u = energy();
  std::vector<Vec<D>> force(fluid.particles.position.size());
  std::vector<double> laplacian(force.size(), 0.0);
  odpd::add_conservative_forces(fluid.network, force);
  odpd::add_laplacian(fluid.network, laplacian);
  constexpr double h = 1e-4;
  for (const std::size_t i : {0u, 2u, 3u, 4u, 5u}) {
    const Vec<D> r = fluid.particles.position[i];
    double curvature = 0.0;
    for (int c = 0; c < D; ++c) {
      std::array<double, 2> side{};
      for (const std::size_t s : {0u, 1u}) {
        fluid.particles.position[i] = r;
        fluid.particles.position[i][c] += s == 0 ? -h : h;
        fluid.box.wrap(fluid.particles.position[i]);
        side[s] = energy();
      }
      fluid.particles.position[i] = r;
      EXPECT_NEAR(force[i][c], -(side[1] - side[0]) / (2.0 * h), 1e-4);
      curvature += (side[1] - 2.0 * u + side[0]) / (h * h);
    }
    EXPECT_NEAR(laplacian[i], curvature, 2e-4 * (1.0 + std::abs(curvature)));
  }
}

TYPED_TEST(BondSumsTest, HaveTheSameBitsOnAnyThreadCountAndInAnyRows) {
  constexpr int D = TypeParam::D;
  support::Fluid<D> fluid(D == 2 ? 15.0 : 7.0, true, 1200, 2);
  const auto model = bonded_fluid(fluid, 500);
  const auto velocity = support::random_vectors<D>(1200, 2);
  std::vector<Vec<D>> first;
  for (const int threads : {1, 2, 3, 0}) {
    odpd::set_threads(std::max(threads, 1), 0);
    fluid.connect(model);
    if (threads == 0) fluid.network.index_edges();
    std::vector<Vec<D>> force(1200);
    odpd::add_conservative_forces(fluid.network, force);
    odpd::add_friction_forces<D>(fluid.network, velocity, force);
    odpd::add_spring_forces<D>(fluid.network, velocity, force);
    odpd::set_threads(1, 0);
    if (threads == 1) first = force;
    EXPECT_EQ(force, first);
  }
}

}  // namespace
