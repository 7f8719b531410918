#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <set>

#include "cases.h"
#include "odpd/scene/fill.h"
#include "support/errors.h"
#include "support/points.h"

namespace {

using cases::channel;
using cases::periodic;
using cases::settings;
using odpd::ConfigError;
using odpd::Group;
using odpd::Scene;
using odpd::SceneSettings;
using odpd::StartKind;
using odpd::Vec;
using support::expect_error;

template <int D>
double energy(const Scene<D>& scene) {
  const auto& r = scene.particles().position;
  odpd::PairList<D> list(scene.box(), scene.model().cutoff(), 0.0);
  list.update(r);
  odpd::PairNetwork<D> network;
  scene.model().write_edges(list, scene.box(), r, scene.particles(), network);
  std::vector<double> laplacian(r.size(), 0.0);
  return scene.potential_energy(scene.particles(), r, laplacian) + network.u.sum();
}

template <int D>
double closest_pair(const Scene<D>& scene) {
  const auto& r = scene.particles().position;
  double closest = 1e300;
  for (std::size_t i = 0; i < r.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      closest = std::min(closest, norm(scene.box().separation(r[i], r[j])));
    }
  }
  return closest;
}

template <int D>
std::int64_t count_group(const Scene<D>& scene, Group group) {
  const auto& groups = scene.particles().group;
  return std::count(groups.begin(), groups.end(), group);
}

TEST(Fill, RandomFluidStaysOutOfBodies) {
  const Scene<2> scene(settings<2>(std::string(channel) +
                                   "[[body]]\nshape = \"ring\"\nradius = 1.5\npoints_on_ring = "
                                   "9\npositions = [{ at = [0.5, 4.0] }, { at = [6.0, 8.0] }]\n"
                                   "[start]\nrelax_sweeps = 0\n"));
  const auto& p = scene.particles();
  double closest = 1e300;
  for (std::size_t i = 0; i < p.position.size(); ++i)
    for (const auto& body : p.bodies)
      if (p.is_free(i))
        closest = std::min(closest, norm(scene.box().separation(p.position[i], body.pose.centre)));
  EXPECT_EQ(count_group(scene, Group()), 400);
  EXPECT_GE(closest, 1.5);
  EXPECT_LT(closest, 1.6);
}

TEST(Fill, AChannelHasItsWallsAndItsFluid) {
  const Scene<2> scene(settings<2>(channel));
  EXPECT_EQ(count_group(scene, Group()), 400);
  EXPECT_EQ(count_group(scene, Group::wall(0)), 70);
  EXPECT_EQ(count_group(scene, Group::wall(1)), 70);
  EXPECT_EQ(scene.fluid_volume(), 100.0);
  EXPECT_EQ(scene.fluid_low(), (Vec<2>{{0.0, 1.0}}));
  EXPECT_EQ(scene.fluid_high(), (Vec<2>{{10.0, 11.0}}));
  EXPECT_EQ(scene.known_velocity(Group::wall(0), 0.0)[0], 0.0);
  EXPECT_EQ(scene.known_velocity(Group::wall(1), 0.0)[0], 1.0);
  std::map<std::pair<std::int32_t, double>, std::vector<double>> layers;
  const auto& p = scene.particles();
  for (std::size_t i = 0; i < p.position.size(); ++i) {
    if (!p.is_free(i))
      layers[{p.group[i].known_mover(), p.position[i][1]}].push_back(p.position[i][0]);
  }
  ASSERT_EQ(layers.size(), 4u);
  for (const auto& [where, count] :
       {std::pair{std::pair{0, 1.0}, 50}, {{0, 0.5}, 20}, {{1, 11.0}, 50}, {{1, 11.5}, 20}}) {
    std::vector<double> x = layers[where];
    ASSERT_EQ(x.size(), static_cast<std::size_t>(count)) << "at height " << where.second;
    std::sort(x.begin(), x.end());
    for (std::size_t k = 0; k < x.size(); ++k) {
      EXPECT_NEAR(x[k], 10.0 * (static_cast<double>(k) + 0.5) / count, 1e-12) << "evenly spaced";
    }
  }
}

TEST(Fill, A3DLayerIsAGridOfTheSpacing) {
  SceneSettings<3> s = settings<3>(periodic);
  s.box.periodic[2] = false;
  for (const bool high : {false, true}) {
    odpd::WallSettings<3> wall;
    wall.axis = 2;
    wall.high = high;
    wall.layers = {{.depth = 0.25, .count = 0, .spacing = 0.49}};
    s.walls.push_back(wall);
  }
  const Scene<3> scene(s);
  EXPECT_EQ(count_group(scene, Group::wall(0)), 6 * 8);  // 3/0.49 and 4/0.49, rounded
  EXPECT_EQ(count_group(scene, Group()), 108);           // 3 per volume in 3 x 4 x (5 - 2)
  EXPECT_EQ(scene.particles().position[0][2], 0.75);
  EXPECT_EQ(scene.particles().position[50][2], 4.25);
}

