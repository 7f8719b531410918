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

INSTANTIATE_TEST_SUITE_P(
    All, Bodies,
    ::testing::Combine(::testing::Values(Model::central, Model::transverse, Model::spinning),
                       ::testing::Values(Geometry::obstacles, Geometry::suspension, Geometry::rods,
                                         Geometry::sheared),
                       ::testing::Values(2, 3)),
    [](const auto& test) {
      return contract::name(std::get<0>(test.param)) + "_" +
             contract::name(std::get<1>(test.param)) + "_" +
             std::to_string(std::get<2>(test.param)) + "D";
    });

// P by its definition, from poses and the unknowns of `system`, not by DofMap. Spins are empty where nobody spins.
template <int D>
odpd::ParticleMotions<D> rigid_motions(const contract::Instant<D>& instant, std::vector<double> x) {
  instant.spins().unscale_velocity(x);
  odpd::ParticleMotions<D> motions;
  std::vector<Vec<D>>&v = motions.velocity, &spin = motions.spin;
  const auto& particles = instant.scene.particles();
  const odpd::DofMap<D> dofs(particles);
  const auto bodies = static_cast<std::size_t>(dofs.bodies());
  v.resize(particles.position.size());
  spin.resize(dofs.any_spin() ? v.size() : 0);
  std::size_t of_spins = 0;
  for (std::size_t i = 0; i < spin.size(); ++i)
    if (particles.spins(i)) {
      for (std::size_t c = 0; c < D; ++c) spin[i].x[c] = x[of_spins * D + c];
      ++of_spins;
    }
  x.erase(x.begin(), x.begin() + static_cast<std::ptrdiff_t>(of_spins * D));
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
      const auto p = static_cast<std::size_t>(
          particles.index_of_id()[static_cast<std::size_t>(body.members[k])]);
      if (!spin.empty()) spin[p] = w;
      Vec<D>& u = v[p];
      for (std::size_t c = 0; c < D; ++c) u.x[c] = x[(node + b) * D + c];
      if constexpr (D == 2) {
        u += Vec<2>{{-w[0] * a[1], w[0] * a[0]}};
      } else {
        u += Vec<3>{
            {w[1] * a[2] - w[2] * a[1], w[2] * a[0] - w[0] * a[2], w[0] * a[1] - w[1] * a[0]}};
      }
    }
  return motions;
}

// What x and y have in common along turns that move nobody.
template <int D>
double unused_part(const contract::Instant<D>& instant, const std::vector<double>& x,
                   const std::vector<double>& y) {
  const odpd::RigidMap<D>& map = instant.rigid().map();
  double sum = 0.0;
  const auto front = static_cast<std::size_t>(instant.spins().spins());
  for (std::size_t s = 0; s < front; ++s)
    for (std::size_t c = odpd::rotation_components<D>; c < D; ++c)
      sum += x[s * D + c] * y[s * D + c];
  for (std::size_t b = 0; b < static_cast<std::size_t>(map.bodies()); ++b)
    for (std::size_t row = 0; row < D; ++row)
      for (std::size_t col = 0; col < D; ++col)
        sum += x[(front + b) * D + row] * map.unused(b)[row * D + col] * y[(front + b) * D + col];
  return sum;
}

// So norms are those of velocities and forces of particles, in the same units whatever the body.
TEST_P(Bodies, UnknownsMapOrthonormallyToParticles) {
  if (std::get<0>(GetParam()) == Model::spinning) GTEST_SKIP() << "spins are no velocities";
  run([&]<int D>(const contract::Instant<D>& instant) {
    const auto n = static_cast<std::size_t>(instant.system->size());
    const auto x = support::random_numbers(n, 3), y = support::random_numbers(n, 4);
    const auto vx = rigid_motions(instant, x).velocity, vy = rigid_motions(instant, y).velocity;
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
    ASSERT_EQ(system.nodes(), instant.scene.particles().free_count() + 4 + instant.spins().spins());
    auto x = support::random_numbers(n, 1), y = support::random_numbers(n, 2);
    const auto ax = contract::product(system, x);
    // y . A x = P y . R P x, and the unused components stand alone.
    const double unused = unused_part(instant, x, y);
    const auto of_x = rigid_motions(instant, x), of_y = rigid_motions(instant, y);
    std::vector<Vec<D>> force(instant.stage.position.size()), torque(of_x.spin.size());
    odpd::add_friction_forces<D>(instant.stage.network, of_x.velocity, force, of_x.spin);
    odpd::add_friction_torques<D>(instant.stage.network, of_x.velocity, of_x.spin, torque);
    double expected = unused;
    for (std::size_t i = 0; i < force.size(); ++i) expected -= dot(of_y.velocity[i], force[i]);
    for (std::size_t i = 0; i < torque.size(); ++i) expected -= dot(of_y.spin[i], torque[i]);
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
  if (std::get<0>(GetParam()) == Model::transverse) GTEST_SKIP() << "two models suffice";
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
    auto [velocity, spin] = rigid_motions(instant, x);
    const auto& particles = instant.scene.particles();
    for (std::size_t i = 0; i < velocity.size(); ++i)
      if (particles.is_known(i)) velocity[i] = instant.stage.velocity[i];
    for (std::size_t i = 0; i < spin.size(); ++i)
      if (particles.is_known(i)) spin[i] = instant.stage.spin[i];
    std::vector<Vec<D>> force(velocity.size()), torque(spin.size()), on_edges;
    odpd::draw_edge_noise(instant.stage.network, particles, 1, 3, 0.01, on_edges);
    odpd::add_conservative_forces(instant.stage.network, force);
    odpd::add_friction_forces<D>(instant.stage.network, velocity, force, spin);
    odpd::add_friction_torques<D>(instant.stage.network, velocity, spin, torque);
    odpd::add_sliding_torques<D>(instant.stage.network, torque);
    odpd::add_edge_torques<D>(instant.stage.network, on_edges, torque);
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
        if (!torque.empty()) t += torque[p];
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
