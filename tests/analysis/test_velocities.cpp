// Velocity statistics from given velocities: what is counted, relative to what, and what is refused.
#include <gtest/gtest.h>

#include <cmath>

#include "odpd/analysis/velocities.h"
#include "records.h"
#include "support/errors.h"

namespace {

using odpd::Clock;
using odpd::Scene;
using odpd::Vec;
using odpd::Velocities;

/// Two particles, a molecule of two and a free body of two, of mass 2 at kT = 0.5.
odpd::SceneSettings<2> six() {
  auto s = records::periodic<2>(8.0, {{{1.0, 1.0}}, {{3.0, 1.0}}, {{4.8, 5.0}}, {{5.2, 5.0}}});
  s.mass = 2.0;
  s.model = odpd::make_dpd<2>({.a = 10.0, .kT = 0.5});
  odpd::MoleculeSettings<2> molecule;
  molecule.name = "dimer";
  molecule.shape = {{{-0.2, 0.0}}, {{0.2, 0.0}}};
  molecule.species = {0, 0};
  molecule.positions = {{{5.0, 5.0}}};
  s.molecules = {molecule};
  odpd::BodySettings<2> pair;
  pair.name = "pair";
  pair.shape = {{{-0.1, 0.0}}, {{0.1, 0.0}}};
  pair.positions = {{{2.0, 5.0}}};
  pair.motion = odpd::BodyMotion::free;
  s.bodies = {pair};
  return s;
}

Velocities<2> observer(const Scene<2>& scene, std::vector<int> directions = {0, 1}) {
  return {{.kind = "velocities", .name = "v"}, {std::move(directions), 4.0, 16}, scene};
}

/// Of each identity, with the velocities of a step's start.
odpd::StepRecord<2> record_of(const Scene<2>& scene, const std::vector<Vec<2>>& velocity) {
  auto record = records::record(scene);
  for (const std::int64_t id : scene.particles().id)
    record.v_start.push_back(velocity[static_cast<std::size_t>(id)]);
  return record;
}

// By hand: all move by (7, -3) besides; the rest adds up to zero.
TEST(Velocities, OfParticlesAndCentresRelativeToTheMean) {
  const Scene<2> scene(six());
  ASSERT_EQ(scene.particles().moving_count(), 6);
  std::vector<Vec<2>> v{{{0.3, 0.0}},  {{-0.1, 0.2}}, {{0.4, -0.6}},
                        {{-0.2, 0.2}}, {{-0.3, 0.3}}, {{-0.1, -0.1}}};
  for (Vec<2>& velocity : v) velocity += Vec<2>{{7.0, -3.0}};
  auto velocities = observer(scene);
  velocities.measure(Clock{}, scene.particles(), record_of(scene, v));
  const auto results = records::results(velocities);
  // Identities 0 and 1 are the body's, 2 and 3 the molecule's.
  const double single = (0.52 + 0.08 + 0.18 + 0.02) / 8.0;
  const double exact = 0.5 / 2.0;
  EXPECT_NEAR(records::mean(results, "v.fluid.variance"), single, 1e-14);
  EXPECT_NEAR(records::mean(results, "v.fluid.ratio"), single / (exact * 5.0 / 6.0), 1e-13);
  EXPECT_NEAR(records::mean(results, "v.molecule.dimer.variance"), (0.01 + 0.04) / 2.0, 1e-14);
  EXPECT_NEAR(records::mean(results, "v.body.pair.variance"), (0.01 + 0.01) / 2.0, 1e-14);
  EXPECT_NEAR(records::mean(results, "v.body.pair.ratio"), 0.01 / (exact / 2.0 * 4.0 / 6.0), 1e-13);
  // One component: 0.4, -0.2, -0.3 and -0.1 of the particles.
  auto along_x = observer(scene, {0});
  along_x.measure(Clock{}, scene.particles(), record_of(scene, v));
  EXPECT_NEAR(records::mean(records::results(along_x), "v.fluid.variance"),
              (0.16 + 0.04 + 0.09 + 0.01) / 4.0, 1e-14);
}

// By hand: of bodies of two and four particles among ten the variances are .25/2 (1 - 2/10) and .25/4 (1 - 4/10).
TEST(Velocities, OfBodiesOfSeveralSizesInUnitsOfTheirOwn) {
  odpd::SceneSettings<2> s = six();
  odpd::BodySettings<2>& body = s.bodies[0];
  body.shapes = {body.shape, {{{-0.1, 0.1}}, {{0.1, 0.1}}, {{-0.1, -0.1}}, {{0.1, -0.1}}}};
  body.positions.push_back({{8.0, 5.0}});
  const Scene<2> scene(s);
  ASSERT_EQ(scene.particles().moving_count(), 10);
  std::vector<Vec<2>> v(10, {{0.0, -0.1}});
  for (std::size_t k = 0; k < 6; ++k) v[k] = k < 2 ? Vec<2>{{0.6, 0.0}} : Vec<2>{{-0.3, 0.1}};
  auto velocities = observer(scene);
  velocities.measure(Clock{}, scene.particles(), record_of(scene, v));
  EXPECT_NEAR(records::mean(records::results(velocities), "v.body.pair.ratio"),
              (0.36 / 0.1 + 0.1 / 0.0375) / 4.0, 1e-12);
}

// Of what is beyond the range the histogram shows nothing, but the variance does; bins are 1/2 wide.
TEST(Velocities, HistogramIsADensity) {
  const Scene<2> scene(six());
  const double unit = std::sqrt(0.25 * 5.0 / 6.0);
  std::vector<Vec<2>> v(6);
  v[2] = {{0.6 * unit, -0.7 * unit}};
  v[3] = {{0.7 * unit, -3.9 * unit}};
  v[4] = {{-5.0 * unit, 4.5 * unit}};
  v[5] = {{3.7 * unit, 0.1 * unit}};  // adds up to zero along both
  auto velocities = observer(scene);
  velocities.measure(Clock{}, scene.particles(), record_of(scene, v));
  const auto results = records::results(velocities);
  EXPECT_NEAR(records::mean(results, "v.fluid.ratio"),
              (0.36 + 0.49 + 0.49 + 15.21 + 25.0 + 20.25 + 13.69 + 0.01) / 8.0, 1e-12);
  ASSERT_EQ(results.tables.size(), 1U);
  const odpd::Table& table = results.tables[0].second;
  ASSERT_EQ(table.rows.size(), 16U);
  ASSERT_EQ(table.columns[2], "fluid");
  for (const auto& row : table.rows) {
    EXPECT_NEAR(row[1], std::exp(-0.5 * row[0] * row[0]) / std::sqrt(8.0 * std::atan(1.0)), 1e-15);
    const double middle = row[0];
    const double counts = middle == -3.75 || middle == -0.75 || middle == 0.25 || middle == 3.75
                              ? 1.0
                              : (middle == 0.75 ? 2.0 : 0.0);
    EXPECT_NEAR(row[2], counts / 8.0 / 0.5, 1e-14) << middle;
  }
}

// Walls take up momentum: velocities count as they are, and none is missing from the exact variance.
TEST(Velocities, BetweenWallsNothingIsTakenOff) {
  auto s = records::periodic<2>(8.0, {{{1.0, 3.0}}, {{3.0, 3.0}}});
  records::add_walls(s, 0.0);
  s.mass = 2.0;
  s.model = odpd::make_dpd<2>({.a = 10.0, .kT = 0.5});
  const Scene<2> scene(s);
  auto velocities = observer(scene, {1});
  std::vector<Vec<2>> v(scene.particles().position.size(), Vec<2>{{0.0, 0.3}});
  velocities.measure(Clock{}, scene.particles(), record_of(scene, v));
  EXPECT_NEAR(records::mean(records::results(velocities), "v.fluid.ratio"), 0.09 / 0.25, 1e-14);
}

TEST(Velocities, RefusesFluidsWithoutThem) {
  const auto refuse = [](double mass, double kT, std::initializer_list<const char*> parts) {
    auto s = six();
    s.mass = mass;
    s.model = odpd::make_dpd<2>({.a = 10.0, .kT = kT});
    const Scene<2> scene(s);
    const odpd::Config config = odpd::Config::from_text("", "case.toml");
    const Clock clock{.dt = 0.01, .total_steps = 10};
    support::expect_error<odpd::ConfigError>(
        [&] {
          Velocities<2>::make({"velocities", config, scene, clock, true});
        },
        parts);
  };
  refuse(0.0, 0.5, {"mass = 0", "white noise", "fluid.mass"});
  refuse(1.0, 0.0, {"kT = 0"});
}

}  // namespace
