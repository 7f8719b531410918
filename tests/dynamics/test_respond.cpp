// StepRecord::respond: solves that observers ask for.
#include <gtest/gtest.h>

#include <cmath>

#include "odpd/operator/edge_sums.h"
#include "support/dimensions.h"
#include "support/swarm.h"

namespace odpd {
namespace {

using support::Swarm;

template <class Dimension>
class Respond : public ::testing::Test {};
TYPED_TEST_SUITE(Respond, support::Dimensions);

// Friction balances the forces but for their mean, on free particles and, with torques, on bodies, at the step's start though the
// particles have moved on.
TYPED_TEST(Respond, BalancesTheForces) {
  constexpr int D = TypeParam::D;
  Swarm<D> swarm(DpdParameters{}, 0.0, 5, 1e-10);
  const auto integrator = make_integrator<D>("trapezoidal");
  const StepRecord<D>& record = integrator->step(*swarm.dynamics, Clock{.dt = 0.01});
  std::vector<std::vector<Vec<D>>> f, v;
  for (const std::uint64_t seed : {1u, 2u}) {
    f.push_back(support::random_vectors<D>(record.v_mid.size(), seed));
    v.push_back(record.respond({f.back()}, 0.0).velocity);
    std::vector<Vec<D>> left = f.back();
    Vec<D> mean{};
    for (const auto& x : left) mean += (1.0 / static_cast<double>(left.size())) * x;
    for (auto& x : left) x -= mean;
    add_friction_forces<D>(record.start.network, v.back(), left);
    std::vector<double> unbalanced;
    swarm.dynamics->dofs().gather(record.start.arms, left, unbalanced);
    for (const double x : unbalanced) EXPECT_NEAR(x, 0.0, 1e-7);
  }
  double there = 0.0, back = 0.0;
  for (std::size_t i = 0; i < f[0].size(); ++i) {
    there += dot(f[0][i], v[1][i]);
    back += dot(f[1][i], v[0][i]);
  }
  EXPECT_NEAR(there, back, 1e-7 * std::abs(there)) << "reciprocal";
}

// Who asks changes nothing: not even a preconditioner that ages by how fast solves converge.
TYPED_TEST(Respond, LeavesTheRunAsItIs) {
  constexpr int D = TypeParam::D;
  std::vector<std::vector<Vec<D>>> ends;
  for (const bool asked : {false, true}) {
    Swarm<D> swarm(DpdParameters{.cutoff = 1.4}, 0.0, D == 2 ? 14 : 6);
    swarm.dynamics = std::make_unique<Dynamics<D>>(
        swarm.box, swarm.particles, swarm.model, swarm.nothing,
        make_solver({.name = "pcg", .tolerance = 1e-6, .preconditioner = "multilevel"}),
        DynamicsSettings{.reorder_every = 7});
    const auto integrator = make_integrator<D>("trapezoidal");
    for (Clock clock{.dt = 0.02, .total_steps = 40}; !clock.finished(); clock.advance()) {
      const StepRecord<D>& record = integrator->step(*swarm.dynamics, clock);
      if (!asked) continue;
      // The longest wave: what the grid is best at.
      std::vector<Vec<D>> force(record.v_mid.size());
      for (std::size_t i = 0; i < force.size(); ++i)
        force[i][1] =
            std::cos(2.0 * std::acos(-1.0) * record.start.position[i][0] / swarm.box.size[0]);
      record.respond({force}, 1e-3);
    }
    ends.push_back(swarm.positions());
  }
  EXPECT_EQ(ends[0], ends[1]);
}

TEST(RespondOnly, OfSchemesWithTwoStagesOnly) {
  for (const std::string& name : integrator_names()) {
    if (integrator_traits(name).masses == Masses::positive || !integrator_traits(name).in_time)
      continue;
    Swarm<2> swarm(DpdParameters{}, 0.0, 5);
    const auto integrator = make_integrator<2>(name);
    integrator->prepare(*swarm.dynamics);
    const StepRecord<2>& record = integrator->step(*swarm.dynamics, Clock{.dt = 0.001});
    EXPECT_EQ(static_cast<bool>(record.respond), integrator_traits(name).two_stages) << name;
    EXPECT_EQ(record.has_corrector(), integrator_traits(name).two_stages) << name;
  }
}

}  // namespace
}  // namespace odpd
