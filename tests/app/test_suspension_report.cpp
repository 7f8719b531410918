// The three fractions of a suspension, its bulk density and its Peclet number, in text and JSON.
#include <gtest/gtest.h>

#include <numbers>

#include "odpd/app/suspension_report.h"
#include "odpd/core/config.h"
#include "odpd/core/error.h"

namespace {

using odpd::Results;
using odpd::Scene;

using std::numbers::pi;

// 300 particles of fluid, three balls of twelve sites each and one pair, in 6^3.
std::string balls(const std::string& ball, const std::string& pair, const std::string& more = "") {
  return "dimension = 3\n[box]\nsize = [6.0, 6.0, 6.0]\nperiodic = [true, true, true]\n"
         "[fluid]\ncount = 300\na = 25.0\ngamma = 4.5\nkT = 2.0\n[start]\nrelax_sweeps = 0\n" +
         more +
         "[[body]]\nname = \"ball\"\nshape = \"sphere\"\nradius = 0.5\ncount = 3\nclearance = "
         "0.1\n" +
         ball +
         "[[body]]\nname = \"pair\"\nshape = \"points\"\npoints = [{ at = [0.0, 0.0, 0.0] }, "
         "{ at = [0.2, 0.0, 0.0] }]\ncount = 1\nclearance = 0.1\n" +
         pair;
}

template <int D>
Scene<D> scene_of(const std::string& text) {
  return Scene<D>(odpd::read_scene_settings<D>(odpd::Config::from_text(text, "test")));
}

template <int D>
double eta_at(const Scene<D>& scene, double density) {
  return odpd::known_viscosity(scene, density).eta;
}

TEST(SuspensionReport, FractionsOfTwoKinds) {
  const auto scene = scene_of<3>(balls("hydrodynamic_radius = 0.7\nexcluded_volume = 2.0\n",
                                       "excluded_volume = 0.5\n",
                                       "[shear]\nflow = \"x\"\ngradient = \"y\"\nrate = -0.4\n"));
  const auto s = odpd::suspension_of(scene);
  ASSERT_TRUE(s);
  ASSERT_EQ(s->kinds.size(), 2U);
  EXPECT_EQ(s->kinds[0].bodies, 3);
  EXPECT_DOUBLE_EQ(s->kinds[0].number_fraction, 36.0 / 338.0);
  EXPECT_DOUBLE_EQ(*s->kinds[0].exclusion_fraction, 6.0 / 216.0);
  EXPECT_NEAR(*s->kinds[0].hydrodynamic_fraction, 4.0 * pi * 0.343 / 216.0, 1e-12);
  EXPECT_DOUBLE_EQ(s->kinds[1].number_fraction, 2.0 / 338.0);
  EXPECT_FALSE(s->kinds[1].hydrodynamic_fraction);
  EXPECT_FALSE(s->kinds[1].peclet_of_unit_eta);
  EXPECT_DOUBLE_EQ(s->together.number_fraction, 38.0 / 338.0);
  EXPECT_DOUBLE_EQ(*s->together.exclusion_fraction, 6.5 / 216.0);
  EXPECT_FALSE(s->together.hydrodynamic_fraction);  // one kind does not say
  EXPECT_NEAR(*s->bulk_density, 300.0 / 209.5, 1e-12);
  // 6 pi a^3 rate/kT, and eta at the bulk density.
  EXPECT_NEAR(*s->kinds[0].peclet_of_unit_eta, 6.0 * pi * 0.343 * 0.4 / 2.0, 1e-12);
  EXPECT_DOUBLE_EQ(s->fluid.eta, eta_at(scene, *s->bulk_density));
  EXPECT_GT(s->fluid.eta, 1.01 * eta_at(scene, 300.0 / 216.0));

  Results results;
  results.scalars.push_back({"viscosity", 3.0, 0.1});
  const std::string text = odpd::suspension_text(scene, results);
  for (const char* words :
       {"ball            3 bodies: number fraction = 0.10651",
        "exclusion fraction = 0.027778, hydrodynamic fraction = 0.019955",
        "together        4 bodies: number fraction = 0.11243", "density = 1.43198",
        "(kinetic theory)", "3.8792 with the suspension's"})
    EXPECT_NE(text.find(words), std::string::npos) << words << "\n" << text;
  const std::string json = odpd::suspension_json(scene, results)->text();
  for (const char* words :
       {"\"bulk_density\": 1.43", "\"peclet\": ", "\"eta_source\": \"kinetic theory\"",
        "\"peclet_of_measured_viscosity\": 3.879"})
    EXPECT_NE(json.find(words), std::string::npos) << words << "\n" << json;
}

TEST(SuspensionReport, LeavesOutWhatIsNotGiven) {
  EXPECT_FALSE(odpd::suspension_of(scene_of<3>(balls("", ""))));
  EXPECT_EQ(odpd::suspension_text(scene_of<3>(balls("", "")), Results{}), "");
  const auto scene = scene_of<3>(balls("excluded_volume = 2.0\n", ""));
  const auto s = odpd::suspension_of(scene);
  ASSERT_TRUE(s);
  EXPECT_FALSE(s->bulk_density);  // what the pair excludes is not known
  EXPECT_FALSE(s->together.exclusion_fraction);
  const std::string json = odpd::suspension_json(scene, Results{})->text();
  for (const char* words : {"peclet", "hydrodynamic", "bulk_density", "eta"})
    EXPECT_EQ(json.find(words), std::string::npos) << words << "\n" << json;
}

TEST(SuspensionReport, OfDisks) {
  const auto scene = scene_of<2>(
      "dimension = 2\n[box]\nsize = [10.0, 10.0]\nperiodic = [true, true]\n[fluid]\ndensity = 4.0\n"
      "a = 25.0\ngamma = 4.5\nkT = 0.5\n[start]\nrelax_sweeps = 0\n[shear]\nflow = \"x\"\ngradient "
      "= \"y\"\nrate = 0.1\n"
      "[[body]]\nshape = \"disk\"\nradius = 1.0\nhydrodynamic_radius = 1.2\nfraction = 0.09\n"
      "fraction_of = \"hydrodynamic\"\n");
  const auto s = odpd::suspension_of(scene);
  // 9 of 100 are two disks of the radius 1.2, three of 1.0.
  EXPECT_EQ(s->kinds[0].bodies, 2);
  EXPECT_NEAR(*s->kinds[0].hydrodynamic_fraction, 2.0 * pi * 1.44 / 100.0, 1e-12);
  EXPECT_NEAR(*s->kinds[0].peclet_of_unit_eta, 4.0 * pi * 1.44 * 0.1 / 0.5, 1e-12);
}

// A calibration is of its own density.
TEST(SuspensionReport, ViscosityOfACalibrationAtAnotherDensity) {
  const odpd::Calibration c{.file = "c.json",
                            .dimension = 2,
                            .density = 4.0,
                            .mass = 0.0,
                            .fluid = {.gamma = 8.0},
                            .gamma_error = 0.1,
                            .eta = 5.0,
                            .eta_error = 0.1};
  const Scene<2> scene(odpd::read_scene_settings<2>(
      odpd::Config::from_text(
          "[box]\nsize = [6.0, 6.0]\nperiodic = [true, true]\n[fluid]\ndensity = "
          "4.0\na = 18.5\neta = 5.0\nkT = 1.0\ncalibration = \"c.json\"\n[start]\n"
          "relax_sweeps = 0\n",
          "test"),
      c));
  EXPECT_EQ(odpd::known_viscosity(scene, 4.0).source, "calibration");
  EXPECT_DOUBLE_EQ(odpd::known_viscosity(scene, 4.0).eta, 5.0);
  EXPECT_DOUBLE_EQ(odpd::known_viscosity(scene, 6.0).eta, 5.0 * 2.25);
}

TEST(SuspensionReport, BodiesMustLeaveRoom) {
  const auto message = [](const std::string& ball, const std::string& pair) -> std::string {
    try {
      scene_of<3>(balls(ball, pair));
    } catch (const odpd::ConfigError& e) {
      return e.what();
    }
    return {};
  };
  EXPECT_EQ(message("excluded_volume = 60.0\n", "excluded_volume = 35.0\n"), "");
  const std::string both = message("excluded_volume = 60.0\n", "excluded_volume = 37.0\n");
  EXPECT_NE(both.find("body.1.excluded_volume"), std::string::npos) << both;
  EXPECT_NE(both.find("217 of the 216"), std::string::npos) << both;
  EXPECT_NE(message("hydrodynamic_radius = 2.6\n", "").find("body.0.hydrodynamic_radius"),
            std::string::npos);
}

}  // namespace
