// Bodies in each other, in a wall, outside the box are refused; touching, bumps on walls and rings around others are not.
#include <gtest/gtest.h>

#include <initializer_list>
#include <string>

#include "cases.h"
#include "odpd/scene/body_places.h"
#include "odpd/scene/scene.h"
#include "support/errors.h"

namespace {

using cases::settings;
using odpd::ConfigError;
using odpd::Vec;

// A periodic channel of 10 x 12, its surfaces at y = 1 and 11, with bodies.
std::string with_bodies(const std::string& bodies) { return cases::channel + bodies; }

std::string disks(const std::string& places, const std::string& more = "") {
  return with_bodies("[[body]]\nname = \"disk\"\nshape = \"disk\"\nradius = 0.5\n" + more +
                     "positions = [" + places + "]\n");
}

void refuse(const std::string& text, std::initializer_list<const char*> words) {
  support::expect_error<ConfigError>([&] { settings<2>(text); }, words);
}
void accept(const std::string& text) { EXPECT_NO_THROW(settings<2>(text)) << text; }

TEST(BodyPlaces, TwoMayTouchButNotLieInEachOther) {
  const auto second_at = [](double x) {
    return disks("{at=[3.0, 3.0]}, {at=[" + std::to_string(x) + ", 3.0]}");
  };
  refuse(second_at(3.0), {"case.toml:", "positions", "body 1 of [[body]] 'disk' at (3, 3)",
                          "body 2 of [[body]] 'disk' at (3, 3)", "further apart"});
  // Neighbours in a disk of two rings are 0.26 apart: up to there their outermost particles may be in each other.
  for (const double x : {3.01, 3.14, 3.25, 3.5, 3.7}) refuse(second_at(x), {"lie in each other"});
  for (const double x : {3.8, 4.0, 4.3, 7.0}) accept(second_at(x));
  // Through the periodic edge; across none.
  refuse(disks("{at=[0.1, 3.0]}, {at=[9.9, 3.0]}"), {"lie in each other"});
}

TEST(BodyPlaces, TheFirstOfSeveralIsNamed) {
  // The last lies in the second and the third.
  refuse(disks("{at=[8.0, 3.0]}, {at=[3.4, 3.0]}, {at=[3.0, 3.0]}"), {"body 2", "body 3"});
  refuse(disks("{at=[8.0, 3.0]}, {at=[3.0, 3.0]}, {at=[4.0, 3.0]}, {at=[3.5, 3.0]}"),
         {"body 2 of [[body]] 'disk' at (3, 3) and body 4 of [[body]] 'disk' at (3.5, 3)"});
  refuse(disks("{at=[8.0, 3.0]}, {at=[4.0, 3.0]}, {at=[3.0, 3.0]}, {at=[3.5, 3.0]}"),
         {"body 2 of [[body]] 'disk' at (4, 3) and body 4 of [[body]] 'disk' at (3.5, 3)"});
}

TEST(BodyPlaces, TwoEntriesAndObstaclesToo) {
  const std::string square =
      "[[body]]\nname = \"post\"\nshape = \"square\"\nside = 1.0\nper_side = 4\nmotion = "
      "\"fixed\"\n"
      "positions = [{at=[3.2, 3.0]}]\n";
  refuse(disks("{at=[3.0, 3.0]}") + square,
         {"body 1 of [[body]] 'disk' at (3, 3)", "body 1 of [[body]] 'post' at (3.2, 3)"});
  accept(disks("{at=[4.3, 3.0]}") + square);
  // Single particles: the same place alone.
  const auto points = [](double x) {
    return with_bodies(
        "[[body]]\nshape = \"points\"\npoints = [{at=[0.0, 0.0]}]\nmotion = \"fixed\"\npositions = "
        "[{at=[3.0, 3.0]}, {at=[" +
        std::to_string(x) + ", 3.0]}]\n");
  };
  refuse(points(3.0), {"lie in each other"});
  accept(points(3.01));
}

TEST(BodyPlaces, ARingMayHoldAnotherBody) {
  const std::string ring =
      "[[body]]\nname = \"ring\"\nshape = \"ring\"\nradius = 2.0\npoints_on_ring = 60\n"
      "positions = [{at=[5.0, 6.0]}]\n";
  accept(disks("{at=[5.0, 6.0]}") + ring);
  accept(disks("{at=[6.0, 6.0]}") + ring);
  refuse(disks("{at=[6.8, 6.0]}") + ring, {"lie in each other"});
}

TEST(BodyPlaces, RodsLieSideBySide) {
  std::string points;
  for (int k = 0; k < 11; ++k)
    points += (k > 0 ? ", {at=[" : "{at=[") + std::to_string(0.2 * k) + ", 0.0]}";
  const auto rods = [&](double y) {
    return with_bodies("[[body]]\nshape = \"points\"\npoints = [" + points +
                       "]\npositions = [{at=[3.0, 3.0]}, {at=[3.0, " + std::to_string(y) + "]}]\n");
  };
  refuse(rods(3.1), {"lie in each other"});
  accept(rods(3.3));
}

TEST(BodyPlaces, AFreeBodyStartsInFrontOfAWall) {
  refuse(disks("{at=[3.0, 0.5]}"),
         {"case.toml:", "positions", "body 1 of [[body]] 'disk' at (3, 0.5)", "in the wall at y-",
          "1 behind its surface", "y = 1.5 or more"});
  refuse(disks("{at=[3.0, 1.4]}"), {"0.1 behind", "y = 1.5 or more"});
  refuse(disks("{at=[3.0, 10.7]}"), {"in the wall at y+", "0.2 behind", "y = 10.5 or less"});
  accept(disks("{at=[3.0, 1.5]}, {at=[3.0, 10.5]}"));
}

TEST(BodyPlaces, AnObstacleMayStandOutOfAWall) {
  const std::string fixed = "motion = \"fixed\"\n";
  accept(disks("{at=[3.0, 1.0]}, {at=[5.0, 11.3]}", fixed));
  accept(disks("{at=[3.0, 1.0]}", "motion = \"given\"\nvelocity = [1.0, 0.0]\n"));
  const auto small = [&](double y) {
    return with_bodies("[[body]]\nshape = \"disk\"\nradius = 0.3\n" + fixed +
                       "positions = [{at=[3.0, 3.0]}, {at=[5.0, " + std::to_string(y) + "]}]\n");
  };
  accept(small(11.3));
  refuse(small(11.6), {"body 2", "in the wall at y+", "0.3 behind"});
  refuse(disks("{at=[3.0, 0.3]}", fixed), {"outside the box", "y = -0.2"});
}

TEST(BodyPlaces, RandomOnesKeepClear) {
  const auto s = settings<2>(
      disks("{at=[3.0, 3.0]}, {at=[6.0, 3.0]}") +
      "[[body]]\nname = \"more\"\nshape = \"disk\"\nradius = 0.5\ncount = 12\nclearance = 0.0\n");
  odpd::Scene<2> scene(s);
  std::vector<std::size_t> kind;
  const auto& bodies = scene.particles().bodies;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    kind.push_back(scene.body_kind(b));
    for (std::size_t a = 0; a < b; ++a)
      EXPECT_GE(norm(s.box.separation(bodies[a].pose.centre, bodies[b].pose.centre)), 1.0);
  }
  EXPECT_NO_THROW(odpd::check_start_bodies(s, kind, scene.particles()));
}

