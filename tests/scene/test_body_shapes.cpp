// Sites of named shapes: even over the surface, with the moments of inertia of a shell; their keys.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <initializer_list>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "cases.h"
#include "odpd/scene/body_shapes.h"
#include "support/errors.h"

namespace {

using cases::body_in;
using cases::first_body;
using odpd::LongShape;
using odpd::Vec;
using std::numbers::pi;

// Meridians by an angle from 0 to pi, independent of the closed forms under test: of half axes (a, b), and with straight sides.
struct Meridian {
  LongShape shape;
  double x(double t) const {
    const double a = shape.half_length, b = shape.half_width;
    if (shape.kind == LongShape::Kind::spheroid) return -a * std::cos(t);
    return -b * std::cos(t) + (t < 0.5 * pi ? b - a : a - b);
  }
  double s(double t) const { return shape.half_width * std::sin(t); }
  // Integral of f(x, s) over the part of the surface between two x.
  double integral(const std::function<double(double, double)>& f, double from, double to) const {
    constexpr int n = 40000;
    double sum = 0.0;
    for (int k = 0; k < n; ++k) {
      const double t = pi * k / n, u = pi * (k + 1) / n, middle = 0.5 * (t + u);
      // Of an even number of parts, the straight side is the one piece in the middle, at t = pi/2.
      const double dx = x(u) - x(t), ds = s(u) - s(t);
      const double at = 0.5 * (x(t) + x(u));
      if (std::abs(dx) > 0.1 * shape.half_length) {
        // Cut into parts of its own.
        for (int j = 0; j < 1000; ++j) {
          const double here = x(t) + dx * (j + 0.5) / 1000.0;
          if (here >= from && here < to)
            sum += 2.0 * pi * s(middle) * std::abs(dx) / 1000.0 * f(here, s(middle));
        }
      } else if (at >= from && at < to) {
        sum += 2.0 * pi * s(middle) * std::hypot(dx, ds) * f(at, s(middle));
      }
    }
    return sum;
  }
};

const std::vector<LongShape> long_shapes{
    {LongShape::Kind::spheroid, 2.0, 1.0},       {LongShape::Kind::spheroid, 4.0, 0.8},
    {LongShape::Kind::spheroid, 0.6, 2.0},       {LongShape::Kind::spheroid, 1.5, 1.5},
    {LongShape::Kind::spherocylinder, 3.0, 0.5}, {LongShape::Kind::spherocylinder, 1.2, 1.0}};

constexpr double infinite = std::numeric_limits<double>::infinity();

// Shares of the sites in ten slices of equal length along the axis, within two sites, and of four sectors about it within 2 %.
TEST(BodyShapes, SitesAreEvenOverTheSurface) {
  for (const LongShape& shape : long_shapes) {
    const Meridian meridian{shape};
    const auto one = [](double, double) { return 1.0; };
    const double area = meridian.integral(one, -infinite, infinite);
    EXPECT_NEAR(odpd::surface_of<3>(shape) / area, 1.0, 1e-5);
    constexpr std::int64_t count = 1000;
    const auto sites = odpd::surface_sites<3>(shape, count);
    ASSERT_EQ(sites.size(), 1000U);
    for (int k = 0; k < 10; ++k) {
      const double from = shape.half_length * (0.2 * k - 1.0), to = from + 0.2 * shape.half_length;
      const auto inside = std::count_if(sites.begin(), sites.end(),
                                        [&](const Vec<3>& p) { return p[0] >= from && p[0] < to; });
      EXPECT_NEAR(static_cast<double>(inside), count * meridian.integral(one, from, to) / area, 2.0)
          << shape.half_length << " " << shape.half_width << " " << k;
    }
    for (const double side : {-1.0, 1.0})
      for (int c = 1; c < 3; ++c) {
        const auto half = std::count_if(sites.begin(), sites.end(),
                                        [&](const Vec<3>& p) { return side * p[c] > 0.0; });
        EXPECT_NEAR(static_cast<double>(half), 0.5 * count, 0.02 * count);
      }
  }
}

// All sites are on the surface, none (of bodies several spacings thick) nearer to another than .87 spacings, and no place of the surface is farther than .9 from the
// nearest (a square lattice: .71).
TEST(BodyShapes, SitesAreASpacingApart) {
  for (const LongShape& shape : long_shapes) {
    const auto sites = odpd::surface_sites<3>(shape, 600);
    const double spacing = std::sqrt(odpd::surface_of<3>(shape) / 600.0);
    const double a = shape.half_length, b = shape.half_width;
    double nearest = infinite;
    for (std::size_t i = 0; i < sites.size(); ++i) {
      const Vec<3>& p = sites[i];
      const double s = std::hypot(p[1], p[2]);
      const bool round = shape.kind == LongShape::Kind::spheroid;
      const double beyond = std::max(std::abs(p[0]) - (a - b), 0.0);
      EXPECT_NEAR(round ? std::hypot(p[0] / a, s / b) : std::hypot(beyond, s) / b, 1.0, 1e-9);
      for (std::size_t j = 0; j < i; ++j) nearest = std::min(nearest, norm(p - sites[j]));
    }
    EXPECT_GT(nearest, 0.865 * spacing) << a << " " << b;
    EXPECT_LT(nearest, 1.0 * spacing);
    double hole = 0.0;
    for (const Vec<3>& p : odpd::surface_sites<3>(shape, 3989)) {
      double away = infinite;
      for (const Vec<3>& q : sites) away = std::min(away, norm(p - q));
      hole = std::max(hole, away);
    }
    EXPECT_LT(hole, 0.9 * spacing) << a << " " << b;
  }
}

// Per site, of a shell: <s^2> about the axis, <x^2 + s^2/2> across. Of a spherocylinder (straight part l) in closed form:
//   A <s^2> = 2 pi R l R^2 + 4 pi R^2 (2/3) R^2
//   A <x^2 + s^2/2> = 2 pi R l (R^2/2 + l^2/12) + 4 pi R^2 (2 R^2/3 + R l/2 + l^2/4)
TEST(BodyShapes, MomentsOfInertiaAreThoseOfAShell) {
  for (const LongShape& shape : long_shapes) {
    const Meridian meridian{shape};
    const auto mean = [&](const std::function<double(double, double)>& f) {
      return meridian.integral(f, -infinite, infinite) / odpd::surface_of<3>(shape);
    };
    double about = mean([](double, double s) { return s * s; });
    double across = mean([](double x, double s) { return x * x + 0.5 * s * s; });
    const double R = shape.half_width, l = 2.0 * (shape.half_length - R);
    if (shape.kind == LongShape::Kind::spherocylinder) {
      const double cylinder = 2.0 * pi * R * l, ball = 4.0 * pi * R * R;
      const double exact_about = (cylinder + ball * 2.0 / 3.0) * R * R / (cylinder + ball);
      const double exact_across = (cylinder * (R * R / 2.0 + l * l / 12.0) +
                                   ball * (2.0 * R * R / 3.0 + R * l / 2.0 + l * l / 4.0)) /
                                  (cylinder + ball);
      EXPECT_NEAR(about / exact_about, 1.0, 1e-4);
      EXPECT_NEAR(across / exact_across, 1.0, 1e-4);
      about = exact_about;
      across = exact_across;
    }
    constexpr std::int64_t count = 400;
    const auto moments = odpd::moment_of_inertia<3>(odpd::surface_sites<3>(shape, count));
    EXPECT_NEAR(moments[0][0] / (count * about), 1.0, 0.01);
    EXPECT_NEAR(moments[1][1] / (count * across), 1.0, 0.01);
    EXPECT_NEAR(moments[2][2] / (count * across), 1.0, 0.01);
    for (const auto& [c, d] : {std::pair{0, 1}, std::pair{0, 2}, std::pair{1, 2}})
      EXPECT_NEAR(moments[odpd::index(c)][d] / (count * across), 0.0, 0.01);
  }
}

// Ramanujan (1914) for the circumference of an ellipse, here good to 1e-7.
TEST(BodyShapes, OutlinesInTwoDimensionsAreEven) {
  const double a = 2.0, b = 1.0, h = (a - b) * (a - b) / ((a + b) * (a + b));
  const double ellipse = pi * (a + b) * (1.0 + 3.0 * h / (10.0 + std::sqrt(4.0 - 3.0 * h)));
  EXPECT_NEAR(odpd::surface_of<2>({LongShape::Kind::spheroid, a, b}), ellipse, 1e-5);
  EXPECT_NEAR(odpd::surface_of<2>({LongShape::Kind::spherocylinder, a, b}), 2.0 * pi + 4.0, 1e-5);
  for (const auto kind : {LongShape::Kind::spheroid, LongShape::Kind::spherocylinder}) {
    const LongShape shape{kind, a, b};
    const auto sites = odpd::surface_sites<2>(shape, 60);
    const double step = odpd::surface_of<2>(shape) / 60.0;
    for (std::size_t k = 0; k < 60; ++k) {
      const double apart = norm(sites[k] - sites[(k + 1) % 60]);
      EXPECT_LE(apart, step * (1.0 + 1e-9));
      EXPECT_GE(apart, 0.99 * step);  // chords of arcs
    }
  }
}

TEST(BodyShapes, VolumesInside) {
  EXPECT_NEAR(odpd::volume_of<3>({LongShape::Kind::spheroid, 2.0, 0.5}), 4.0 / 3.0 * pi * 0.5,
              1e-12);
  EXPECT_NEAR(odpd::volume_of<3>({LongShape::Kind::spherocylinder, 2.0, 0.5}),
              pi / 6.0 + pi * 0.25 * 3.0, 1e-12);
  EXPECT_NEAR(odpd::volume_of<2>({LongShape::Kind::spheroid, 2.0, 0.5}), pi, 1e-12);
  EXPECT_NEAR(odpd::volume_of<2>({LongShape::Kind::spherocylinder, 2.0, 0.5}), pi / 4.0 + 3.0,
              1e-12);
}

// --- keys ---

TEST(BodyShapes, SpacingSaysHowManySites) {
  const auto sites = [](const std::string& keys) {
    return first_body(cases::settings<3>(body_in(20.0, keys))).shape.size();
  };
  EXPECT_EQ(sites("shape = \"sphere\"\nradius = 2.0\nspacing = 0.5\n"), 201U);  // 16 pi/.25
  EXPECT_EQ(sites("shape = \"rod\"\nlength = 4.0\nspacing = 0.5\n"), 9U);
  EXPECT_EQ(sites("shape = \"rod\"\nlength = 4.0\nradius = 0.5\nspacing = 0.5\n"),
            50U);  // 4 pi/.25
  // Of an ellipsoid of half axes 2, 1, 1: 2 pi (1 + 2/e asin e), e^2 = 3/4.
  const double area = 2.0 * pi * (1.0 + 2.0 / std::sqrt(0.75) * std::asin(std::sqrt(0.75)));
  EXPECT_EQ(sites("shape = \"ellipsoid\"\nradius = 1.0\naspect = 2.0\nspacing = 0.5\n"),
            static_cast<std::size_t>(std::lround(area / 0.25)));
}

// With layers enough a body has as many sites as a fluid of spacing^-3 has particles in its volume and half a spacing around it,
// and no hole inside as large as a spacing. Of every kind, also where a last layer is a line, a sheet or a point.
TEST(BodyShapes, LayersFillThem) {
  struct Example {
    std::string keys;
    LongShape outer;  // half a spacing larger
  };
  const std::vector<Example> examples{
      {"shape = \"sphere\"\nradius = 4.5\n", {LongShape::Kind::spheroid, 5.0, 5.0}},
      {"shape = \"sphere\"\nradius = 4.0\n", {LongShape::Kind::spheroid, 4.5, 4.5}},
      {"shape = \"ellipsoid\"\nradius = 3.1\naspect = 2.0\n",
       {LongShape::Kind::spheroid, 6.7, 3.6}},
      {"shape = \"ellipsoid\"\nradius = 6.0\naspect = 0.5\n",
       {LongShape::Kind::spheroid, 3.5, 6.5}},
      {"shape = \"rod\"\nradius = 2.0\nlength = 12.0\n",
       {LongShape::Kind::spherocylinder, 6.5, 2.5}}};
  for (const Example& example : examples) {
    const auto s = cases::settings<3>(body_in(40.0, example.keys + "spacing = 1.0\nlayers = 20\n"));
    const auto& sites = first_body(s).shape;
    EXPECT_NEAR(static_cast<double>(sites.size()) / odpd::volume_of<3>(example.outer), 1.0, 0.08)
        << example.keys;
    LongShape inner = example.outer;
    inner.half_length -= 0.5;
    inner.half_width -= 0.5;
    double hole = 0.0;
    for (double shrink = 0.0; shrink < 1.0; shrink += 0.1)
      for (Vec<3> p : odpd::surface_sites<3>(inner, 200)) {
        p *= shrink;
        double away = infinite;
        for (const Vec<3>& q : sites) away = std::min(away, norm(p - q));
        hole = std::max(hole, away);
      }
    EXPECT_LT(hole, 1.0) << example.keys;
  }
}

TEST(BodyShapes, BadKeysSayWhatWouldDo) {
  const auto refuse = [](const std::string& keys, std::initializer_list<const char*> words) {
    support::expect_error<odpd::ConfigError>([&] { cases::settings<3>(body_in(10.0, keys)); },
                                             words);
  };
  const std::string ellipsoid = "shape = \"ellipsoid\"\nspacing = 0.5\n";
  refuse(ellipsoid + "radius = 0.2\naspect = 2.0\n",
         {"case.toml:", "body.0.spacing", "ellipsoid is 0.4 across", "spacing of 0.4 or less"});
  refuse(ellipsoid + "radius = 1.0\naspect = 0.2\n", {"ellipsoid is 0.4 across"});
  refuse(ellipsoid + "radius = 1.0\n", {"body.0.aspect", "missing"});
  refuse("shape = \"rod\"\nlength = 3.0\nradius = 0.2\nspacing = 0.5\n",
         {"rod is 0.4 across", "leave radius out"});
  refuse("shape = \"rod\"\nlength = 1.5\nradius = 1.0\nspacing = 0.5\n",
         {"body.0.length", "2 radius = 2"});
  refuse("shape = \"rod\"\nlength = 3.0\nspacing = 1e-8\n", {"body.0.spacing", "larger one"});
  refuse("shape = \"sphere\"\nradius = 1.0\nspacing = 0.5\npoints_on_sphere = 20\n",
         {"body.0.points_on_sphere", "never both"});
  // Half of the box.
  refuse("shape = \"sphere\"\nradius = 2.6\nspacing = 0.2\n",
         {"body.0.shape", "the body is 5.20", "longer than 10.4", "less than 5 across"});
  refuse("shape = \"rod\"\nlength = 6.0\nspacing = 0.5\n", {"6 across", "longer than 12"});
  refuse("shape = \"sphere\"\nradius = [1.0, 2.6]\n", {"largest body is 5.", "across"});
  // Radii.
  refuse("shape = \"sphere\"\nradius = [1.0, -0.5]\n", {"body.0.radius", "positive", "-0.5"});
  refuse("shape = \"sphere\"\nradius = []\n", {"body.0.radius", "empty"});
  refuse("shape = \"sphere\"\nradius = [0.5, 0.6]\ncount = 3\n",
         {"body.0.radius", "2 radii for 3 bodies"});
  const auto spread = [](const std::string& keys) {
    return "shape = \"sphere\"\nradius = { " + keys + " }\ncount = 5\n";
  };
  refuse(spread("mean = -1.0, deviation = 0.1"), {"body.0.radius.mean", "positive"});
  refuse(spread("mean = 1.0, deviation = -0.1"), {"body.0.radius.deviation", "negative"});
  refuse(spread("mean = 1.0, deviation = 0.3"),
         {"body.0.radius.deviation", "could be negative", "at most 0.2", "lognormal"});
  refuse(spread("mean = 1.0, deviation = 0.1, distribution = \"gamma\""), {"normal, lognormal"});
  // Fractions.
  const std::string spheres = "shape = \"sphere\"\nradius = 1.0\n";
  refuse(spheres + "fraction = 1.2\n", {"body.0.fraction", "1.2 cannot be reached"});
  refuse(spheres + "fraction = 0.001\n", {"body.0.fraction", "single body is 0.004189"});
  refuse(spheres + "fraction = 0.1\ncount = 3\n", {"body.0.fraction", "never both"});
  refuse("shape = \"rod\"\nlength = 3.0\nspacing = 0.5\nfraction = 0.1\n", {"no volume"});
  support::expect_error<odpd::ConfigError>(
      [&] {
        odpd::Scene<3>(
            cases::settings<3>(body_in(10.0, spheres + "fraction = 0.7\nclearance = 0.0\n")));
      },
      {"[[body]] 'b'", "was reached", "fraction"});
}

}  // namespace
