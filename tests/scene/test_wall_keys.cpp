// What walls and bodies of particles that fill space (SDPD) have by default: the lattice of the fluid's density, and the fluid's room.
#include <gtest/gtest.h>

#include "cases.h"
#include "support/errors.h"

namespace odpd {
namespace {

using Overrides = std::vector<std::string>;

const char* const wet_channel = R"(
[box]
size = [10.4, 12.0]
periodic = [true, false]
[fluid]
model = "sdpd"
density = 4.0
kT = 1.0
eta = 2.0
bulk_modulus = 400.0
[[wall]]
side = "y-"
[[wall]]
side = "y+"
velocity = [1.0, 0.0]
)";

TEST(WallKeys, AWallIsALatticeOfTheFluidsDensityAsDeepAsItReaches) {
  const Scene<2> scene(cases::settings<2>(wet_channel));
  const WallSettings<2>& wall = scene.settings().walls[1];
  // Spacing 1/2, rounded to 21 in 10.4; reach 3/2.
  const double across = 1.0 / (4.0 * 10.4 / 21.0);
  ASSERT_EQ(wall.layers.size(), 3u);
  EXPECT_NEAR(wall.thickness, 3.0 * across, 1e-12);
  EXPECT_GE(wall.thickness, 1.5);
  for (std::size_t k = 0; k < 3; ++k)
    EXPECT_NEAR(wall.layers[k].depth, (static_cast<double>(k) + 0.5) * across, 1e-12);
  EXPECT_DOUBLE_EQ(wall.stiffness, 5.0 * 400.0);
  std::int64_t frozen = 0;
  for (std::size_t i = 0; i < scene.particles().group.size(); ++i)
    frozen += scene.particles().is_free(i) ? 0 : 1;
  EXPECT_EQ(frozen, 2 * 63);
  EXPECT_NEAR(63.0 / (10.4 * wall.thickness), 4.0, 1e-12);
}

TEST(WallKeys, WhatIsGivenStays) {
  const auto given = cases::settings<2>(
      wet_channel, {"wall.0.thickness=2.0", "wall.0.stiffness=7.0",
                    "wall.1.layers=[{depth=0.0, count=20}, {depth=1.0, count=3}]"});
  EXPECT_EQ(given.walls[0].thickness, 2.0);
  EXPECT_EQ(given.walls[0].layers.size(), 4u);
  EXPECT_EQ(given.walls[0].stiffness, 7.0);
  EXPECT_EQ(given.walls[1].thickness, 1.0);
  ASSERT_EQ(given.walls[1].layers.size(), 2u);
  EXPECT_EQ(given.walls[1].layers[1].count, 3);
}

TEST(WallKeys, ACountNeedsAThickness) {
  const std::string text = wet_channel;
  const auto at = text.find("density = 4.0");
  const std::string counted = text.substr(0, at) + "count = 374" + text.substr(at + 13);
  support::expect_error<ConfigError>([&] { cases::settings<2>(counted); },
                                     {"case.toml:11", "thickness", "fluid.count"});
  const auto given = cases::settings<2>(counted, {"wall.0.thickness=1.5", "wall.1.thickness=1.5"});
  EXPECT_NEAR(given.model->reference_state(0.0)->density, 374.0 / (10.4 * 9.0), 1e-12);
  EXPECT_EQ(given.walls[0].layers.size(), 3u);
}

// Where two directions are bounded the corners belong to the first wall: no place is taken twice, and the lattice is even.
TEST(WallKeys, WallsMeetInCorners) {
  const auto tank = cases::settings<2>(
      wet_channel, {"box.size=[8.0, 8.0]", "box.periodic=[false, false]",
                    "wall=[{side=\"x-\"},{side=\"x+\"},{side=\"y-\"},{side=\"y+\"}]"});
  const Scene<2> scene(tank);
  const Particles<2>& particles = scene.particles();
  std::int64_t frozen = 0;
  for (std::size_t i = 0; i < particles.group.size(); ++i) {
    if (particles.is_free(i)) continue;
    ++frozen;
    for (std::size_t j = 0; j < i; ++j) {
      if (particles.is_free(j)) continue;
      EXPECT_GT(norm(particles.position[i] - particles.position[j]), 0.49);
    }
  }
  EXPECT_EQ(frozen, 16 * 16 - 10 * 10);
}

// The usual thickness of other models, 1, says nothing about units in which a box is small.
TEST(WallKeys, AThicknessThatNobodyGaveIsNotRefused) {
  const auto small = cases::settings<2>(
      wet_channel, {"box.size=[1.04, 1.2]", "fluid.density=400.0", "fluid.bulk_modulus=4e4"});
  EXPECT_LT(small.walls[0].thickness, 0.17);
}

TEST(WallKeys, ARegionLiesBetweenTheWallsAsTheyAre) {
  support::expect_error<ConfigError>(
      [] { cases::settings<2>(wet_channel, {"start.region={from=[0.0, 1.2], to=[10.0, 8.0]}"}); },
      {"start.region.from", "1.2", "1.5"});
}

TEST(WallKeys, AWallThatFillsHalfOfTheBoxIsRefused) {
  support::expect_error<ConfigError>(
      [] { cases::settings<2>(wet_channel, {"box.size=[10.4, 3.0]"}); },
      {"thickness", "half of the box"});
}

const char* const wet_box = R"(
[box]
size = [10.0, 10.0]
periodic = [true, true]
[fluid]
model = "sdpd"
kT = 1.0
eta = 2.0
bulk_modulus = 400.0
[[body]]
shape = "disk"
radius = 1.0
positions = [{ at = [5.0, 5.0] }]
)";

TEST(WallKeys, BodiesTakeTheRoomOfFluid) {
  const auto by_density = cases::settings<2>(wet_box, {"fluid.density=4.0"});
  EXPECT_EQ(Scene<2>(by_density).particles().free_count(), 400 - 19);
  const auto by_count = cases::settings<2>(wet_box, {"fluid.count=381"});
  EXPECT_NEAR(by_count.model->reference_state(0.0)->density, 4.0, 1e-12);
  EXPECT_EQ(Scene<2>(by_count).particles().free_count(), 381);
  support::expect_error<ConfigError>(
      [] {
        cases::settings<2>(wet_box, {"fluid.density=0.18", "fluid.support=2.0"});
      },
      {"fluid.density", "no room", "19", "18"});
  // What a start file must hold.
  EXPECT_EQ(cases::settings<2>(wet_box, {"fluid.density=4.0", "start.from=\"file\"",
                                         "start.file=\"particles.csv\""})
                .count,
            381);
}

// DPD's particles overlap as they like: there its density is that of the free ones in all space.
TEST(WallKeys, OtherModelsCountFreeParticlesAlone) {
  const auto soft = cases::settings<2>(
      std::string(cases::channel) +
      "[[body]]\nshape = \"disk\"\nradius = 1.0\npositions = [{ at = [5.0, 5.0] }]\n");
  EXPECT_EQ(Scene<2>(soft).particles().free_count(), 400);
}

}  // namespace
}  // namespace odpd