TEST(BodyPlaces, OfAStartFileOnlyWhatNoRunLeaves) {
  auto s = settings<2>(disks("{at=[3.0, 3.0]}, {at=[6.0, 3.0]}"));
  s.start_file = "frame.h5";
  odpd::Scene<2> scene(s);
  const std::vector<std::size_t> kind{0, 0};
  auto& particles = scene.particles();
  const auto place_second = [&](double x, double y) { particles.bodies[1].pose.centre = {{x, y}}; };
  place_second(3.2, 3.0);  // pressed into each other
  EXPECT_NO_THROW(odpd::check_start_bodies(s, kind, particles));
  place_second(6.0, 0.9);  // and into the wall
  EXPECT_NO_THROW(odpd::check_start_bodies(s, kind, particles));
  place_second(3.0, 3.0);
  support::expect_error<ConfigError>([&] { odpd::check_start_bodies(s, kind, particles); },
                                     {"frame.h5", "body 1", "body 2", "at one place"});
  place_second(6.0, 0.3);
  support::expect_error<ConfigError>(
      [&] { odpd::check_start_bodies(s, kind, particles); },
      {"frame.h5", "body 2 of [[body]] 'disk' at (6, 0.3)", "in the wall at y-", "0.2 behind"});
}

}  // namespace
