// The observer of bodies: rotational diffusion about the axes that a body turns about.
#include <gtest/gtest.h>

#include <cmath>

#include "odpd/analysis/bodies.h"
#include "records.h"
#include "support/simplex.h"

namespace {

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
  odpd::BodiesSettings settings{.msd = {.window = 0.5, .fit_from = 0.1, .directions = {0, 1, 2}}};
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