TEST(Fill, RandomPositionsLieInTheFluidAndFollowTheSeed) {
  const auto start = [](std::uint64_t seed) {
    SceneSettings<2> s = settings<2>(channel);
    s.relax_sweeps = 0;
    s.seed = seed;
    return Scene<2>(s).particles().position;
  };
  const auto r = start(3);
  double mean = 0.0;
  for (std::size_t i = 140; i < r.size(); ++i) {
    EXPECT_GT(r[i][1], 1.0);
    EXPECT_LT(r[i][1], 11.0);
    EXPECT_GE(r[i][0], 0.0);
    EXPECT_LT(r[i][0], 10.0);
    mean += r[i][1] / 400.0;
  }
  // Mean height of 400 uniform positions: 6 with standard error 10/sqrt(12 * 400); bound 5 of them.
  EXPECT_NEAR(mean, 6.0, 5.0 * 10.0 / std::sqrt(12.0 * 400.0));
  EXPECT_EQ(start(3), r);
  EXPECT_NE(start(4), r);
}

TEST(Fill, LatticesHaveExactlyTheCountAsked) {
  for (const std::int64_t count : {1, 2, 7, 97, 100, 101, 333, 400}) {
    SceneSettings<2> s = settings<2>(channel);
    s.start = StartKind::lattice;
    s.relax_sweeps = 0;
    s.count = count;
    const Scene<2> scene(s);
    EXPECT_EQ(count_group(scene, Group()), count);
    std::set<std::pair<double, double>> sites;
    for (std::size_t i = 140; i < scene.particles().position.size(); ++i) {
      const Vec<2>& r = scene.particles().position[i];
      EXPECT_TRUE(r[1] > 1.0 && r[1] < 11.0 && r[0] > 0.0 && r[0] < 10.0);
      sites.emplace(r[0], r[1]);
    }
    EXPECT_EQ(sites.size(), static_cast<std::size_t>(count)) << "no site twice";
  }
}

TEST(Fill, AFittingLatticeIsRegular) {
  SceneSettings<3> s = settings<3>(periodic);
  s.start = StartKind::lattice;
  s.relax_sweeps = 0;
  s.count = 6 * 8 * 10;  // spacing 1/2
  const Scene<3> scene(s);
  EXPECT_EQ(scene.particles().size(), 480);
  for (const Vec<3>& r : scene.particles().position) {
    for (int c = 0; c < 3; ++c) {
      const double site = (r[c] - 0.25) / 0.5;
      EXPECT_NEAR(site, std::round(site), 1e-12);
    }
  }
  EXPECT_NEAR(closest_pair(scene), 0.5, 1e-12);
}

TEST(Fill, SpeciesHaveTheirShares) {
  SceneSettings<3> s = settings<3>(std::string(periodic) + R"(
[[species]]
name = "a"
count = 11
[[species]]
name = "b"
fraction = 0.25
[[species]]
name = "c"
fraction = 0.75
)");
  s.relax_sweeps = 0;
  const Scene<3> scene(s);
  const auto& kinds = scene.particles().species;
  EXPECT_EQ(kinds.size(), 180u);
  EXPECT_EQ(std::count(kinds.begin(), kinds.end(), 0), 11);
  EXPECT_EQ(std::count(kinds.begin(), kinds.end(), 1), 42);  // a quarter of 169
  EXPECT_EQ(std::count(kinds.begin(), kinds.end(), 2), 127);
  EXPECT_FALSE(std::is_sorted(kinds.begin(), kinds.end())) << "mixed at random";
  s.species[0].count = 181;
  expect_error<ConfigError>([&] { Scene<3>{s}; }, {"181", "180"});
  s.species = {{.name = "a", .fraction = 0.0, .count = 100},
               {.name = "b", .fraction = 0.0, .count = 70},
               {.name = "c", .fraction = 0.0, .count = 0}};
  expect_error<ConfigError>([&] { Scene<3>{s}; }, {"170", "180"});
}

// Behind a wall's surface as well, where a trajectory has them.
TEST(Fill, StartPositionsMustLieInTheBox) {
  SceneSettings<2> s = settings<2>(channel);
  s.start = StartKind::file;
  s.start_file = "points.txt";
  s.relax_sweeps = 0;
  s.start_positions = {{{3.0, 5.0}},   {{-1.0, 1.0}}, {{25.0, 11.0}}, {{1.0, 0.97}},
                       {{2.0, 11.03}}, {{3.0, 0.0}},  {{4.0, 12.0}}};
  const Scene<2> scene(s);
  EXPECT_EQ(count_group(scene, Group()), 7);
  EXPECT_EQ(scene.particles().position[141], (Vec<2>{{9.0, 1.0}})) << "wrapped where periodic";
  EXPECT_EQ(scene.particles().position[142], (Vec<2>{{5.0, 11.0}}));
  EXPECT_EQ(scene.particles().position[143], (Vec<2>{{1.0, 0.97}})) << "where it was";
  for (const double y : {-0.01, 12.01, -3.0, std::nan("")}) {
    s.start_positions[1] = {{4.0, y}};
    expect_error<ConfigError>([&] { Scene<2>{s}; }, {"points.txt", "particle 1", "from 0 to 12"});
  }
}

