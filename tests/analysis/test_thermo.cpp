#include <gtest/gtest.h>

#include "odpd/analysis/thermo.h"
#include "records.h"
#include "support/dimensions.h"
#include "support/memory_archive.h"
#include "support/pair_functions.h"

namespace {

using odpd::Clock;
using odpd::Scene;
using odpd::Thermo;
using odpd::Vec;

template <class T>
class ThermoTest : public ::testing::Test {};
TYPED_TEST_SUITE(ThermoTest, support::Dimensions);

// Two particles 0.6 apart: u = a/2 0.4^2, f = 0.4 a, k = a, lap = k - (d - 1) f/r for each.
TYPED_TEST(ThermoTest, APair) {
  constexpr int D = TypeParam::D;
  std::vector<Vec<D>> r(2, support::uniform_vec<D>(0.2));
  r[1][0] = 3.6;  // across the border of a box of 4
  auto s = records::periodic<D>(4.0, r);
  s.model = odpd::make_dpd<D>({.a = 10.0, .kT = 0.5});
  const Scene<D> scene(s);
  Thermo<D> thermo({.kind = "thermo", .name = "thermo"}, scene);
  thermo.measure(Clock{}, scene.particles(), records::record(scene));
  const auto results = records::results(thermo);
  const double volume = std::pow(4.0, D), force = 4.0, laplacian = 10.0 - (D - 1) * force / 0.6;
  EXPECT_NEAR(records::mean(results, "energy_per_particle"), 0.5 * 5.0 * 0.16, 1e-12);
  EXPECT_NEAR(records::mean(results, "pressure"), (2 * 0.5 + 0.6 * force / D) / volume, 1e-12);
  EXPECT_NEAR(records::mean(results, "config_temperature"), force * force / laplacian, 1e-11);
  EXPECT_TRUE(std::isnan(records::error(results, "pressure"))) << "one sample has no error";
  EXPECT_EQ(thermo.series_row().size(), thermo.series_columns().size());
}

// A fluid particle 0.6 behind the surface, right below the only particle of the wall: the edge
// counts in full in the energy, with nothing of it between the surfaces not at all in the pressure, and
// only the free particle counts in the temperature.
TYPED_TEST(ThermoTest, AParticleBehindAWall) {
  constexpr int D = TypeParam::D;
  auto s = records::periodic<D>(4.0, {support::uniform_vec<D>(2.0)});
  records::add_walls(s, 0.0);
  for (auto& wall : s.walls) {
    wall.layers = {{.depth = 0.0, .count = 0, .spacing = 4.0}};  // one particle, at 2, 1, 2
    wall.stiffness = 50.0;
  }
  s.model = odpd::make_dpd<D>({.a = 10.0, .kT = 0.5});
  Scene<D> scene(s);
  ASSERT_EQ(scene.particles().size(), 3);
  scene.particles().position[2][1] = 0.4;  // 0.6 below the wall's particle, 0.6 behind its surface
  Thermo<D> thermo({.kind = "thermo", .name = "second"}, scene);
  thermo.measure(Clock{}, scene.particles(), records::record(scene));
  const auto results = records::results(thermo);
  const double push = 50.0 * 0.6 - 4.0;
  const double laplacian = 10.0 - (D - 1) * 4.0 / 0.6 + 50.0;
  EXPECT_NEAR(records::mean(results, "second.energy_per_particle"), 0.8 + 25.0 * 0.36, 1e-11);
  EXPECT_EQ(records::mean(results, "second.pressure"), 0.0);
  EXPECT_NEAR(records::mean(results, "second.config_temperature"), push * push / laplacian, 1e-10);
}

// A fluid particle 0.3 above the surface, a wall's particle 0.1 below it: three quarters of the line are inside, and
// so much of the virial counts.
TYPED_TEST(ThermoTest, OfALineIntoAWallThePartInsideCounts) {
  constexpr int D = TypeParam::D;
  std::vector<Vec<D>> r(1, support::uniform_vec<D>(2.0));
  r[0][1] = 1.3;
  auto s = records::periodic<D>(4.0, r);
  records::add_walls(s, 0.0);
  for (auto& wall : s.walls) wall.layers = {{.depth = 0.1, .count = 0, .spacing = 4.0}};
  s.model = odpd::make_dpd<D>({.a = 10.0, .kT = 0.5});
  const Scene<D> scene(s);
  Thermo<D> thermo({.kind = "thermo", .name = "thermo"}, scene);
  thermo.measure(Clock{}, scene.particles(), records::record(scene));
  const auto results = records::results(thermo);
  const double volume = std::pow(4.0, D - 1) * 2.0;
  EXPECT_NEAR(records::mean(results, "pressure"), (0.5 + 0.75 * 0.4 * 6.0 / D) / volume, 1e-12);
  EXPECT_NEAR(records::mean(results, "energy_per_particle"), 0.5 * 10.0 * 0.36, 1e-12);
}

// Two rigid pairs 0.6 apart and one free particle far away: the energy of the one edge belongs to all five that move.
TEST(Thermo, ParticlesOfBodiesShareTheEnergy) {
  auto s = records::periodic<2>(8.0, {{{6.0, 6.0}}});
  odpd::BodySettings<2> pair;
  pair.name = "pair";
  pair.shape = {{{-0.1, 0.0}}, {{0.1, 0.0}}};
  pair.positions = {{{2.0, 2.0}}, {{2.0, 2.6}}};
  pair.motion = odpd::BodyMotion::free;
  s.bodies = {pair};
  s.model = odpd::make_dpd<2>({.a = 10.0, .kT = 0.5});
  const Scene<2> scene(s);
  ASSERT_EQ(scene.particles().moving_count(), 5);
  Thermo<2> thermo({.kind = "thermo", .name = "thermo"}, scene);
  thermo.measure(Clock{}, scene.particles(), records::record(scene));
  // Edges straight up and across between the two pairs.
  const double across = std::hypot(0.6, 0.2);
  const double energy = 2.0 * 5.0 * 0.16 + 2.0 * 5.0 * std::pow(1.0 - across, 2);
  EXPECT_NEAR(records::mean(records::results(thermo), "energy_per_particle"), energy / 5.0, 1e-12);
}

// Of a force that jumps at its end there is no Laplacian, and so no temperature.
TYPED_TEST(ThermoTest, AJumpOfTheForceLeavesNoTemperature) {
  constexpr int D = TypeParam::D;
  std::vector<Vec<D>> r(2, support::uniform_vec<D>(0.2));
  r[1][0] = 0.7;
  auto s = records::periodic<D>(4.0, r);
  s.model = support::gaussian<D>(18.5, 0.3, 1.0);
  const Scene<D> scene(s);
  Thermo<D> thermo({.kind = "thermo", .name = "thermo"}, scene);
  thermo.measure(Clock{}, scene.particles(), records::record(scene));
  const auto results = records::results(thermo);
  EXPECT_TRUE(std::isnan(records::mean(results, "config_temperature")));
  ASSERT_EQ(results.notes.size(), 1U);
  EXPECT_NE(results.notes[0].find("config_temperature is undefined"), std::string::npos);
  EXPECT_TRUE(std::isfinite(records::mean(results, "pressure")));
}

// At r = 0 the Laplacian is infinite: that edge is left out, and one such sample spoils no average.
TYPED_TEST(ThermoTest, CoincidentParticlesSpoilNoAverage) {
  constexpr int D = TypeParam::D;
  std::vector<Vec<D>> r(4, support::uniform_vec<D>(1.0));
  r[1][0] = 1.6;
  r[2] = r[3] = support::uniform_vec<D>(3.0);
  auto s = records::periodic<D>(4.0, r);
  s.model = odpd::make_dpd<D>({.a = 10.0});
  const Scene<D> scene(s);
  Thermo<D> thermo({.kind = "thermo", .name = "thermo"}, scene);
  thermo.measure(Clock{}, scene.particles(), records::record(scene));
  const double laplacian = 10.0 - (D - 1) * 4.0 / 0.6;
  // The coincident pair pushes with a each, the other with 0.4 a.
  EXPECT_NEAR(thermo.series_row()[2], 2 * 100.0 + 2 * 16.0, 1e-10);
  EXPECT_NEAR(thermo.series_row()[3], 2 * laplacian, 1e-10);
  EXPECT_NEAR(records::mean(records::results(thermo), "config_temperature"),
              232.0 / (2 * laplacian), 1e-10);
}

TEST(Thermo, AnIdealGasHasNoConfigurationalTemperature) {
  auto s = records::periodic<2>(4.0, {{{1.0, 1.0}}, {{1.5, 1.0}}});
  s.model = odpd::make_dpd<2>({.a = 0.0});
  const Scene<2> scene(s);
  Thermo<2> thermo({.kind = "thermo", .name = "thermo"}, scene);
  EXPECT_TRUE(std::isnan(records::mean(records::results(thermo), "pressure"))) << "nothing yet";
  thermo.measure(Clock{}, scene.particles(), records::record(scene));
  const auto results = records::results(thermo);
  EXPECT_EQ(records::mean(results, "energy_per_particle"), 0.0);
  EXPECT_NEAR(records::mean(results, "pressure"), 2.0 / 16.0, 1e-15);
  EXPECT_TRUE(std::isnan(records::mean(results, "config_temperature")));
}

// Samples of the canonical distribution of one particle in the harmonic well of the walls: u has
// the mean kT/2 and the configurational temperature is kT. n independent samples: standard errors
// kT/sqrt(2 n) and kT sqrt(2/n); bounds 5 of them.
TEST(Thermo, TemperatureOfAHarmonicWell) {
  constexpr double kT = 0.7;
  constexpr std::size_t n = 4000;
  auto s = records::periodic<2>(6.0, {{{3.0, 3.0}}});
  records::add_walls(s, 0.0);
  s.walls[1].thickness = 2.5;  // the fluid space ends at 1 and 3.5
  s.walls[0].thickness = 1.0;
  s.model = odpd::make_dpd<2>({.a = 0.0, .kT = kT});
  Scene<2> scene(s);
  Thermo<2> thermo({.kind = "thermo", .name = "thermo"}, scene);
  const auto x = support::random_numbers(n, 5);
  for (const double value : x) {
    // Half of a harmonic well: behind the lower surface by |x| sqrt(kT/k).
    scene.particles().position.back()[1] = 1.0 - std::abs(value) * std::sqrt(kT / 1000.0);
    thermo.measure(Clock{}, scene.particles(), records::record(scene));
  }
  const auto results = records::results(thermo);
  EXPECT_NEAR(records::mean(results, "energy_per_particle"), 0.5 * kT,
              5.0 * kT / std::sqrt(2.0 * n));
  EXPECT_NEAR(records::mean(results, "config_temperature"), kT, 5.0 * kT * std::sqrt(2.0 / n));
  EXPECT_NEAR(records::error(results, "config_temperature"), kT * std::sqrt(2.0 / n),
              0.5 * kT * std::sqrt(2.0 / n));
  support::MemoryArchive archive;
  thermo.save(archive);
  Thermo<2> copy({.kind = "thermo", .name = "thermo"}, scene);
  copy.load(archive);
  EXPECT_EQ(records::mean(records::results(copy), "pressure"), records::mean(results, "pressure"));
}

}  // namespace
