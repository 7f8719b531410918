// Bodies of one entry whose radii differ, their seeds and their room; where fluid starts around long bodies.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "cases.h"
#include "odpd/scene/body_room.h"
#include "odpd/scene/body_shape_keys.h"

namespace {

using cases::body_in;
using cases::first_body;
using odpd::Vec;
using std::numbers::pi;

std::vector<double> radii_of(const odpd::BodySettings<3>& body) {
  std::vector<double> radii;
  for (std::size_t k = 0; k < odpd::index(body.bodies()); ++k) radii.push_back(body.radius(k));
  return radii;
}
struct Spread {
  double mean = 0.0, deviation = 0.0, skewness = 0.0;
};
Spread spread_of(const std::vector<double>& values) {
  const double share = 1.0 / static_cast<double>(values.size());
  double mean = 0.0, square = 0.0, cube = 0.0;
  for (const double v : values) mean += share * v;
  for (const double v : values) {
    square += share * (v - mean) * (v - mean);
    cube += share * std::pow(v - mean, 3);
  }
  return {mean, std::sqrt(square), cube / std::pow(square, 1.5)};
}

// Of 3000 radii 1 +- .15 standard errors are .0027 of the mean, .0019 of the deviation, .045 (normal) to .08 (lognormal, at .45 =
// 3 v + v^3, v = .15) of the skewness.
TEST(BodyRadii, HaveMeanAndDeviationOfTheDistribution) {
  for (const bool lognormal : {false, true}) {
    const std::string keys =
        "shape = \"sphere\"\npoints_on_sphere = 12\ncount = 3000\nradius = { mean = 1.0, "
        "deviation = 0.15" +
        std::string(lognormal ? ", distribution = \"lognormal\"" : "") + " }\n";
    const auto s = cases::settings<3>(body_in(100.0, keys));
    const std::vector<double> radii = radii_of(first_body(s));
    // Twelve sites are not quite centred: their outermost one is a little farther out than the radius, in all alike.
    const double out =
        first_body(cases::settings<3>(body_in(100.0, "shape = \"sphere\"\nradius = 1.0\n")))
            .radius();
    const Spread spread = spread_of(radii);
    EXPECT_NEAR(spread.mean / out, 1.0, 0.011);
    EXPECT_NEAR(spread.deviation / out, 0.15, 0.008);
    EXPECT_NEAR(spread.skewness, lognormal ? 0.453 : 0.0, lognormal ? 0.32 : 0.2);
  }
}

TEST(BodyRadii, FollowFromTheSeedAndTheEntry) {
  const std::string keys =
      "shape = \"sphere\"\nspacing = 0.4\nradius = { mean = 1.0, deviation = 0.1 }\ncount = ";
  const auto radii = [&](int count, const std::vector<std::string>& set = {}) {
    return radii_of(
        first_body(cases::settings<3>(body_in(100.0, keys + std::to_string(count) + "\n"), set)));
  };
  const std::vector<double> five = radii(5), seven = radii(7), other = radii(5, {"seed=6"});
  EXPECT_TRUE(std::equal(five.begin(), five.end(), seven.begin()));
  for (std::size_t k = 0; k < 5; ++k) EXPECT_GT(std::abs(five[k] - other[k]), 1e-4);
  const auto two =
      cases::settings<3>(body_in(100.0, keys + "5\n[[body]]\nname = \"c\"\n" + keys + "5\n"));
  EXPECT_EQ(radii_of(two.bodies[0]), five);
  for (std::size_t k = 0; k < 5; ++k)
    EXPECT_GT(std::abs(five[k] - radii_of(two.bodies[1])[k]), 1e-4);
}

// Body 2751676 of seed 1 is the first whose number is more than five deviations, the whole mean, below.
TEST(BodyRadii, ArePositiveFarOutInTheTailToo) {
  constexpr std::uint64_t seed = 1, rare = 2751676;
  ASSERT_LT(odpd::CounterRandom(seed, odpd::Stream::body_sizes).normal(0, 0, 0, rare), -5.0);
  const auto config =
      odpd::Config::from_text("radius = { mean = 1.0, deviation = 0.2 }\n", "body.toml");
  odpd::ShapeKeys keys;
  keys.has_radius = true;
  const odpd::Radii radii(config, keys, seed, 0);
  EXPECT_GT(radii.of(rare), 0.0);
  EXPECT_NE(radii.of(rare), radii.of(rare + 1));
}

// Each has the sites that its own surface takes, and each stands where and as large as the list says.
TEST(BodyRadii, AListIsOfTheBodiesInTurn) {
  const auto s =
      cases::settings<3>(body_in(12.0,
                                 "shape = \"sphere\"\nspacing = 0.4\nradius = [0.6, 1.2, "
                                 "0.8]\npositions = [{ at = [2.0, 2.0, 2.0] }, "
                                 "{ at = [8.0, 2.0, 2.0] }, { at = [2.0, 8.0, 8.0] }]\n"));
  const odpd::Scene<3> scene(s);
  const auto& bodies = scene.particles().bodies;
  ASSERT_EQ(bodies.size(), 3U);
  const std::array<double, 3> radius{0.6, 1.2, 0.8};
  std::int64_t sites = 0;
  for (std::size_t b = 0; b < 3; ++b) {
    EXPECT_EQ(bodies[b].pose.centre, s.bodies[0].positions[b]);
    const auto expected = std::lround(4.0 * pi * radius[b] * radius[b] / 0.16);
    EXPECT_EQ(bodies[b].frame.size(), static_cast<std::size_t>(expected));
    for (const Vec<3>& p : bodies[b].frame) EXPECT_NEAR(norm(p), radius[b], 0.03);
    sites += expected;
  }
  EXPECT_EQ(s.body_particles(), sites);
  EXPECT_EQ(scene.particles().size(), sites + 3 * 12 * 12 * 12);
}

// In a fluid whose particles fill space bodies take as much room as they have sites, each its own number.
TEST(BodyRadii, TakeTheirRoomFromAFluidThatFillsSpace) {
  const std::string fluid =
      "model = \"sdpd\"\ndensity = 1.0\neta = 1.0\nbulk_modulus = 50.0\nkT = 0.1\n";
  const std::string box =
      "[box]\nsize = [30.0, 30.0, 30.0]\nperiodic = [true, true, true]\n[fluid]\n";
  const auto s = cases::settings<3>(
      box + fluid +
      "[[body]]\nshape = \"sphere\"\nspacing = 0.9\nlayers = 2\nradius = { mean = 2.0, "
      "deviation = 0.3 }\ncount = 10\n");
  std::int64_t sites = 0;
  for (const auto& shape : first_body(s).shapes) sites += static_cast<std::int64_t>(shape.size());
  EXPECT_GT(sites, 400);
  EXPECT_NE(sites, 10 * static_cast<std::int64_t>(first_body(s).shape.size()));
  EXPECT_EQ(s.count, 27000 - sites);
}

TEST(BodyRadii, AFractionIsReached) {
  const auto fraction = [](const std::string& radius) {
    const auto s = cases::settings<3>(body_in(
        40.0, "shape = \"sphere\"\nspacing = 0.5\nradius = " + radius + "\nfraction = 0.1\n"));
    double volume = 0.0;
    for (const double r : radii_of(first_body(s))) volume += 4.0 / 3.0 * pi * r * r * r;
    return volume / 64000.0;
  };
  // Within half a body and what the sites' radius is off, a hundredth.
  EXPECT_NEAR(fraction("1.5"), 0.1, 0.003);
  EXPECT_NEAR(fraction("{ mean = 1.5, deviation = 0.3 }"), 0.1, 0.003);
}

// --- where fluid starts ---

// Particles at random (not moved apart) around a fixed body along x, in the ball around it: density 20 wherever the body is not.
TEST(BodyRoom, FluidStartsBesideLongBodies) {
  struct Example {
    std::string keys;
    double volume;  // of the body
  };
  const std::vector<Example> examples{
      {"shape = \"ellipsoid\"\nradius = 1.0\naspect = 3.0\nspacing = 0.25\n", 4.0 * pi},
      {"shape = \"rod\"\nlength = 6.0\nspacing = 0.25\n", 0.0},
      {"shape = \"rod\"\nlength = 6.0\nradius = 0.8\nspacing = 0.25\n",
       pi * 0.64 * 4.4 + 4.0 / 3.0 * pi * 0.512}};
  for (const Example& example : examples) {
    const odpd::Scene<3> scene(cases::settings<3>(
        body_in(13.0, example.keys + "motion = \"fixed\"\npositions = [{ at = [6.5, 6.5, 6.5] }]\n",
                "count = 41680\n"),
        {"start.relax_sweeps=0"}));
    const auto& particles = scene.particles();
    const odpd::BodyRoom<3> room(scene.box(), particles);
    const double outer = 13.0 * 13.0 * 13.0 - 36.0 * pi, ball = 36.0 * pi - example.volume;
    double in_ball = 0.0, in_body = 0.0;
    for (std::size_t i = 0; i < particles.position.size(); ++i) {
      if (!particles.is_free(i)) continue;
      const Vec<3> arm = particles.position[i] - Vec<3>{{6.5, 6.5, 6.5}};
      in_ball += norm(arm) < 3.0 ? 1.0 : 0.0;
      in_body += room.holds(particles.position[i]) ? 1.0 : 0.0;
      if (example.keys.find("ellipsoid") != std::string::npos) {
        // Planes touch sites, so between these they cut off up to 4 % of the radius.
        EXPECT_GT(std::hypot(arm[0] / 3.0, arm[1], arm[2]), 0.95);
      }
    }
    EXPECT_EQ(in_body, 0.0);
    // Some 2000 particles, standard deviation 45, and a body whose outline is planes.
    const double expected = 41680.0 * ball / (ball + outer);
    EXPECT_NEAR(in_ball / expected, 1.0, 0.1) << example.keys;
  }
}

// Round ones keep all of their ball to themselves.
TEST(BodyRoom, OfARoundBodyIsItsBall) {
  const odpd::Scene<3> scene(
      cases::settings<3>(body_in(8.0,
                                 "shape = \"sphere\"\nradius = 1.5\nspacing = 0.6\npositions = [{ "
                                 "at = [4.0, 4.0, 4.0] }]\n")));
  const odpd::BodyRoom<3> room(scene.box(), scene.particles());
  const double radius = first_body(scene.settings()).radius();
  for (const double x : {0.0, 0.5, 0.99}) EXPECT_TRUE(room.holds({{4.0, 4.0 + x * radius, 4.0}}));
  EXPECT_FALSE(room.holds({{4.0, 4.0 + 1.01 * radius, 4.0}}));
}

}  // namespace
