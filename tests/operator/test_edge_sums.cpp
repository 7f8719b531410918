#include <gtest/gtest.h>

#include "odpd/core/parallel.h"
#include "odpd/operator/edge_sums.h"
#include "odpd/pairs/levers.h"
#include "support/dimensions.h"
#include "support/network.h"

namespace {

using odpd::DpdModel;
using odpd::DpdParameters;
using odpd::Vec;
using support::Fluid;

DpdParameters transverse() {
  DpdParameters p;
  p.gamma_perp = 1.5;
  return p;
}

template <int D>
double energy(Fluid<D>& fluid, const DpdModel<D>& model) {
  fluid.connect(model);
  return fluid.network.u.sum();
}

template <class T>
class EdgeSumsTest : public ::testing::Test {};
TYPED_TEST_SUITE(EdgeSumsTest, support::Dimensions);

TYPED_TEST(EdgeSumsTest, AddTheForcesOfBothEnds) {
  constexpr int D = TypeParam::D;
  Fluid<D> fluid(3.0, true, 90, 3, 0.7);
  fluid.connect(DpdModel<D>(1, {transverse()}));
  const auto& n = fluid.network;
  const auto edges = static_cast<std::size_t>(n.size());
  const auto on_edge = support::random_vectors<D>(edges, 1);
  const auto velocity = support::random_vectors<D>(90, 2);
  const auto before = support::random_vectors<D>(90, 3);
  std::vector<Vec<D>> expected = before;
  std::vector<Vec<D>> conservative(90), friction(90);
  for (std::size_t k = 0; k < edges; ++k) {
    const auto i = static_cast<std::size_t>(n.i[k]), j = static_cast<std::size_t>(n.j[k]);
    expected[i] += on_edge[k];
    expected[j] -= on_edge[k];
    conservative[i] += n.f_c[k] * n.e[k];
    conservative[j] -= n.f_c[k] * n.e[k];
    const Vec<D> slip = velocity[i] - velocity[j];
    const Vec<D> along = dot(slip, n.e[k]) * n.e[k];
    const Vec<D> drag = n.zeta_par[k] * along + n.zeta_perp[k] * (slip - along);
    friction[i] -= drag;
    friction[j] += drag;
  }
  std::vector<Vec<D>> sum = before, c(90), f(90);
  odpd::add_edge_forces<D>(n, on_edge, sum);
  odpd::add_conservative_forces(n, c);
  odpd::add_friction_forces<D>(n, velocity, f);
  for (std::size_t i = 0; i < 90; ++i) {
    EXPECT_NEAR(norm(sum[i] - expected[i]), 0.0, 1e-12);
    EXPECT_NEAR(norm(c[i] - conservative[i]), 0.0, 1e-11);
    EXPECT_NEAR(norm(f[i] - friction[i]), 0.0, 1e-12);
  }
}

// Force and Laplacian of one particle from central differences of the total energy. s_bar = 3 keeps
// the third derivatives bounded across the cutoff; both differences then err by less than 1e-4.
TYPED_TEST(EdgeSumsTest, ForceAndLaplacianAreDerivativesOfTheEnergy) {
  constexpr int D = TypeParam::D;
  DpdParameters p;
  p.s_bar = 3.0;
  const DpdModel<D> model(1, {p});
  Fluid<D> fluid(2.6, true, D == 2 ? 25 : 60, 3);
  const double u = energy(fluid, model);
  std::vector<Vec<D>> force(fluid.particles.position.size());
  std::vector<double> laplacian(force.size(), 0.0);
  odpd::add_conservative_forces(fluid.network, force);
  odpd::add_laplacian(fluid.network, laplacian);
  constexpr double h = 1e-4;
  for (const std::size_t i : {0u, 7u, 19u}) {
    const Vec<D> r = fluid.particles.position[i];
    double curvature = 0.0;
    for (int c = 0; c < D; ++c) {
      std::array<double, 2> side{};
      for (const std::size_t s : {0u, 1u}) {
        fluid.particles.position[i] = r;
        fluid.particles.position[i][c] += s == 0 ? -h : h;
        fluid.box.wrap(fluid.particles.position[i]);
        side[s] = energy(fluid, model);
      }
      fluid.particles.position[i] = r;
      EXPECT_NEAR(force[i][c], -(side[1] - side[0]) / (2.0 * h), 1e-4);
      curvature += (side[1] - 2.0 * u + side[0]) / (h * h);
    }
    EXPECT_NEAR(laplacian[i], curvature, 1e-4 * (1.0 + std::abs(curvature)));
  }
}

TYPED_TEST(EdgeSumsTest, HaveTheSameBitsOnAnyThreadCount) {
  constexpr int D = TypeParam::D;
  Fluid<D> fluid(D == 2 ? 15.0 : 7.0, true, 1200, 2);
  fluid.connect(DpdModel<D>(1, {transverse()}));
  const auto velocity = support::random_vectors<D>(1200, 2);
  std::vector<Vec<D>> first;
  for (const int threads : {1, 2, 3}) {
    odpd::set_threads(threads, 0);
    std::vector<Vec<D>> force(1200);
    odpd::add_conservative_forces(fluid.network, force);
    odpd::add_friction_forces<D>(fluid.network, velocity, force);
    odpd::set_threads(1, 0);
    if (threads == 1) first = force;
    EXPECT_EQ(force, first);
  }
}

// The sums read the edges as they lie, or through the index where they are not ordered: in the same order for each particle.
TYPED_TEST(EdgeSumsTest, HaveTheSameBitsWithAndWithoutOrderedRows) {
  constexpr int D = TypeParam::D;
  Fluid<D> fluid(D == 2 ? 15.0 : 7.0, true, 1200, 2);
  fluid.connect(DpdModel<D>(1, {transverse()}));
  const auto velocity = support::random_vectors<D>(1200, 2);
  std::vector<std::vector<Vec<D>>> forces;
  for (const bool ordered : {true, false}) {
    EXPECT_EQ(fluid.network.first.empty(), !ordered);
    std::vector<Vec<D>> force(1200);
    odpd::add_conservative_forces(fluid.network, force);
    odpd::add_friction_forces<D>(fluid.network, velocity, force);
    odpd::add_spring_forces<D>(fluid.network, velocity, force);
    forces.push_back(force);
    const auto start = fluid.network.start;
    const auto edge = fluid.network.edge;
    fluid.network.index_edges();
    EXPECT_EQ(fluid.network.start, start);
    EXPECT_EQ(fluid.network.edge, edge);
  }
  EXPECT_EQ(forces[0], forces[1]);
}

TYPED_TEST(EdgeSumsTest, FrictionOfKnownParticlesIsThatOfTheirMotionAlone) {
  constexpr int D = TypeParam::D;
  Fluid<D> fluid(5.0, true, D == 2 ? 120 : 500, 2, 1.0);
  fluid.connect(DpdModel<D>(1, {transverse()}));
  const std::size_t n = fluid.particles.position.size();
  auto velocity = support::random_vectors<D>(n, 2);
  std::vector<std::int32_t> known;
  auto velocity_of_known = velocity;
  for (std::size_t i = 0; i < n; ++i) {
    if (fluid.particles.is_free(i)) {
      velocity_of_known[i] = Vec<D>{};
    } else {
      known.push_back(static_cast<std::int32_t>(i));
    }
  }
  std::vector<Vec<D>> all(n), some(n);
  odpd::add_friction_forces<D>(fluid.network, velocity_of_known, all);
  odpd::add_known_friction<D>(fluid.network, known, velocity, some);
  std::size_t moved = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (!fluid.particles.is_free(i)) continue;
    EXPECT_EQ(some[i], all[i]);
    moved += norm(all[i]) > 0.0 ? 1 : 0;
  }
  EXPECT_GT(moved, 10u);
}