// Density is then that of the region; a block may be a lattice.
TEST(Fill, FluidStartsInItsRegion) {
  const std::string start = std::string(periodic) + "[start]\nrelax_sweeps = 0\nregion = ";
  const Vec<3> centre{{1.5, 2.0, 3.0}};
  const SceneSettings<3> ball = settings<3>(start + "{ centre = [1.5, 2.0, 3.0], radius = 1.4 }\n");
  EXPECT_NEAR(ball.start_volume(), 4.0 / 3.0 * std::numbers::pi * std::pow(1.4, 3), 1e-12);
  const Scene<3> drop(ball);
  EXPECT_EQ(count_group(drop, Group()), 34);  // 3 times 11.5
  double farthest = 0.0;
  for (const Vec<3>& r : drop.particles().position) farthest = std::max(farthest, norm(r - centre));
  EXPECT_LT(farthest, 1.4);
  EXPECT_GT(farthest, 1.2);
  for (const char* from : {"random", "lattice"}) {
    SceneSettings<3> s = settings<3>(start + "{ from = [0.0, 0.0, 1.0], to = [3.0, 4.0, 2.0] }\n" +
                                     "from = \"" + from + "\"\n");
    const Scene<3> slab(s);
    EXPECT_EQ(count_group(slab, Group()), 36);
    for (const Vec<3>& r : slab.particles().position) EXPECT_TRUE(r[2] >= 1.0 && r[2] < 2.0);
    // A frame of a run: the region only says what volume `density` is of.
    s.start = StartKind::file;
    s.start_density = 3.0;
    s.start_positions.assign(36, {{1.0, 1.0, 4.5}});
    EXPECT_EQ(Scene<3>(s).particles().position[0][2], 4.5);
  }
}

TEST(Fill, ARegionLiesBetweenTheWalls) {
  const std::string start = std::string(channel) + "[start]\nregion = ";
  const auto refuses = [&](const std::string& region, std::initializer_list<const char*> parts) {
    expect_error<ConfigError>([&] { settings<2>(start + region + "\n"); }, parts);
  };
  refuses("{ from = [0.0, 0.5], to = [2.0, 3.0] }",
          {"case.toml:", "start.region.from", "along y", "1 to 11"});
  refuses("{ from = [0.0, 1.5], to = [2.0, 11.5] }", {"start.region.to", "11.5 along y"});
  refuses("{ centre = [5.0, 4.0], radius = 3.5 }", {"start.region.radius", "0.5 to 7.5"});
  refuses("{ from = [3.0, 4.0], to = [2.0, 5.0] }", {"start.region.to", "along x", "above from"});
  refuses("{ centre = [5.0, 4.0], from = [1.0, 1.0] }", {"start.region.from", "radius"});
  refuses("{ centre = [5.0, 4.0], radius = 1.5 }\nfrom = \"lattice\"", {"radius", "lattice"});
}

TEST(Fill, ABoxBelowTwoCutoffsIsRefused) {
  SceneSettings<3> s = settings<3>(periodic);
  s.model = odpd::make_dpd<3>({.cutoff = 1.6});
  expect_error<ConfigError>([&] { Scene<3>{s}; }, {"two cutoffs"});
}

TEST(Relax, LowersTheEnergyAndKeepsWallsStill) {
  SceneSettings<2> s = settings<2>(channel);
  s.relax_sweeps = 0;
  const Scene<2> before(s);
  double last = energy(before);
  for (const std::int64_t sweeps : {5, 20, 100}) {
    s.relax_sweeps = sweeps;
    const Scene<2> after(s);
    EXPECT_LT(energy(after), last);
    last = energy(after);
    for (std::size_t i = 0; i < 140; ++i) {
      EXPECT_EQ(after.particles().position[i], before.particles().position[i]);
    }
    for (const Vec<2>& r : after.particles().position) {
      EXPECT_TRUE(r[0] >= 0.0 && r[0] < 10.0 && r[1] >= 0.0 && r[1] <= 12.0);
    }
  }
  EXPECT_GT(closest_pair(Scene<2>(s)), 5.0 * closest_pair(before));
}

TEST(Relax, SeparatesParticlesAtOnePoint) {
  SceneSettings<3> s = settings<3>(periodic);
  s.start = StartKind::file;
  s.start_positions.assign(6, {{1.0, 1.0, 1.0}});
  s.start_positions.resize(12, {{2.5, 3.0, 0.0}});
  s.relax_sweeps = 0;
  EXPECT_EQ(closest_pair(Scene<3>(s)), 0.0);
  s.relax_sweeps = 100;
  const Scene<3> scene(s);
  EXPECT_GT(closest_pair(scene), 0.5);
  EXPECT_EQ(Scene<3>(s).particles().position, scene.particles().position) << "and always alike";
}

TEST(Relax, LeavesAnIdealGasAlone) {
  SceneSettings<3> s = settings<3>(periodic, {"fluid.a=0.0"});
  const Scene<3> relaxed(s);
  s.relax_sweeps = 0;
  EXPECT_EQ(relaxed.particles().position, Scene<3>(s).particles().position);
}

}  // namespace
