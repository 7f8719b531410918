// Bodies on a line in 3D: which shapes are taken, how they point and move at the start.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <string>

#include "cases.h"
#include "odpd/scene/bodies.h"
#include "odpd/scene/fill.h"
#include "support/errors.h"
#include "support/simplex.h"

namespace {

using odpd::ConfigError;
using odpd::Vec;

// A periodic box with a body of these points.
std::string with_points(const std::string& points, const std::string& more = "") {
  return cases::periodic + ("[[body]]\nshape = \"points\"\npoints = [" + points + "]\n") +
         "positions = [{at=[1.0, 1.0, 1.0]}]\n" + more;
}

TEST(Rods, AreTakenInThreeDimensions) {
  const std::string line = "{at=[0.1, 0.0, 0.3]}, {at=[0.3, 0.1, 0.5]}, {at=[0.7, 0.3, 0.9]}";
  for (const std::string motion : {"", "motion = \"given\"\n", "motion = \"fixed\"\n"})
    EXPECT_EQ(odpd::rotations<3>(cases::settings<3>(with_points(line, motion)).bodies.at(0).shape),
              2);
  EXPECT_NO_THROW(cases::settings<3>(with_points("{at=[0.0, 0.0, 0.0]}, {at=[0.3, 0.1, 0.5]}")));
  const std::string two = "[[body]]\nshape = \"sphere\"\nradius = 0.3\npoints_on_sphere = 2\n";
  EXPECT_EQ(odpd::rotations<3>(cases::settings<3>(cases::periodic + two).bodies.at(0).shape), 2);
}

TEST(Rods, OnePointDoesNotTurn) {
  const std::string point = "{at=[0.1, 0.1, 0.1]}", fixed = "motion = \"fixed\"\n";
  for (const std::string& points : {point, point + ", " + point + ", " + point}) {
    support::expect_error<ConfigError>([&] { cases::settings<3>(with_points(points)); },
                                       {"case.toml", "body.0.shape", "two points"});
    EXPECT_NO_THROW(cases::settings<3>(with_points(points, fixed)));
  }
}

// Rounded to a few digits a line is a body that whirls.
TEST(Rods, AlmostALineIsRefused) {
  const auto bent = [](const std::string& by) {
    return with_points("{at=[-0.5, 0.0, 0.0]}, {at=[0.0, " + by + ", 0.0]}, {at=[0.5, 0.0, 0.0]}");
  };
  for (const char* by : {"5e-4", "1e-5"})
    support::expect_error<ConfigError>([&] { cases::settings<3>(bent(by)); },
                                       {"body.0.shape", "almost on a line", "digits"});
  for (const char* by : {"0.0", "1e-7", "2e-3", "0.1"})
    EXPECT_NO_THROW(cases::settings<3>(bent(by))) << by;
}

// 2000 rods: <u_c^2> = 1/3 with a standard error of 0.0067, <u_c> = 0 with 0.013; kinetic energies of 3 kT/2 of the centre and
// 2 kT/2 of the rotation with relative standard errors of 1.8 % and 2.2 %.
TEST(Rods, StartAtRandomWithFiveFreedoms) {
  constexpr double mass = 2.0, kT = 0.5;
  odpd::BodySettings<3> rod;
  rod.shape = support::rod_body<3>().frame;
  rod.count = 2000;
  rod.clearance = 0.0;
  const odpd::Box<3> box{{{60.0, 60.0, 60.0}}, {true, true, true}};
  odpd::Particles<3> particles;
  odpd::place_bodies<3>({rod}, box, {}, box.size, 7, true, particles);
  odpd::draw_velocities<3>(8, kT, mass, false, {}, particles);
  Vec<3> mean{}, square{};
  double linear = 0.0, angular = 0.0, all = 0.0, inertia = 0.0;
  for (const double s : support::rod_places) inertia += mass * s * s;
  for (const auto& body : particles.bodies) {
    Vec<3> u = body.pose.orientation.turn(body.frame.back());
    u *= 1.0 / norm(u);
    Vec<3> p{}, l{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec<3>& v = particles.end_velocity[static_cast<std::size_t>(body.members[k])];
      p += mass * v;
      l += mass * support::rod_places[k] * odpd::torque(u, v);
      all += mass * dot(v, v);
    }
    linear += dot(p, p) / (3.0 * mass);
    angular += dot(l, l) / inertia;
    for (int c = 0; c < 3; ++c) {
      mean[c] += u[c] / 2000.0;
      square[c] += u[c] * u[c] / 2000.0;
    }
  }
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(mean[c], 0.0, 0.06);
    EXPECT_NEAR(square[c], 1.0 / 3.0, 0.03);
  }
  EXPECT_NEAR(linear / 2000.0, 3.0 * kT, 0.09 * 3.0 * kT);
  EXPECT_NEAR(angular / 2000.0, 2.0 * kT, 0.11 * 2.0 * kT);
  EXPECT_NEAR(all, linear + angular, 1e-12 * all);  // rigid
}

// --- `along`, at positions ---