// The same where particles spin: force and torque, with levers of both ends.
TYPED_TEST(EdgeSumsTest, FrictionOfKnownSpinsIsThatOfTheirMotionAlone) {
  constexpr int D = TypeParam::D;
  Fluid<D> fluid(5.0, true, D == 2 ? 120 : 500, 2, 1.0);
  const std::size_t n = fluid.particles.position.size();
  fluid.particles.spin_of_species = {{.lever_radius = 0.3}, {.lever_radius = 0.8}};
  for (std::size_t i = 0; i < n; ++i) fluid.particles.species[i] = static_cast<int>(i % 2);
  fluid.connect(DpdModel<D>(2, std::vector(4, transverse())));
  odpd::write_levers(fluid.particles, fluid.network);
  auto velocity = support::random_vectors<D>(n, 2), spin = support::random_vectors<D>(n, 3);
  std::vector<std::int32_t> known;
  for (std::size_t i = 0; i < n; ++i) {
    if (fluid.particles.is_free(i)) {
      velocity[i] = spin[i] = Vec<D>{};
    } else {
      known.push_back(static_cast<std::int32_t>(i));
    }
  }
  std::vector<Vec<D>> all(n), some(n), all_torques(n), some_torques(n);
  odpd::add_friction_forces<D>(fluid.network, velocity, all, spin);
  odpd::add_friction_torques<D>(fluid.network, velocity, spin, all_torques);
  odpd::add_known_friction<D>(fluid.network, known, velocity, spin, some, some_torques);
  double turned = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    if (!fluid.particles.is_free(i)) continue;
    EXPECT_LT(norm(some[i] - all[i]), 1e-13);
    EXPECT_LT(norm(some_torques[i] - all_torques[i]), 1e-13);
    turned += norm(all_torques[i]);
  }
  EXPECT_GT(turned, 1.0);
}

}  // namespace
