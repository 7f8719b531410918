// What trial moves change in the energy of a model with densities, against the energy by its definition before and after.
#include <gtest/gtest.h>

#include "odpd/dynamics/local_energy.h"
#include "odpd/dynamics/monte_carlo.h"
#include "odpd/pairs/bonds.h"
#include "support/density_toy.h"
#include "support/dimensions.h"
#include "support/errors.h"

namespace odpd {
namespace {

using support::Crowd;
using support::ToyModel;
using support::ToyParameters;

template <class T>
class DensityMoves : public ::testing::Test {};
TYPED_TEST_SUITE(DensityMoves, support::Dimensions);

// Single particles and bodies by turns, accepted or not: densities that were not renewed, or renewed for nothing, would show in
// the next. Two cells wide, and of many cells.
TYPED_TEST(DensityMoves, ChangeTheTotalEnergyByTheirLocalChange) {
  constexpr int D = TypeParam::D;
  for (const double edge : {3.2, 2.0}) {
    Crowd<D> crowd(D == 2 ? 60 : 110, edge);
    Particles<D>& particles = crowd.particles;
    const ToyModel<D> model({.c = 0.8, .pair = 3.0});
    const NoSurroundings<D> nothing;
    LocalEnergy<D> local(crowd.box, model, nothing, particles);
    local.sort_in();
    const DofMap<D> dofs(particles);
    const auto to = support::random_points<D>({}, crowd.box.size, 120, 9);
    double energy = crowd.energy(model);
    for (std::size_t k = 0; k < to.size(); ++k) {
      std::vector<std::int32_t> moved{static_cast<std::int32_t>(k % particles.position.size())};
      std::vector<Vec<D>> there{to[k]};
      RigidPose<D> pose = particles.bodies[0].pose;
      if (!particles.is_free(static_cast<std::size_t>(moved[0]))) {
        moved.assign(dofs.constituents(0).begin(), dofs.constituents(0).end());
        there.resize(moved.size());
        RigidMotion<D> motion;
        motion.velocity = to[k] - pose.centre;
        motion.angular[0] = 0.7;
        pose.advance(motion, 1.0, crowd.box);
        typename RigidPose<D>::Image image;
        for (std::size_t c = 0; c < moved.size(); ++c)
          place_constituent(particles.bodies[0], pose, c, crowd.box, there[c], image);
      }
      const double change = local.change(moved, there);
      std::vector<Vec<D>> before;
      for (std::size_t c = 0; c < moved.size(); ++c) {
        auto& r = particles.position[static_cast<std::size_t>(moved[c])];
        before.push_back(r);
        r = there[c];
      }
      const double after = crowd.energy(model);
      EXPECT_NEAR(change, after - energy, 1e-12 * after) << "move " << k;
      if (k % 3 == 0) {  // refused
        for (std::size_t c = 0; c < moved.size(); ++c)
          particles.position[static_cast<std::size_t>(moved[c])] = before[c];
        continue;
      }
      local.accept();
      if (moved.size() > 1) particles.bodies[0].pose = pose;
      energy = after;
    }
  }
}

// The exclusions of bonds take only the pair's own energy.
TYPED_TEST(DensityMoves, OfBondedParticles) {
  constexpr int D = TypeParam::D;
  Crowd<D> crowd(60, 3.2, true);
  const auto index = crowd.particles.index_of_id();
  const auto i = static_cast<std::size_t>(index[8]);
  crowd.particles.position[i] =
      crowd.particles.position[static_cast<std::size_t>(index[3])] + support::uniform_vec<D>(0.2);
  crowd.box.wrap(crowd.particles.position[i]);
  for (const auto exclude : {BondExclusion::none, BondExclusion::repulsion}) {
    const BondedModel<D> model(std::make_unique<ToyModel<D>>(ToyParameters{.c = 0.8, .pair = 3.0}),
                               {{3, 8, {.H = 7.0, .r_0 = 0.2, .exclude = exclude}}});
    const NoSurroundings<D> nothing;
    LocalEnergy<D> local(crowd.box, model, nothing, crowd.particles);
    local.sort_in();
    crowd.connect(model);
    const double energy = crowd.network.energy();
    Vec<D> to = crowd.particles.position[i] + support::uniform_vec<D>(0.07);
    crowd.box.wrap(to);
    const auto self = static_cast<std::int32_t>(i);
    const double change = local.change({&self, 1}, {&to, 1});
    const Vec<D> from = crowd.particles.position[i];
    crowd.particles.position[i] = to;
    crowd.connect(model);
    EXPECT_NEAR(change, crowd.network.energy() - energy, 1e-12 * energy);
    crowd.particles.position[i] = from;
  }
}

TYPED_TEST(DensityMoves, OfTwoFreeParticlesAtOnceAreRefused) {
  constexpr int D = TypeParam::D;
  Crowd<D> crowd(60, 3.2, true);
  const ToyModel<D> model({});
  const NoSurroundings<D> nothing;
  LocalEnergy<D> local(crowd.box, model, nothing, crowd.particles);
  local.sort_in();
  const std::vector<std::int32_t> two{3, 4};
  const std::vector<Vec<D>> to(2, support::uniform_vec<D>(1.0));
  support::expect_error<ConfigError>([&] { local.change(two, to); }, {"one body"});
}

}  // namespace
}  // namespace odpd
