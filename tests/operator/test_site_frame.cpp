// Particles tied to the sites of a frame: forces, Laplacian and stiffness against derivatives of the energy.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "odpd/operator/edge_sums.h"
#include "odpd/pairs/bonds.h"
#include "odpd/particles/rigid_body.h"
#include "support/dimensions.h"
#include "support/errors.h"
#include "support/network.h"

namespace {

using odpd::Vec;

constexpr double site_H = 50.0;

template <int D>
odpd::BondedModel<D> framed(const std::vector<Vec<D>>& sites, std::int64_t first) {
  std::vector<odpd::Bond> bonds;
  const auto n = static_cast<std::int64_t>(sites.size());
  for (std::int64_t i = 0; i < n; ++i)
    for (std::int64_t j = i + 1; j < n; ++j)
      bonds.push_back({first + i, first + j, {.law = odpd::BondLaw::sites, .H = site_H}});
  return {std::make_unique<odpd::DpdModel<D>>(1, std::vector{odpd::DpdParameters{.a = 0.0}}),
          bonds,
          {{first, 0, sites, site_H}}};
}

// Sites about their centre, and particles near them, turned, across the edge of the box.
template <int D>
struct Tied {
  std::vector<Vec<D>> sites;
  support::Fluid<D> fluid{8.0, true};
  explicit Tied(std::size_t n, double off = 0.1) {
    sites = support::random_vectors<D>(n, 5);
    Vec<D> mean{};
    for (const Vec<D>& b : sites) mean += (1.0 / static_cast<double>(n)) * b;
    for (Vec<D>& b : sites) b = 0.3 * (b - mean);
    odpd::Rotation<D> turned;
    Vec<D> w{};
    w[0] = 1.1;
    turned.advance(w);
    const auto displaced = support::random_vectors<D>(n, 6);
    fluid.particles.add(support::uniform_vec<D>(2.0), 0);
    for (std::size_t k = 0; k < n; ++k) {
      fluid.particles.add(turned.turn(sites[k]) + off * displaced[k], 0);
      fluid.box.wrap(fluid.particles.position.back());
    }
    fluid.particles.reorder(support::random_order(n + 1, 3));
  }
  double energy(const odpd::BondedModel<D>& model) {
    fluid.connect(model);
    return fluid.network.u.sum();
  }
};

template <class T>
class SiteFrameTest : public ::testing::Test {};
TYPED_TEST_SUITE(SiteFrameTest, support::Dimensions);

TYPED_TEST(SiteFrameTest, ForcesAndLaplaciansAreDerivativesOfTheEnergy) {
  constexpr int D = TypeParam::D;
  for (const std::size_t n : {3u, 4u, 7u}) {
    Tied<D> tied(n);
    const auto model = framed(tied.sites, 1);
    const double at = tied.energy(model);
    EXPECT_GT(at, 0.01);
    const auto network = tied.fluid.network;
    EXPECT_EQ(network.bonds, static_cast<std::int64_t>(n * (n - 1) / 2));
    std::vector<Vec<D>> force(n + 1);
    odpd::add_conservative_forces(network, force);
    std::vector<double> laplacian(n + 1, 0.0);
    odpd::add_laplacian(network, laplacian);
    auto& position = tied.fluid.particles.position;
    constexpr double h = 1e-4;
    for (std::size_t i = 0; i <= n; ++i) {
      double curvature = 0.0;
      for (int c = 0; c < D; ++c) {
        const Vec<D> before = position[i];
        const auto moved = [&](double step) {
          Vec<D> trial = before;
          trial[c] += step;
          tied.fluid.box.wrap(trial);
          const double asked = model.bonded_energy(i, trial, tied.fluid.box, tied.fluid.particles);
          position[i] = trial;
          const double energy = tied.energy(model);
          EXPECT_NEAR(tied.fluid.particles.id[i] > 0 ? energy : 0.0, asked, 1e-12);
          position[i] = before;
          return energy;
        };
        const double low = moved(-h), high = moved(h);
        EXPECT_NEAR(force[i][c], -(high - low) / (2.0 * h), 1e-5);
        curvature += (high - 2.0 * at + low) / (h * h);
      }
      EXPECT_NEAR(laplacian[i], curvature, 1e-3);
    }
  }
}

TYPED_TEST(SiteFrameTest, TheFrameIsInBalanceAndItsEnergyLeast) {
  constexpr int D = TypeParam::D;
  Tied<D> tied(5);
  const auto model = framed(tied.sites, 1);
  const double energy = tied.energy(model);
  const auto index = tied.fluid.particles.index_of_id();
  std::vector<Vec<D>> force(6), places;
  odpd::add_conservative_forces(tied.fluid.network, force);
  const auto at = [&](std::size_t k) { return static_cast<std::size_t>(index[k + 1]); };
  for (std::size_t k = 0; k < 5; ++k)
    places.push_back(tied.fluid.box.separation(tied.fluid.particles.position[at(k)],
                                               tied.fluid.particles.position[at(0)]));
  const odpd::BalancedFrame<D> frame({1, 0, tied.sites, site_H}, places);
  EXPECT_NEAR(0.5 * site_H * frame.distance_squared(), energy, 1e-12);
  Vec<D> net{}, turning{};
  double least = 0.0;
  for (std::size_t k = 0; k < 5; ++k) {
    // Each is pulled to its own site, by a spring.
    EXPECT_LT(norm(force[at(k)] + site_H * (frame.arms[k] - frame.sites[k])), 1e-12);
    net += force[at(k)];
    turning += odpd::torque(frame.sites[k], force[at(k)]);
    for (std::size_t l = 0; l < 5; ++l)
      EXPECT_NEAR(norm(frame.sites[k] - frame.sites[l]), norm(tied.sites[k] - tied.sites[l]),
                  1e-13);
    const Vec<D> unturned = frame.arms[k] - tied.sites[k];
    least += 0.5 * site_H * dot(unturned, unturned);
  }
  EXPECT_LT(norm(net), 1e-12);
  EXPECT_LT(norm(turning), 1e-12);
  EXPECT_GT(least, energy);
}

// What is taken implicitly leaves rigid motion alone and holds against swelling as the springs do.
TYPED_TEST(SiteFrameTest, TheImplicitStiffnessIsThatOfSwellingAndNoRigidMotion) {
  constexpr int D = TypeParam::D;
  Tied<D> tied(5, 0.0);
  const auto model = framed(tied.sites, 1);
  EXPECT_NEAR(tied.energy(model), 0.0, 1e-24);
  const auto& network = tied.fluid.network;
  std::vector<Vec<D>> rigid(6), swelling(6), force(6);
  Vec<D> w{};
  for (int c = 0; c < odpd::rotation_components<D>; ++c) w[c] = 1.0 - 0.7 * c;
  const Vec<D> origin{};
  for (std::size_t i = 0; i < 6; ++i) {
    if (tied.fluid.particles.id[i] > 0)
      swelling[i] = tied.fluid.box.separation(tied.fluid.particles.position[i], origin);
    rigid[i] = support::uniform_vec<D>(0.5) + swing(w, swelling[i]);
  }
  odpd::add_bond_springs<D>(network, rigid, force);
  for (const Vec<D>& f : force) EXPECT_LT(norm(f), 1e-11);
  odpd::add_bond_springs<D>(network, swelling, force);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_LT(norm(force[i] + site_H * swelling[i]), 1e-10);
}

TYPED_TEST(SiteFrameTest, RefusesParticlesWithoutADirection) {
  constexpr int D = TypeParam::D;
  Tied<D> tied(4);
  const auto model = framed(tied.sites, 1);
  for (Vec<D>& r : tied.fluid.particles.position) r = support::uniform_vec<D>(1.0);
  support::expect_error<odpd::BlowUpError>(
      [&] { tied.fluid.connect(model); },
      {"particles 1 to 4", "on a line or in one point", "turn freely", "integrator.dt"});
}

TYPED_TEST(SiteFrameTest, TellsTheMirrorImageOfASimplexFromALine) {
  constexpr int D = TypeParam::D;
  // The unit vectors and a point on their diagonal, all sqrt(2) apart, scaled down.
  std::vector<Vec<D>> sites(D + 1, support::uniform_vec<D>((1.0 - std::sqrt(D + 1.0)) / D));
  for (std::size_t k = 0; k < D; ++k) {
    sites[k] = Vec<D>{};
    sites[k].x[k] = 1.0;
  }
  Vec<D> centre{};
  for (const Vec<D>& b : sites) centre += (1.0 / (D + 1)) * b;
  for (Vec<D>& b : sites) b = 0.3 * (b - centre);
  Tied<D> tied(D + 1);
  const auto model = framed(sites, 1);
  for (const double other_way : {1.0, -1.0}) {
    for (std::size_t i = 0; i < D + 2; ++i) {
      const std::int64_t id = tied.fluid.particles.id[i];
      if (id < 1) continue;
      Vec<D> r = sites[static_cast<std::size_t>(id - 1)];
      r[0] *= other_way;
      tied.fluid.particles.position[i] = support::uniform_vec<D>(1.0) + r;
    }
    if (other_way > 0.0) {
      EXPECT_LT(tied.energy(model), 1e-12);
    } else {
      const std::string which = "particles 1 to " + std::to_string(D + 1);
      support::expect_error<odpd::BlowUpError>([&] { tied.fluid.connect(model); },
                                               {which.c_str(), "the mirror image of their sites"});
    }
  }
}

}  // namespace
