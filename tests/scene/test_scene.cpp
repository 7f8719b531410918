#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "cases.h"
#include "odpd/scene/scene.h"
#include "support/dimensions.h"
#include "support/errors.h"
#include "support/pair_functions.h"
#include "support/points.h"

namespace {

using odpd::Scene;
using odpd::SceneSettings;
using odpd::StartKind;
using odpd::Vec;

// Walls at both ends of x and the last direction; two free particles anywhere.
template <int D>
SceneSettings<D> duct() {
  SceneSettings<D> s;
  s.box.size = support::uniform_vec<D>(6.0);
  s.box.periodic.fill(true);
  for (const int axis : {0, D - 1}) {
    s.box.periodic[static_cast<std::size_t>(axis)] = false;
    for (const bool high : {false, true}) {
      odpd::WallSettings<D> wall;
      wall.axis = axis;
      wall.high = high;
      wall.thickness = 1.0 + 0.1 * axis;
      wall.stiffness = high ? 700.0 : 300.0;
      wall.layers = {{.depth = 0.0, .count = 0, .spacing = 1.0}};
      s.walls.push_back(wall);
    }
  }
  s.body_force[0] = 0.25;
  s.start = StartKind::file;
  s.start_positions.assign(2, support::uniform_vec<D>(3.0));
  s.start_positions[1][0] = 4.0;
  s.relax_sweeps = 0;
  return s;
}

template <class T>
class SceneTest : public ::testing::Test {};
TYPED_TEST_SUITE(SceneTest, support::Dimensions);

// The potential is quadratic, so central differences are exact up to rounding away from the
// surface.
TYPED_TEST(SceneTest, WallForceIsMinusTheGradientOfTheEnergy) {
  constexpr int D = TypeParam::D;
  const Scene<D> scene(duct<D>());
  const auto& particles = scene.particles();
  const auto free = static_cast<std::size_t>(particles.size()) - 2;
  const auto trials =
      support::random_points<D>(support::uniform_vec<D>(-0.5), support::uniform_vec<D>(6.5), 60, 3);
  std::vector<double> ignored(particles.position.size());
  const auto energy = [&](const std::vector<Vec<D>>& r) {
    return scene.potential_energy(particles, r, ignored);
  };
  constexpr double h = 1e-4;
  int pushed = 0;
  for (const Vec<D>& trial : trials) {
    std::vector<Vec<D>> r = particles.position;
    r[free] = trial;
    std::vector<Vec<D>> force(r.size());
    std::vector<double> laplacian(r.size(), 0.0);
    scene.add_potential_forces(particles, r, force);
    const double u = scene.potential_energy(particles, r, laplacian);
    double curvature = 0.0;
    for (int c = 0; c < D; ++c) {
      std::vector<Vec<D>> low = r, high = r;
      low[free][c] -= h;
      high[free][c] += h;
      EXPECT_NEAR(force[free][c], -(energy(high) - energy(low)) / (2.0 * h), 1e-6);
      curvature += (energy(high) - 2.0 * u + energy(low)) / (h * h);
    }
    EXPECT_NEAR(laplacian[free], curvature, 1e-3);
    pushed += norm(force[free]) > 0.0 ? 1 : 0;
    EXPECT_EQ(norm(force[free + 1]), 0.0) << "nothing acts inside the fluid";
    for (std::size_t i = 0; i < free; ++i) EXPECT_EQ(norm(force[i]), 0.0) << "known particles";
  }
  EXPECT_GT(pushed, 10);
}

TYPED_TEST(SceneTest, WallForcesAddUpInACorner) {
  constexpr int D = TypeParam::D;
  const Scene<D> scene(duct<D>());
  std::vector<Vec<D>> r = scene.particles().position;
  r.back()[0] = 0.8;      // 0.2 behind x-
  r.back()[D - 1] = 5.0;  // 0.1 (D - 1) behind the upper wall
  std::vector<Vec<D>> force(r.size());
  scene.add_potential_forces(scene.particles(), r, force);
  EXPECT_NEAR(force.back()[0], 300.0 * 0.2, 1e-10);
  EXPECT_NEAR(force.back()[D - 1], -700.0 * 0.1 * (D - 1), 1e-10);
}

// At random places, behind walls too, of one free particle; the other one rests between the walls.
TYPED_TEST(SceneTest, TheEnergyAtAPlaceIsThatOfAParticleThere) {
  constexpr int D = TypeParam::D;
  const Scene<D> scene(duct<D>());
  std::vector<Vec<D>> r = scene.particles().position;
  std::vector<double> ignored(r.size());
  double largest = 0.0;
  for (const Vec<D>& trial : support::random_points<D>(Vec<D>{}, scene.box().size, 40, 5)) {
    r.back() = trial;
    const double energy = scene.potential_energy(scene.particles(), r, ignored);
    EXPECT_NEAR(scene.potential_energy_at(trial), energy, 1e-12 * (1.0 + energy));
    largest = std::max(largest, energy);
  }
  EXPECT_GT(largest, 1.0);
}

TYPED_TEST(SceneTest, TheBodyForceActsOnTheFluidOnly) {
  constexpr int D = TypeParam::D;
  const Scene<D> scene(duct<D>());
  std::vector<Vec<D>> force(scene.particles().position.size());
  scene.add_driving_forces(scene.particles(), scene.particles().position, 0.0, force);
  for (std::size_t i = 0; i < force.size(); ++i) {
    EXPECT_EQ(force[i][0], scene.particles().is_free(i) ? 0.25 : 0.0);
    EXPECT_EQ(force[i][1], 0.0);
  }
}

TYPED_TEST(SceneTest, TheMirrorBringsParticlesBack) {
  constexpr int D = TypeParam::D;
  const Scene<D> scene(duct<D>());
  const auto confined = [&](double x, bool expected) {
    Vec<D> r = support::uniform_vec<D>(3.0);
    r[0] = x;
    EXPECT_EQ(scene.confine(r), expected) << "at " << x;
    EXPECT_EQ(r[D - 1], 3.0);
    return r[0];
  };
  EXPECT_EQ(confined(0.0, false), 0.0);
  EXPECT_EQ(confined(6.0, false), 6.0);
  EXPECT_EQ(confined(2.2, false), 2.2);
  EXPECT_DOUBLE_EQ(confined(-0.25, true), 0.25);
  EXPECT_DOUBLE_EQ(confined(6.5, true), 5.5);
  for (const double far : {-100.0, 100.0}) {
    const double x = confined(far, true);
    EXPECT_TRUE(x >= 0.0 && x <= 6.0) << "inside however far it was";
  }
  Vec<D> outside = support::uniform_vec<D>(-1.0);
  EXPECT_TRUE(scene.confine(outside));
  for (int c = 0; c < D; ++c) EXPECT_EQ(outside[c], scene.box().is_periodic(c) ? -1.0 : 1.0);
}

TEST(Scene, LargestTemperatureOfAnyPair) {
  SceneSettings<2> s = cases::settings<2>(cases::channel);
  s.species.resize(2);
  s.species[0].fraction = s.species[1].fraction = 0.5;
  const odpd::DpdParameters cool, hot{.kT = 2.5};
  s.model = std::make_shared<odpd::DpdModel<2>>(2, std::vector{cool, cool, cool, hot});
  EXPECT_EQ(Scene<2>(s).largest_kT(), 2.5);
}

TEST(Scene, TakesAModelOfOnesOwn) {
  SceneSettings<2> s = cases::settings<2>(cases::channel);
  s.model = support::gaussian<2>(18.5, 0.3, 0.6);
  const Scene<2> scene(s);
  EXPECT_EQ(scene.model().name(), "function");
  EXPECT_EQ(scene.largest_kT(), 0.6);
  EXPECT_NEAR(scene.pair_moments().front().stiffness, 18.5 / 0.3, 1e-12);
  s.species.resize(3);
  EXPECT_NO_THROW(Scene<2>{s}) << "it is the same for any species";
}

TEST(Scene, AModelOfAnotherNumberOfSpeciesIsRefused) {
  SceneSettings<2> s = cases::settings<2>(cases::channel);
  s.model = odpd::make_dpd<2>({}, 2);
  support::expect_error<odpd::ConfigError>([&] { Scene<2>{s}; }, {"2 species", "the scene has 1"});
  s.model = nullptr;
  support::expect_error<odpd::ConfigError>([&] { Scene<2>{s}; }, {"no pair model"});
}

// A flow at the start comes on top of Maxwell velocities; what momentum it has on these particles is taken from everyone.
TYPED_TEST(SceneTest, StartsWithAFlow) {
  constexpr int D = TypeParam::D;
  SceneSettings<D> s;
  s.box.size = support::uniform_vec<D>(6.0);
  s.box.periodic.fill(true);
  s.start = StartKind::file;
  s.start_positions = support::random_points<D>({}, s.box.size, 11, 4);
  s.relax_sweeps = 0;
  s.mass = 2.0;
  const Scene<D> still(s);
  s.start_velocity[0] = 0.5;
  s.start_wave = {.along = 1, .number = 1};
  const Scene<D> flowing(s);
  Vec<D> mean{}, momentum{};
  for (const Vec<D>& r : s.start_positions)
    mean[0] += 0.5 * std::sin(std::numbers::pi * r[1] / 3.0) / 11.0;
  EXPECT_GT(norm(mean), 0.005) << "the test needs something to subtract";
  for (std::size_t i = 0; i < 11; ++i) {
    const Vec<D>& r = flowing.particles().position[i];
    Vec<D> flow = -1.0 * mean;
    flow[0] += 0.5 * std::sin(std::numbers::pi * r[1] / 3.0);
    const Vec<D> more = flowing.particles().end_velocity[i] - still.particles().end_velocity[i];
    EXPECT_LT(norm(more - flow), 1e-13);
    momentum += flowing.particles().end_velocity[i];
  }
  EXPECT_LT(norm(momentum), 1e-13);
}

// On a finite set of particles neither a wave nor opposite regions add up to nothing; in a box without walls the rest is
// taken from everyone, between walls it stays.
TYPED_TEST(SceneTest, ForcesThatVary) {
  constexpr int D = TypeParam::D;
  SceneSettings<D> s;
  s.box.size = support::uniform_vec<D>(6.0);
  s.box.periodic.fill(true);
  s.start = StartKind::file;
  s.start_positions = support::random_points<D>({}, s.box.size, 11, 4);
  s.relax_sweeps = 0;
  s.body_force[0] = 0.5;
  s.force_wave = {.along = 1, .number = 3};
  Vec<D> push{};
  push[D - 1] = 0.25;
  s.force_regions = {{.axis = 0, .from = 0.0, .to = 3.0, .force = push},
                     {.axis = 0, .from = 3.0, .to = 6.0, .force = -1.0 * push}};
  const Scene<D> scene(s);
  const auto& particles = scene.particles();
  std::vector<Vec<D>> force(particles.position.size());
  scene.add_driving_forces(particles, particles.position, 0.0, force);
  Vec<D> expected{}, sum{};
  for (const Vec<D>& r : particles.position) {
    expected[0] += 0.5 * std::sin(std::numbers::pi * r[1]) / 11.0;
    expected[D - 1] += (r[0] < 3.0 ? 0.25 : -0.25) / 11.0;
  }
  EXPECT_GT(norm(expected), 0.01) << "the test needs something to subtract";
  for (std::size_t i = 0; i < force.size(); ++i) {
    const Vec<D>& r = particles.position[i];
    EXPECT_NEAR(force[i][0], 0.5 * std::sin(std::numbers::pi * r[1]) - expected[0], 1e-14);
    EXPECT_NEAR(force[i][D - 1], (r[0] < 3.0 ? 0.25 : -0.25) - expected[D - 1], 1e-14);
    sum += force[i];
  }
  EXPECT_LT(norm(sum), 1e-14);

  SceneSettings<D> held = duct<D>();
  held.force_regions = {{.axis = 0, .from = 3.5, .to = 6.0, .force = push}};
  const Scene<D> between(held);
  std::vector<Vec<D>> on(between.particles().position.size());
  between.add_driving_forces(between.particles(), between.particles().position, 0.0, on);
  const std::size_t last = on.size() - 1;
  EXPECT_EQ(norm(on[0]), 0.0) << "of the wall";
  EXPECT_EQ(on[last - 1], held.body_force);
  EXPECT_EQ(on[last], held.body_force + push);
}

}  // namespace
