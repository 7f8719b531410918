// Bodies on a line in 3D: which shapes are taken, how they point and move at the start.
#include <gtest/gtest.h>

#include <array>
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

}  // namespace
