#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "odpd/analysis/divergence.h"
#include "odpd/analysis/registry.h"
#include "odpd/analysis/viscosity.h"
#include "records.h"
#include "support/dimensions.h"
#include "support/errors.h"
#include "support/memory_archive.h"

namespace {

using odpd::Clock;
using odpd::Scene;
using odpd::Vec;
using odpd::Viscosity;
using odpd::ViscosityScene;

TEST(Viscosity, ControlKnowsTheNoiseOfMasslessTwoStageSchemes) {
  const auto refused = [](double mass, const char* integrator, const std::string& keys,
                          std::initializer_list<const char*> parts) {
    auto s = records::periodic<2>(5.0, {{{1.0, 1.0}}, {{3.0, 3.0}}});
    s.mass = mass;
    const Scene<2> scene(s);
    const odpd::Config config = odpd::Config::from_text(
        "[[observe]]\nkind = \"viscosity\"\ncontrol = true\n" + keys, "case.toml");
    support::expect_error<odpd::ConfigError>(
        [&] {
          odpd::make_observers<2>(config, scene, Clock{.dt = 0.02},
                                  odpd::integrator_traits(integrator));
        },
        parts);
  };
  refused(1.0, "trapezoidal", "", {"case.toml:3", "control", "fluid.mass = 0"});
  refused(0.0, "euler", "", {"control", "'trapezoidal'"});
  refused(0.0, "trapezoidal", "control_tolerance = 1.0\n", {"control_tolerance", "less than 1"});
  refused(0.0, "trapezoidal", "control_every = 20\n", {"control_every", "four"});
}

template <class T>
class ViscosityTest : public ::testing::Test {};
TYPED_TEST_SUITE(ViscosityTest, support::Dimensions);

// One particle in the middle of each of eight layers across y, from 0 (or 1, between walls) to 8 (9).
template <int D>
odpd::SceneSettings<D> layers(double from, double kT = 1.0) {
  std::vector<Vec<D>> r(8, support::uniform_vec<D>(2.0));
  for (int k = 0; k < 8; ++k) r[static_cast<std::size_t>(k)][1] = from + 0.5 + k;
  auto s = records::periodic<D>(8.0, r);
  s.box.size[1] += 2.0 * from;
  s.model = odpd::make_dpd<D>({.a = 0.0, .gamma = 2.0, .s = 0.0, .cutoff = 0.9, .kT = kT});
  return s;
}

/// Records of v_x = field(y) and a little noise, which the second half of them takes back.
template <int D, class Field>
odpd::Results measured(Viscosity<D>& viscosity, const Scene<D>& scene, const Field& field) {
  auto record = records::record(scene);
  const auto noise = support::random_numbers(100, 4);
  for (std::size_t t = 0; t < 200; ++t) {
    for (std::size_t i = 0; i < record.v_mid.size(); ++i) {
      record.v_mid[i] = {};
      record.v_mid[i][0] =
          field(scene.particles().position[i][1]) +
          (scene.particles().is_free(i) ? 0.01 * (t < 100 ? noise[t] : -noise[t - 100]) : 0.0);
    }
    record.start.velocity = record.v_mid;
    viscosity.measure(Clock{}, scene.particles(), record);
  }
  return records::results(viscosity);
}

template <int D>
Viscosity<D> make_viscosity(const Scene<D>& scene) {
  return Viscosity<D>({.kind = "viscosity", .name = "viscosity"}, {.bins = 8}, scene, 0.01);
}

TYPED_TEST(ViscosityTest, OfASine) {
  constexpr int D = TypeParam::D;
  auto s = layers<D>(0.0);
  s.body_force[0] = 0.3;
  s.force_wave = {.along = 1, .number = 1};
  const Scene<D> scene(s);
  EXPECT_EQ(odpd::viscosity_scene(scene).kind, ViscosityScene::Kind::sine);
  const double k = 2.0 * std::numbers::pi / 8.0;
  auto viscosity = make_viscosity(scene);
  // Averages over bins of width 1 of 0.7 sin(k y).
  const auto results = measured(viscosity, scene, [&](double y) {
    return 0.7 * std::sin(k * y) * std::sin(0.5 * k) / (0.5 * k);
  });
  const double density = 8.0 / std::pow(8.0, D);
  EXPECT_NEAR(records::mean(results, "viscosity.sine"), density * 0.3 / (k * k * 0.7), 1e-12);
  EXPECT_EQ(records::mean(results, "viscosity"), records::mean(results, "viscosity.sine"));
  EXPECT_EQ(viscosity.series_row().size(), viscosity.series_columns().size());
}

TYPED_TEST(ViscosityTest, OfOppositeRegions) {
  constexpr int D = TypeParam::D;
  auto s = layers<D>(0.0);
  Vec<D> f{};
  f[0] = 0.3;
  s.force_regions = {{.axis = 1, .from = 0.0, .to = 4.0, .force = f},
                     {.axis = 1, .from = 4.0, .to = 8.0, .force = -1.0 * f}};
  s.model = odpd::make_dpd<D>({.a = 0.0,
                               .gamma = 2.0,
                               .s = 0.0,
                               .cutoff = 0.25});  // all four layers of the first region are fitted
  const Scene<D> scene(s);
  EXPECT_EQ(odpd::viscosity_scene(scene).kind, ViscosityScene::Kind::parabola);
  auto viscosity = make_viscosity(scene);
  const auto results =
      measured(viscosity, scene, [](double y) { return y < 4.0 ? 0.2 * y * (4.0 - y) : 9.0; });
  const double density = 8.0 / std::pow(8.0, D);
  EXPECT_NEAR(records::mean(results, "viscosity.profile"), density * 0.3 / 0.4, 1e-12);
}

// A column of particles, each of which drags the next along with friction 2 across the line of centres.
TYPED_TEST(ViscosityTest, OfShearBetweenWalls) {
  constexpr int D = TypeParam::D;
  auto s = layers<D>(1.0);
  records::add_walls(s, 2.0);
  for (auto& wall : s.walls) wall.layers = {{.depth = 0.5, .count = 0, .spacing = 8.0}};
  s.model = odpd::make_dpd<D>({.a = 0.0, .gamma = 2.0, .gamma_perp = 2.0, .s = 0.0, .cutoff = 1.1});
  Scene<D> scene(s);
  // One particle per layer and wall, all in a column.
  for (auto& r : scene.particles().position)
    for (int c = 0; c < D; ++c)
      if (c != 1) r[c] = 2.0;
  EXPECT_EQ(odpd::viscosity_scene(scene).kind, ViscosityScene::Kind::sheared);
  auto viscosity = make_viscosity(scene);
  const auto results = measured(viscosity, scene, [](double y) { return 2.0 / 4.5 * (y - 5.0); });
  // Each layer pulls the next with zeta slip = 2 * 0.444, per area.
  const double stress = 2.0 * (2.0 / 4.5) / std::pow(8.0, D - 1), slope = 2.0 / 4.5;
  EXPECT_NEAR(records::mean(results, "viscosity.shear_rate"), slope, 1e-12);
  EXPECT_NEAR(records::mean(results, "viscosity.wall"), stress / slope, 1e-10);
  EXPECT_NEAR(records::mean(results, "viscosity.stress"), stress / slope, 1e-10);
  EXPECT_GT(records::error(results, "viscosity"), 0.0);
  support::MemoryArchive archive;
  viscosity.save(archive);
  auto copy = make_viscosity(scene);
  copy.load(archive);
  EXPECT_EQ(records::mean(records::results(copy), "viscosity.wall"),
            records::mean(results, "viscosity.wall"));
}

TYPED_TEST(ViscosityTest, ScenesAreTold) {
  constexpr int D = TypeParam::D;
  using Kind = ViscosityScene::Kind;
  const auto kind = [](const odpd::SceneSettings<D>& s) {
    return odpd::viscosity_scene(Scene<D>(s)).kind;
  };
  EXPECT_EQ(kind(layers<D>(0.0)), Kind::at_rest);
  EXPECT_EQ(kind(layers<D>(0.0, 0.0)), Kind::none);
  auto channel = layers<D>(1.0);
  records::add_walls(channel, 0.0);
  EXPECT_EQ(kind(channel), Kind::none);
  channel.body_force[0] = 0.1;
  EXPECT_EQ(kind(channel), Kind::parabola);
}

// Waves along x and y of the velocity along x: the first has a divergence, the second is shear.
TEST(Divergence, OfAPeriodicWave) {
  constexpr int n = 8;
  std::vector<Vec<2>> r;
  for (int x = 0; x < n; ++x)
    for (int y = 0; y < n; ++y) r.push_back({{x + 0.5, y + 0.5}});
  const Scene<2> scene(records::periodic<2>(8.0, r));
  odpd::Divergence<2> divergence({.kind = "divergence", .name = "div"}, {n, n}, scene);
  auto record = records::record(scene);
  record.dt = 0.0;
  const double k = 2.0 * std::numbers::pi / 8.0;
  const auto noise = support::random_vectors<2>(100 * r.size(), 5);
  for (std::size_t t = 0; t < 200; ++t) {
    for (std::size_t i = 0; i < r.size(); ++i) {
      const Vec<2>& w = noise[(t % 100) * r.size() + i];
      record.v_mid[i] = {{0.3 * std::sin(k * r[i][0]) + 0.4 * std::sin(k * r[i][1]), 0.0}};
      record.v_mid[i] += (t < 100 ? 0.01 : -0.01) * w;
    }
    divergence.measure(Clock{}, scene.particles(), record);
  }
  const auto results = records::results(divergence);
  const double difference = std::sin(k);  // central differences of sin(k x): cos(k x) sin(k)
  EXPECT_NEAR(records::mean(results, "div.rms"), 0.3 * difference / std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(records::mean(results, "div.gradient"), 0.5 * difference / std::sqrt(2.0), 1e-3);
  EXPECT_NEAR(records::mean(results, "div.relative"), 0.6, 2e-3);
  // Four independent velocities of error 0.01/sqrt(200), each with weight 1/2; block errors are up to 30 % high.
  EXPECT_NEAR(records::mean(results, "div.noise"), 0.01 / std::sqrt(200.0),
              0.4 * 0.01 / std::sqrt(200.0));
}

}  // namespace
