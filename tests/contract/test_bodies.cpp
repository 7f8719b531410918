// What a scene with obstacles and rigid bodies owes: the system is P^T R P, its noise has that covariance, and every solver
// finds the same motion.
#include <gtest/gtest.h>

#include <cmath>

#include "contract.h"
#include "odpd/solvers/solver.h"

namespace {

using contract::Geometry;
using contract::Model;
using odpd::Vec;

class Bodies : public ::testing::TestWithParam<std::tuple<Model, Geometry, int>> {
 protected:
  template <class Check>
  void run(const Check& check) const {
    const auto [model, geometry, dimension] = GetParam();
    if (dimension == 2) {
      check(contract::instant_of<2>(model, geometry, 4.0));
    } else {
      check(contract::instant_of<3>(model, geometry, 3.7));
    }
  }
};

INSTANTIATE_TEST_SUITE_P(All, Bodies,
                         ::testing::Combine(::testing::Values(Model::central, Model::transverse),
                                            ::testing::Values(Geometry::obstacles,
                                                              Geometry::suspension, Geometry::rods,
                                                              Geometry::sheared),
                                            ::testing::Values(2, 3)),
                         [](const auto& test) {
                           return contract::name(std::get<0>(test.param)) + "_" +
                                  contract::name(std::get<1>(test.param)) + "_" +
                                  std::to_string(std::get<2>(test.param)) + "D";
                         });

// P by its definition, from poses and the unknowns of `system`, not by DofMap.
template <int D>
std::vector<Vec<D>> rigid_velocities(const contract::Instant<D>& instant, std::vector<double> x) {
  instant.rigid().unscale_velocity(x);
  const auto& particles = instant.scene.particles();
  const odpd::DofMap<D> dofs(particles);
  const auto bodies = static_cast<std::size_t>(dofs.bodies());
  std::vector<Vec<D>> v(particles.position.size());
  std::size_t node = bodies;
  for (std::size_t i = 0; i < v.size(); ++i)
    if (particles.is_free(i)) {
      for (std::size_t c = 0; c < D; ++c) v[i].x[c] = x[node * D + c];
      ++node;
    }
  for (std::size_t b = 0; b < bodies; ++b)
    for (std::size_t k = 0; k < particles.bodies[b].members.size(); ++k) {
      const auto& body = particles.bodies[b];
      const Vec<D> a = body.pose.orientation.turn(body.frame[k]);
      Vec<D> w;
      for (std::size_t c = 0; c < D; ++c) w.x[c] = x[b * D + c];
      Vec<D>& u = v[static_cast<std::size_t>(
          particles.index_of_id()[static_cast<std::size_t>(body.members[k])])];
      for (std::size_t c = 0; c < D; ++c) u.x[c] = x[(node + b) * D + c];
      if constexpr (D == 2) {
        u += Vec<2>{{-w[0] * a[1], w[0] * a[0]}};
      } else {
        u += Vec<3>{
            {w[1] * a[2] - w[2] * a[1], w[2] * a[0] - w[0] * a[2], w[0] * a[1] - w[1] * a[0]}};
      }
    }
  return v;
}

// What x and y have in common along turns that move nobody.
template <int D>
double unused_part(const contract::Instant<D>& instant, const std::vector<double>& x,
                   const std::vector<double>& y) {
  const odpd::RigidMap<D>& map = instant.rigid().map();
  double sum = 0.0;
  for (std::size_t b = 0; b < static_cast<std::size_t>(map.bodies()); ++b)
    for (std::size_t row = 0; row < D; ++row)
      for (std::size_t col = 0; col < D; ++col)
        sum += x[b * D + row] * map.unused(b)[row * D + col] * y[b * D + col];
  return sum;
}

// So norms are those of velocities and forces of particles, in the same units whatever the body.
TEST_P(Bodies, UnknownsMapOrthonormallyToParticles) {
  run([&]<int D>(const contract::Instant<D>& instant) {
    const auto n = static_cast<std::size_t>(instant.system->size());
    const auto x = support::random_numbers(n, 3), y = support::random_numbers(n, 4);
    const auto vx = rigid_velocities(instant, x), vy = rigid_velocities(instant, y);
    double product = unused_part(instant, x, y);
    for (std::size_t i = 0; i < vx.size(); ++i) product += dot(vx[i], vy[i]);
    EXPECT_NEAR(product, support::dot(x, y), 1e-12 * support::norm(x) * support::norm(y));
    // The transpose: power is the same either way.
    std::vector<double> load, kept = x;
    odpd::DofMap<D>(instant.scene.particles()).gather(instant.stage.arms, vy, load);
    instant.rigid().scale_load(load);
    double power = 0.0;
    for (std::size_t i = 0; i < vx.size(); ++i) power += dot(vx[i], vy[i]);
    EXPECT_NEAR(support::dot(x, load), power, 1e-12 * support::norm(x) * support::norm(y));
    // Back and forth.
    instant.rigid().unscale_velocity(kept);
    instant.rigid().scale_velocity(kept);
    double lost = 0.0, expected = unused_part(instant, x, x);
    for (std::size_t k = 0; k < n; ++k) lost += (kept[k] - x[k]) * (kept[k] - x[k]);
    EXPECT_NEAR(lost, expected, 1e-12 * support::dot(x, x));
  });
}

TEST_P(Bodies, TheSystemIsPTRP) {
  run([&]<int D>(const contract::Instant<D>& instant) {
    const odpd::System& system = *instant.system;
    const auto n = static_cast<std::size_t>(system.size());
    ASSERT_EQ(system.nodes(), instant.scene.particles().free_count() + 4);
    auto x = support::random_numbers(n, 1), y = support::random_numbers(n, 2);
    const auto ax = contract::product(system, x);
    // y . A x = P y . R P x, and the unused components stand alone.
    const double unused = unused_part(instant, x, y);
    std::vector<Vec<D>> force(instant.stage.position.size());
    const auto vx = rigid_velocities(instant, x), vy = rigid_velocities(instant, y);
    odpd::add_friction_forces<D>(instant.stage.network, vx, force);
    double expected = unused;
    for (std::size_t i = 0; i < force.size(); ++i) expected -= dot(vy[i], force[i]);
    EXPECT_NEAR(support::dot(y, ax), expected, 1e-11 * support::norm(ax) * support::norm(y));
    // The assembled matrix and its diagonal blocks say the same.
    const odpd::BlockCsr& m = system.matrix();
    std::vector<double> mx(n, 0.0), blocks(n * D);
    system.block_diagonal(blocks);
    for (std::size_t row = 0; row < static_cast<std::size_t>(m.rows); ++row)
      for (auto k = static_cast<std::size_t>(m.start[row]);
           k < static_cast<std::size_t>(m.start[row + 1]); ++k) {
        const auto column = static_cast<std::size_t>(m.column[k]);
        for (std::size_t a = 0; a < D; ++a)
          for (std::size_t c = 0; c < D; ++c) {
            mx[row * D + a] += m.value[(k * D + a) * D + c] * x[column * D + c];
            if (row == column) {
              EXPECT_NEAR(m.value[(k * D + a) * D + c], blocks[(row * D + a) * D + c], 1e-11);
            }
          }
      }
    for (std::size_t k = 0; k < n; ++k) EXPECT_NEAR(mx[k], ax[k], 1e-11);
  });
}

TEST_P(Bodies, NoiseHasTheCovarianceOfFluctuationDissipation) {
  if (std::get<0>(GetParam()) != Model::central) GTEST_SKIP() << "one model suffices";
  run([&]<int D>(const contract::Instant<D>& instant) {
    contract::expect_noise_covariance(instant, *instant.system);
  });
}

TEST_P(Bodies, EverySolverFindsTheSameMotion) {
  run([&]<int D>(const contract::Instant<D>& instant) {
    std::vector<double> exact(instant.load.size(), 0.0);
    const auto factor = odpd::make_solver({.name = "cholmod", .tolerance = 1e-13});
    factor->bind(*instant.system);
    ASSERT_TRUE(factor->solve(instant.load, exact).converged);
    for (const std::string& name : odpd::available_solvers()) {
      if (name == "picard-deflated") continue;  // solves another problem
      odpd::SolverOptions options;
      options.name = name;
      options.tolerance = name == "picard" ? 1e-6 : 1e-12;
      options.max_iterations = name == "picard" ? 200000 : 5000;
      const auto solver = odpd::make_solver(options);
      solver->bind(*instant.system);
      std::vector<double> x(instant.load.size(), 0.0);
      const odpd::SolveReport report = solver->solve(instant.load, x);
      ASSERT_TRUE(report.converged) << name << ": " << report.failure;
      EXPECT_LE(contract::true_residual(*instant.system, instant.load, x), 1.01 * options.tolerance)
          << name;
      double difference = 0.0;
      for (std::size_t k = 0; k < x.size(); ++k)
        difference += (x[k] - exact[k]) * (x[k] - exact[k]);
      EXPECT_LT(std::sqrt(difference), (name == "picard" ? 2e-3 : 1e-10) * support::norm(exact))
          << name;
      EXPECT_NEAR(unused_part(instant, x, x), 0.0, 1e-14 * support::dot(x, x));
    }
  });
}

// The forces of the constituents' edges, at the solved velocities, add up to the load on each body: force and torque
// balance, in words of particles.
TEST_P(Bodies, ForceAndTorqueBalance) {
  run([&]<int D>(const contract::Instant<D>& instant) {
    odpd::SolverOptions options;
    options.name = "cholmod";
    options.tolerance = 1e-12;
    const auto solver = odpd::make_solver(options);
    solver->bind(*instant.system);
    std::vector<double> x(instant.load.size(), 0.0);
    ASSERT_TRUE(solver->solve(instant.load, x).converged);
    std::vector<Vec<D>> velocity = rigid_velocities(instant, x);
    const auto& particles = instant.scene.particles();
    for (std::size_t i = 0; i < velocity.size(); ++i)
      if (particles.is_known(i)) velocity[i] = instant.stage.velocity[i];
    std::vector<Vec<D>> force(velocity.size()), on_edges;
    odpd::draw_edge_noise(instant.stage.network, particles, 1, 3, 0.01, on_edges);
    odpd::add_conservative_forces(instant.stage.network, force);
    odpd::add_friction_forces<D>(instant.stage.network, velocity, force);
    odpd::add_sliding_friction(instant.stage.network, force);
    odpd::add_edge_forces<D>(instant.stage.network, on_edges, force);
    instant.scene.add_potential_forces(particles, instant.stage.position, force);
    instant.scene.add_driving_forces(particles, particles.position, 0.0, force);
    for (std::size_t b = 0; b < 2; ++b) {
      const auto& body = particles.bodies[b];
      Vec<D> f = instant.scene.body_load(b, 0.0).force, t = instant.scene.body_load(b, 0.0).torque;
      double size = 0.0;
      std::vector<Vec<D>> arms;
      for (std::size_t k = 0; k < body.members.size(); ++k) {
        const auto p = static_cast<std::size_t>(
            particles.index_of_id()[static_cast<std::size_t>(body.members[k])]);
        arms.push_back(body.pose.orientation.turn(body.frame[k]));
        f += force[p];
        t += odpd::torque(arms.back(), force[p]);
        size += norm(force[p]);
      }
      if (odpd::rotations<D>(arms) < odpd::rotation_components<D>) {
        // A rod does not turn about its line: what the torque on it has along it is not balanced.
        const Vec<D> u = (1.0 / norm(arms[0])) * arms[0];
        if (norm(instant.scene.body_load(b, 0.0).torque) > 0.0) {
          EXPECT_GT(std::abs(dot(u, t)), 0.1);
        }
        t -= dot(u, t) * u;
      }
      EXPECT_GT(size, 10.0);
      EXPECT_LT(norm(f), 1e-8 * size);
      EXPECT_LT(norm(t), 1e-8 * size);
    }
  });
}

}  // namespace
