// The observer of rigid bodies: the fluid around them, and rotational diffusion about the axes that a body turns about.
#include <gtest/gtest.h>

#include <cmath>

#include "odpd/analysis/bodies.h"
#include "records.h"
#include "support/dimensions.h"
#include "support/simplex.h"

namespace {

template <class T>
class BodiesObserverTest : public ::testing::Test {};
TYPED_TEST_SUITE(BodiesObserverTest, support::Dimensions);

// Fluid fills all but a disk or sphere of 0.6 around an obstacle; once in 200 samples a particle visits its inside, which trips
// the density of the bins there but not that of the whole ball.
TYPED_TEST(BodiesObserverTest, ExclusionDoesNotTellASingleVisit) {
  constexpr int D = TypeParam::D;
  constexpr std::size_t n = 500, samples = 200;
  const odpd::Vec<D> centre = support::uniform_vec<D>(2.0);
  const auto outside = [&](std::uint64_t seed) {
    auto r = support::random_points<D>(odpd::Vec<D>{}, support::uniform_vec<D>(4.0), 2 * n, seed);
    std::erase_if(r, [&](const odpd::Vec<D>& x) { return norm(x - centre) < 0.6; });
    r.resize(n);
    return r;
  };
  auto s = records::periodic<D>(4.0, outside(0));
  odpd::BodySettings<D> point;
  point.shape = {odpd::Vec<D>{}};
  point.motion = odpd::BodyMotion::fixed;
  point.positions = {centre};
  s.bodies = {point};
  const odpd::Scene<D> scene(s);
  odpd::Bodies<D> bodies({.kind = "bodies", .name = "b"}, {.msd = {}, .around = {.r_max = 1.5}},
                         scene, 0.01, false);
  odpd::Bodies<D> near({.kind = "bodies", .name = "b"}, {.msd = {}, .around = {.r_max = 0.58}},
                       scene, 0.01, false);
  odpd::StepRecord<D> record = records::record<D>(scene);
  record.start.arms.resize(record.start.position.size());
  for (std::size_t t = 0; t < samples; ++t) {
    auto r = outside(t);
    if (t == 100) r[0] = centre + odpd::Vec<D>{{0.1}};
    std::size_t next = 0;
    for (std::size_t i = 0; i < record.start.position.size(); ++i)
      if (scene.particles().is_free(i)) record.start.position[i] = r[next++];
    bodies.measure(odpd::Clock{}, scene.particles(), record);
    near.measure(odpd::Clock{}, scene.particles(), record);
  }
  EXPECT_NEAR(records::mean(records::results(bodies), "b.body.exclusion_radius"), 0.6, 0.005);
  EXPECT_TRUE(std::isnan(records::mean(records::results(near), "b.body.exclusion_radius")));
}

// g(q) from all pairs of a body and a particle, sixty bodies of two kinds, with sliding images and without. The cells by which
// the observer finds the pairs are some r_max wide, and tilted by as much as 1.
TYPED_TEST(BodiesObserverTest, FluidAroundBodiesIsCountedWithoutMissingAny) {
  constexpr int D = TypeParam::D;
  constexpr double length = 4.0, r_max = 0.9, bin = 0.1;
  odpd::Vec<D> size = support::uniform_vec<D>(length);
  size[0] *= 2.0;
  auto s = records::periodic<D>(length, support::random_points<D>(odpd::Vec<D>{}, size, 2000, 1));
  s.box.size = size;
  const auto centres = support::random_points<D>(odpd::Vec<D>{}, size, 60, 2);
  for (const std::size_t kind : {0, 1}) {
    odpd::BodySettings<D> body;
    body.name = kind == 0 ? "a" : "b";
    body.shape = {odpd::Vec<D>{}};
    body.motion = odpd::BodyMotion::fixed;
    for (std::size_t b = kind; b < 60; b += 2) body.positions.push_back(centres[b]);
    s.bodies.push_back(body);
  }
  const odpd::Scene<D> scene(s);
  for (const double offset : {0.0, 0.7 * length, -length}) {
    odpd::StepRecord<D> record = records::record<D>(scene);
    record.start.arms.resize(record.start.position.size());
    odpd::Box<D>& box = record.start.box;
    if (offset != 0.0) {
      box.shear = odpd::Shear{};
      box.offset = offset;
      record.start.crossed.resize(record.start.position.size());
    }
    odpd::Bodies<D> bodies({.kind = "bodies", .name = "q"},
                           {.msd = {}, .around = {.r_max = r_max, .bin = bin}}, scene, 0.01, false);
    bodies.measure(odpd::Clock{}, scene.particles(), record);
    std::vector<std::vector<double>> counted(2, std::vector<double>(9, 0.0));
    const auto& particles = scene.particles();
    for (std::size_t b = 0; b < 60; ++b)
      for (std::size_t i = 0; i < record.start.position.size(); ++i) {
        if (!particles.is_free(i)) continue;
        const double q =
            norm(box.separation(record.start.position[i], particles.bodies[b].pose.centre));
        if (q < r_max) counted[scene.body_kind(b)][static_cast<std::size_t>(q / bin)] += 1.0;
      }
    const odpd::Results results = records::results(bodies);
    const auto& rows = results.tables.at(0).second.rows;
    ASSERT_EQ(rows.size(), 9u);
    for (std::size_t kind : {0, 1})
      for (std::size_t k = 0; k < 9; ++k) {
        const double inner = bin * static_cast<double>(k), outer = inner + bin;
        const double shell = odpd::unit_ball_volume<D> * (std::pow(outer, D) - std::pow(inner, D));
        EXPECT_NEAR(rows[k][1 + 2 * kind],
                    counted[kind][k] / 30.0 * s.box.volume() / 2000.0 / shell, 1e-12)
            << offset << " " << k;
      }
    EXPECT_GT(counted[0][8] + counted[1][8], 10.0);
  }
}

// Orientations step at random, variance 2 D dt about each axis that a body turns about. 100 bodies of a kind and 16 windows:
// standard errors of 2 % (three axes) and 3 % (two).
TEST(BodiesObserver, RotationalDiffusionIsPerAxis) {
  constexpr double diffusion = 0.5, dt = 0.01;
  constexpr std::size_t count = 100;
  auto s = records::periodic<3>(30.0, {{{1.0, 1.0, 1.0}}});
  for (const std::string name : {"simplex", "rod"}) {
    odpd::BodySettings<3> body;
    body.name = name;
    body.shape = (name == "rod" ? support::rod_body<3>() : support::simplex_body<3>()).frame;
    body.count = count;
    body.clearance = 0.0;
    s.bodies.push_back(body);
  }
  odpd::Scene<3> scene(s);
  odpd::BodiesSettings settings{.msd = {.window = 0.5, .fit_from = 0.1, .directions = {0, 1, 2}},
                                .around = {}};
  odpd::Bodies<3> bodies({.kind = "bodies", .name = "b", .every = 1}, settings, scene, dt);
  auto record = records::record<3>(scene);
  record.start.arms.resize(record.start.position.size());
  const auto angles = support::random_vectors<3>(2 * count * 801, 17);
  std::size_t next = 0;
  for (int step = 0; step < 801; ++step) {
    for (std::size_t b = 0; b < 2 * count; ++b) {
      auto& body = scene.particles().bodies[b];
      odpd::Vec<3> angle = std::sqrt(2.0 * diffusion * dt) * angles[next++];
      const odpd::Vec<3> a = body.pose.orientation.turn(body.frame[0]);
      if (b >= count) angle -= dot(a, angle) / dot(a, a) * a;
      body.pose.orientation.advance(angle);
      for (std::size_t k = 0; k < body.members.size(); ++k)
        record.start.arms[static_cast<std::size_t>(body.members[k])] =
            body.pose.orientation.turn(body.frame[k]);
    }
    bodies.measure(odpd::Clock{}, scene.particles(), record);
  }
  const auto results = records::results(bodies);
  EXPECT_NEAR(records::mean(results, "b.simplex.rotational_diffusion"), diffusion,
              0.10 * diffusion);
  EXPECT_NEAR(records::mean(results, "b.rod.rotational_diffusion"), diffusion, 0.15 * diffusion);
}

}  // namespace
