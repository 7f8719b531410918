// Radial distribution of the centres of bodies.
#include <gtest/gtest.h>

#include <cmath>

#include "odpd/analysis/rdf.h"
#include "odpd/analysis/registry.h"
#include "odpd/core/config.h"
#include "records.h"
#include "support/dimensions.h"
#include "support/points.h"

namespace {

using odpd::Clock;
using odpd::Rdf;
using odpd::Scene;
using odpd::StepRecord;
using odpd::Vec;

template <class T>
class BodyStructureTest : public ::testing::Test {};
TYPED_TEST_SUITE(BodyStructureTest, support::Dimensions);

// Centres, 1.1 apart through the border, of dimers of two kinds, the other way round, in a fluid that does not count.
TYPED_TEST(BodyStructureTest, CentresOfBodies) {
  constexpr int D = TypeParam::D;
  const Vec<D> size = support::uniform_vec<D>(4.0);
  auto s = records::periodic<D>(4.0, support::random_points<D>(Vec<D>{}, size, 40, 0));
  Vec<D> half{}, at = support::uniform_vec<D>(0.1);
  half[0] = 0.3;
  odpd::BodySettings<D> dimer;
  dimer.shape = {half, -1.0 * half};
  dimer.name = "a";
  dimer.positions = {at};
  at[0] = 3.0;
  dimer.positions.push_back(at);
  s.bodies.push_back(dimer);
  dimer.name = "b";
  dimer.shape = {-1.0 * half, half};
  at[1] += 1.5;
  dimer.positions = {at};
  s.bodies.push_back(dimer);
  const Scene<D> scene(s);
  Rdf<D> rdf({.kind = "rdf", .name = "g"}, {.r_max = 2.0, .bins = 5, .of_bodies = true}, scene);
  StepRecord<D> record = records::record(scene);
  record.start.arms.resize(record.start.position.size());
  for (const auto& body : scene.particles().bodies)
    for (const std::int64_t id : body.members)
      record.start.arms[static_cast<std::size_t>(id)] = scene.box().separation(
          scene.particles().position[static_cast<std::size_t>(id)], body.pose.centre);
  rdf.measure(Clock{}, scene.particles(), record);
  EXPECT_EQ(rdf.series_columns().at(5), "g_a_b_0");
  const auto row = rdf.series_row();
  const auto shell = [](double k) {
    return odpd::unit_ball_volume<D> * (std::pow(0.4 * (k + 1.0), D) - std::pow(0.4 * k, D));
  };
  for (std::size_t k = 0; k < 5; ++k) {
    EXPECT_NEAR(row[k], k == 2 ? std::pow(4.0, D) / shell(2.0) : 0.0, 1e-10) << "a - a " << k;
    EXPECT_NEAR(row[5 + k], k >= 3 ? std::pow(4.0, D) / (2.0 * shell(static_cast<double>(k))) : 0.0,
                1e-10)
        << "a - b " << k;
    EXPECT_TRUE(std::isnan(row[10 + k])) << "there is one b";
  }
}

// Centres are farther from each other than two cutoffs, as a rule.
TEST(BodyRdf, OfBodiesReachesHalfTheBox) {
  auto s = records::periodic<2>(
      7.0, support::random_points<2>(Vec<2>{}, support::uniform_vec<2>(7.0), 40, 3));
  odpd::BodySettings<2> dimer;
  dimer.shape = {{{0.3, 0.0}}, {{-0.3, 0.0}}};
  dimer.positions = {{{1.0, 1.0}}, {{4.0, 4.0}}};
  s.bodies = {dimer};
  const Scene<2> scene(s);
  const auto reach = [&](const std::string& keys) {
    const odpd::Config config =
        odpd::Config::from_text("[[observe]]\nkind = \"rdf\"\nbins = 10\n" + keys, "case.toml");
    auto observers = odpd::make_observers<2>(config, scene, Clock{.dt = 0.02});
    StepRecord<2> record = records::record(scene);
    record.start.arms.resize(record.start.position.size());
    observers[0]->measure(Clock{}, scene.particles(), record);
    const odpd::Results results = records::results(*observers[0]);
    return results.tables.at(0).second.rows.back()[0] / 0.95;
  };
  EXPECT_NEAR(reach("of = \"bodies\"\n"), 3.5, 1e-12);
  EXPECT_NEAR(reach("of = \"bodies\"\nr_max = 1.5\n"), 1.5, 1e-12);
  EXPECT_NEAR(reach(""), 2.0 * scene.model().cutoff(), 1e-12);
}

}  // namespace