// A rod, an ellipsoid and a line of points stand along what is asked for, in their poses: their frames stay along x.
TEST(Rods, PointAlong) {
  const Vec<3> along{{1.0, -2.0, 2.0}};
  const std::string places =
      "positions = [{ at = [3.0, 3.0, 3.0] }, { at = [9.0, 9.0, 9.0], along = [1.0, -2.0, 2.0] "
      "}]\n";
  for (const std::string shape :
       {"shape = \"rod\"\nlength = 4.0\nspacing = 0.5\n",
        "shape = \"rod\"\nlength = 4.0\nradius = 0.5\nspacing = 0.5\n",
        "shape = \"ellipsoid\"\nradius = 1.0\naspect = 2.0\nspacing = 0.5\n",
        "shape = \"points\"\npoints = [{ at = [0.0, 0.0, 0.0] }, { at = [0.0, 0.0, 2.0] }]\n"}) {
    const auto s = cases::settings<3>(cases::body_in(12.0, shape + places));
    const odpd::Scene<3> scene(s);
    const auto& bodies = scene.particles().bodies;
    ASSERT_EQ(bodies.size(), 2U);
    const bool points = shape.find("points") != std::string::npos;
    for (std::size_t b = 0; b < 2; ++b) {
      const Vec<3> axis = b == 0 ? (points ? Vec<3>{{0.0, 0.0, 1.0}} : Vec<3>{{1.0, 0.0, 0.0}})
                                 : (1.0 / 3.0) * along;
      EXPECT_EQ(bodies[b].frame, s.bodies[0].shape);
      // Extents along the axis and across, of its particles in the box.
      double out = 0.0, beside = 0.0, frame_out = 0.0, frame_beside = 0.0, sum = 0.0;
      for (std::size_t k = 0; k < bodies[b].members.size(); ++k) {
        const auto id = odpd::index(bodies[b].members[k]);
        const Vec<3> arm = s.box.separation(scene.particles().position[id], bodies[b].pose.centre);
        out = std::max(out, dot(arm, axis));
        beside = std::max(beside, norm(odpd::torque(arm, axis)));
        const Vec<3>& p = bodies[b].frame[k];
        const double x = points ? p[2] : p[0];
        frame_out = std::max(frame_out, x);
        frame_beside = std::max(frame_beside, std::sqrt(std::max(0.0, dot(p, p) - x * x)));
        sum += x * dot(arm, axis);
      }
      EXPECT_NEAR(out, frame_out, 1e-9) << shape;
      EXPECT_NEAR(beside, frame_beside, 1e-6) << shape;
      EXPECT_GT(sum, 0.0);  // and not the other way round
    }
  }
}

// Two long rods side by side, and end to end: whether they are in each other goes by how they point.
TEST(Rods, PlacesGoByWhereTheyPoint) {
  const auto rods = [](const std::string& second) {
    return cases::body_in(14.0,
                          "shape = \"rod\"\nlength = 4.0\nradius = 0.5\nspacing = 0.5\npositions = "
                          "[{ at = [3.0, 3.0, 3.0], along = [0.0, 1.0, 0.0] }, " +
                              second + "]\n");
  };
  EXPECT_NO_THROW(cases::settings<3>(rods("{ at = [4.6, 3.0, 3.0], along = [0.0, 1.0, 0.0] }")));
  for (const char* second :
       {"{ at = [4.6, 3.0, 3.0] }", "{ at = [4.6, 3.0, 3.0], along = [1.0, 0.0, 0.0] }"})
    support::expect_error<ConfigError>([&] { cases::settings<3>(rods(second)); },
                                       {"lie in each other", "body 2"});
  // In a channel: across the wall, not along it.
  const auto channel = [](const std::string& along) {
    return cases::channel +
           ("[[body]]\nshape = \"rod\"\nlength = 2.0\nspacing = 0.3\npositions = [{ "
            "at = [3.0, 1.5], along = " +
            along + " }]\n");
  };
  EXPECT_NO_THROW(cases::settings<2>(channel("[-1.0, 0.0]")));
  support::expect_error<ConfigError>([&] { cases::settings<2>(channel("[0.0, 2.0]")); },
                                     {"in the wall at y-", "0.5 behind", "y = 2 or more"});
}

TEST(Rods, WhatHasNoAxisPointsNowhere) {
  const auto refuse = [](const std::string& shape, const std::string& along,
                         std::initializer_list<const char*> words) {
    support::expect_error<ConfigError>(
        [&] {
          cases::settings<3>(cases::body_in(
              12.0, shape + "positions = [{ at = [3.0, 3.0, 3.0], along = " + along + " }]\n"));
        },
        words);
  };
  const std::string rod = "shape = \"rod\"\nlength = 4.0\nspacing = 0.5\n", x = "[1.0, 0.0, 0.0]";
  refuse(rod, "[0.0, 0.0, 0.0]", {"case.toml:", "body.0.positions.0.along", "zero vector"});
  refuse(rod, "[1.0, 0.0]", {"body.0.positions.0.along", "3 components"});
  for (const std::string shape :
       {"shape = \"sphere\"\nradius = 1.0\n", "shape = \"cube\"\nside = 1.0\n",
        "shape = \"points\"\npoints = [{ at = [0.0, 0.0, 0.0] }, { at = [0.0, 0.0, 2.0] }, { at = "
        "[0.0, 1.0, 0.0] }]\n"})
    refuse(shape, x, {"body.0.positions.0.along", "no axis", "leave `along` out"});
}

}  // namespace
