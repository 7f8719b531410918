#include <gtest/gtest.h>

#include "odpd/analysis/heat.h"
#include "odpd/analysis/stress.h"
#include "odpd/analysis/thermo.h"
#include "odpd/core/parallel.h"
#include "records.h"
#include "support/dimensions.h"
#include "support/memory_archive.h"

namespace {

using odpd::Clock;
using odpd::Scene;
using odpd::StepRecord;
using odpd::Stress;
using odpd::StressBins;
using odpd::Vec;

template <class T>
class StressTest : public ::testing::Test {};
TYPED_TEST_SUITE(StressTest, support::Dimensions);

// The component of `stress_of` of one part.
template <int D>
double at(const std::vector<double>& stress, std::size_t part, int a, int b) {
  return stress[(part * D + static_cast<std::size_t>(a)) * D + static_cast<std::size_t>(b)];
}

// Two particles, 0.6 e_x + 0.2 e_y apart at the start and 0.5 e_x at r*, across the border.
template <int D>
struct TwoStages {
  TwoStages() : scene(settings()), record(records::record(scene)) {
    record.corrector.position = record.start.position;
    record.corrector.position[0][1] -= 0.2;
    record.corrector.position[0][0] = 0.1;
    odpd::PairList<D> list(scene.box(), 1.0, 0.0);
    list.update(record.corrector.position);
    scene.model().write_edges(list, scene.box(), record.corrector.position, scene.particles(),
                              record.corrector.network);
    record.corrector.velocity = record.start.velocity;
    record.start.velocity[0][0] = 2.0;
    record.corrector.velocity[1][0] = 3.0;
    record.edge_noise = {Vec<D>{}};
    record.edge_noise[0][0] = 7.0;
    record.edge_noise[0][1] = 7.0 / 3.0;
  }
  static odpd::SceneSettings<D> settings() {
    std::vector<Vec<D>> r(2, support::uniform_vec<D>(2.0));
    r[0][0] = 0.2;
    r[0][1] = 2.2;
    r[1][0] = 3.6;
    auto s = records::periodic<D>(4.0, r);
    s.model = odpd::make_dpd<D>({.a = 10.0, .gamma = 2.0, .s = 1.0, .kT = 0.5});
    return s;
  }
  Scene<D> scene;
  StepRecord<D> record;
};

// Each stage with its own arm and weight, the noise with the arm of the start in both.
TYPED_TEST(StressTest, StagesHaveTheirWeightsAndTheNoiseTheFirstArm) {
  constexpr int D = TypeParam::D;
  TwoStages<D> t;
  const double v = std::pow(4.0, D), r = std::hypot(0.6, 0.2);
  for (const double b : {0.5, 0.0}) {
    t.record.start_weight = b;
    const auto stress = odpd::stress_of(t.scene, t.scene.particles(), t.record, StressBins{});
    const double f_1 = 10.0 * (1.0 - r), f_2 = 5.0;
    // f_1 e, arm r e: r f_1 e e
    const double e_x = 0.6 / r, e_y = 0.2 / r;
    EXPECT_NEAR(at<D>(stress, odpd::conservative_part, 0, 0),
                -(b * r * f_1 * e_x * e_x + (1.0 - b) * 0.5 * f_2) / v, 1e-13);
    EXPECT_NEAR(at<D>(stress, odpd::conservative_part, 0, 1), -b * r * f_1 * e_x * e_y / v, 1e-13);
    // slip 2 e_x at the start, -3 e_x at r*
    const double d_1 = -2.0 * (1.0 - r) * 2.0 * e_x, d_2 = -2.0 * 0.5 * -3.0;
    EXPECT_NEAR(at<D>(stress, odpd::friction_part, 0, 0),
                -(b * r * d_1 * e_x * e_x + (1.0 - b) * 0.5 * d_2) / v, 1e-13);
    EXPECT_NEAR(at<D>(stress, odpd::friction_part, 1, 0), -b * r * d_1 * e_x * e_y / v, 1e-13);
    EXPECT_NEAR(at<D>(stress, odpd::noise_part, 0, 0), -0.6 * 7.0 / v, 1e-13);
    EXPECT_NEAR(at<D>(stress, odpd::noise_part, 1, 0), -0.2 * 7.0 / v, 1e-13);
    EXPECT_NEAR(at<D>(stress, odpd::noise_part, 0, 1), -0.6 * 7.0 / 3.0 / v, 1e-13);
    for (int c = 0; c < D; ++c)
      EXPECT_NEAR(at<D>(stress, odpd::kinetic_part, c, c), -2.0 * 0.5 / v, 1e-14);
    EXPECT_EQ(at<D>(stress, odpd::kinetic_part, 0, 1), 0.0);
  }
}

// A line counts in each bin by its share: from x = 0.2 down to -0.4, in bins of 0.5.
TYPED_TEST(StressTest, LinesAreSharedAmongBins) {
  constexpr int D = TypeParam::D;
  const TwoStages<D> t;
  StepRecord<D> record = t.record;
  record.start_weight = 1.0;
  const StressBins bins{.axis = 0, .bins = 8};
  const auto stress = odpd::stress_of(t.scene, t.scene.particles(), record, bins);
  ASSERT_EQ(stress.size(), (odpd::stress_parts + 8) * D * D);
  const auto bin = [&](std::size_t b) { return at<D>(stress, odpd::stress_parts + b, 1, 0); };
  double all = 0.0;
  for (std::size_t part = 0; part < odpd::stress_parts; ++part) all += at<D>(stress, part, 1, 0);
  EXPECT_GT(std::abs(all), 1e-3);
  EXPECT_NEAR(bin(0), 8.0 * all * 0.2 / 0.6, 1e-13);
  EXPECT_NEAR(bin(7), 8.0 * all * 0.4 / 0.6, 1e-13);
  for (std::size_t b = 1; b < 7; ++b) EXPECT_EQ(bin(b), 0.0) << b;
}

// A fluid particle 0.3 above the surface, a wall's particle 0.1 below it: three quarters of the line are inside.
TYPED_TEST(StressTest, OfALineIntoAWallThePartInsideCounts) {
  constexpr int D = TypeParam::D;
  auto r = std::vector<Vec<D>>(1, support::uniform_vec<D>(2.0));
  r[0][1] = 1.3;
  auto s = records::periodic<D>(4.0, r);
  records::add_walls(s, 0.0);
  for (auto& wall : s.walls) wall.layers = {{.depth = 0.1, .count = 0, .spacing = 4.0}};
  s.model = odpd::make_dpd<D>({.a = 10.0});
  const Scene<D> scene(s);
  auto record = records::record(scene);
  ASSERT_EQ(record.start.network.size(), 1);
  const double volume = 2.0 * std::pow(4.0, D - 1), all = -0.4 * 6.0 / volume;
  for (const std::int64_t bins : {0, 4}) {
    const auto stress =
        odpd::stress_of(scene, scene.particles(), record, StressBins{.axis = 1, .bins = bins});
    EXPECT_NEAR(at<D>(stress, odpd::conservative_part, 1, 1), 0.75 * all, 1e-13);
    if (bins == 0) continue;
    EXPECT_NEAR(at<D>(stress, odpd::stress_parts, 1, 1), 4.0 * (0.75 * all - 1.0 / volume), 1e-12);
  }
}

// Kinetic and conservative parts are thermo's pressure; bins add up to the whole; bits do not depend on threads.
TYPED_TEST(StressTest, AgreesWithThermoAndItsBins) {
  constexpr int D = TypeParam::D;
  const auto r = support::random_points<D>({}, support::uniform_vec<D>(5.0), 700, 2);
  auto s = records::periodic<D>(5.0, r);
  s.model = odpd::make_dpd<D>({.gamma_perp = 2.0});
  const Scene<D> scene(s);
  auto record = records::record(scene);
  record.start.velocity = support::random_vectors<D>(r.size(), 3);
  record.edge_noise =
      support::random_vectors<D>(static_cast<std::size_t>(record.start.network.size()), 4);
  odpd::Thermo<D> thermo({.kind = "thermo", .name = "thermo"}, scene);
  Stress<D> stress({.kind = "stress", .name = "s"}, {.axis = 1, .bins = 7}, scene);
  thermo.measure(Clock{}, scene.particles(), record);
  stress.measure(Clock{}, scene.particles(), record);
  const auto results = records::results(stress);
  EXPECT_NEAR(records::mean(results, "s.pressure.kinetic") +
                  records::mean(results, "s.pressure.conservative"),
              records::mean(records::results(thermo), "pressure"), 1e-8);
  EXPECT_NEAR(records::mean(results, "s.pressure"),
              -(records::mean(results, "s.xx") + records::mean(results, "s.yy") +
                (D > 2 ? records::mean(results, "s.zz") : 0.0)) /
                  D,
              1e-10);
  const auto& table = results.tables.at(0).second;
  ASSERT_EQ(table.rows.size(), 7u);
  for (std::size_t k = 0; k < D * D; ++k) {
    double sum = 0.0;
    for (const auto& row : table.rows) sum += row[1 + 2 * k] / 7.0;
    EXPECT_NEAR(sum, records::mean(results, "s." + stress.series_columns()[k]), 1e-8) << k;
  }
  ASSERT_FALSE(results.notes.empty()) << "one stage only, at mass 0";
  EXPECT_NE(results.notes[0].find("no second stage"), std::string::npos);

  odpd::set_threads(2, 0);
  Stress<D> threaded({.kind = "stress", .name = "s"}, {.axis = 1, .bins = 7}, scene);
  threaded.measure(Clock{}, scene.particles(), record);
  odpd::set_threads(1, 0);
  EXPECT_EQ(threaded.series_row(), stress.series_row());
  support::MemoryArchive archive;
  stress.save(archive);
  Stress<D> copy({.kind = "stress", .name = "s"}, {.axis = 1, .bins = 7}, scene);
  copy.load(archive);
  EXPECT_EQ(records::mean(records::results(copy), "s.xy"), records::mean(results, "s.xy"));
  EXPECT_FALSE(records::results(copy).notes.empty());
}

// So they are between walls, with particles behind their surfaces, and with bodies, of which one lies across a surface.
TEST(Stress, AgreesWithThermoBetweenWalls) {
  auto s = records::periodic<2>(5.0, support::random_points<2>({{0.0, 0.7}}, {{5.0, 4.3}}, 60, 5));
  records::add_walls(s, 0.0);
  for (auto& wall : s.walls)
    wall.layers = {{.depth = 0.0, .count = 14}, {.depth = 0.4, .count = 9}};
  odpd::BodySettings<2> pair;
  pair.name = "pair";
  pair.shape = {{{-0.2, 0.0}}, {{0.2, 0.0}}};
  pair.positions = {{{1.0, 3.9}}, {{3.0, 2.0}}};
  pair.motion = odpd::BodyMotion::free;
  auto obstacle = pair;
  obstacle.name = "obstacle";
  obstacle.motion = odpd::BodyMotion::fixed;
  obstacle.positions = {{{2.0, 3.0}}};
  s.bodies = {pair, obstacle};
  s.model = odpd::make_dpd<2>({});
  Scene<2> scene(s);
  auto& particles = scene.particles();
  auto record = records::record(scene);
  record.start.arms.assign(record.start.position.size(), {});
  for (const auto& body : particles.bodies)
    for (const std::int64_t id : body.members) {
      const auto i =
          static_cast<std::size_t>(particles.index_of_id()[static_cast<std::size_t>(id)]);
      record.start.arms[i] = scene.box().separation(record.start.position[i], body.pose.centre);
    }
  odpd::Thermo<2> thermo({.kind = "thermo", .name = "thermo"}, scene);
  Stress<2> stress({.kind = "stress", .name = "s"}, {}, scene);
  thermo.measure(Clock{}, particles, record);
  stress.measure(Clock{}, particles, record);
  const auto results = records::results(stress);
  EXPECT_LT(records::mean(results, "s.pressure.kinetic"), 62.0 / 15.0)
      << "some are behind a surface";
  EXPECT_NEAR(records::mean(results, "s.pressure.kinetic") +
                  records::mean(results, "s.pressure.conservative"),
              records::mean(records::results(thermo), "pressure"), 1e-10);
}

TEST(Stress, WithMassTheVelocitiesCarryMomentum) {
  auto s = records::periodic<2>(4.0, {{{1.0, 1.0}}, {{3.0, 3.0}}});
  s.mass = 0.5;
  const Scene<2> scene(s);
  auto record = records::record(scene);
  record.v_start = {{{1.0, 2.0}}, {{-3.0, 1.0}}};
  const auto stress = odpd::stress_of(scene, scene.particles(), record, StressBins{});
  EXPECT_NEAR(at<2>(stress, odpd::kinetic_part, 0, 0), -0.5 * 10.0 / 16.0, 1e-15);
  EXPECT_NEAR(at<2>(stress, odpd::kinetic_part, 0, 1), -0.5 * -1.0 / 16.0, 1e-15);
  EXPECT_NEAR(at<2>(stress, odpd::kinetic_part, 1, 1), -0.5 * 5.0 / 16.0, 1e-15);
}

// Whatever the velocities, produced heat is the power of friction and noise; the balance closes only for the velocities that
// solve it, so random ones leave a residual.
TYPED_TEST(StressTest, HeatOfAPair) {
  constexpr int D = TypeParam::D;
  TwoStages<D> t;
  t.record.start_weight = 1.0;
  for (auto* column : {&t.record.start.potential_force, &t.record.start.driving_force})
    column->resize(2);
  odpd::Heat<D> heat({.kind = "heat", .name = "heat"}, t.scene);
  heat.measure(Clock{}, t.scene.particles(), t.record);
  const auto results = records::results(heat);
  const double v = std::pow(4.0, D), r = std::hypot(0.6, 0.2), e_x = 0.6 / r;
  const double friction = 2.0 * (1.0 - r) * std::pow(2.0 * e_x, 2), noise = -7.0 * 2.0;
  EXPECT_NEAR(records::mean(results, "heat.produced"), (friction + noise) / v, 1e-13);
  EXPECT_NEAR(records::mean(results, "heat.energy_rate"), -2.0 * 10.0 * (1.0 - r) * e_x / v, 1e-13);
  EXPECT_GT(records::mean(results, "heat.residual"), 0.1);
}

}  // namespace
