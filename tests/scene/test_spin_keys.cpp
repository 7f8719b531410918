#include <gtest/gtest.h>

#include "cases.h"
#include "odpd/scene/spin_keys.h"
#include "support/errors.h"

namespace {

using cases::periodic;
using cases::settings;
using odpd::ConfigError;
using support::expect_error;

const std::string spinning = std::string(periodic) + "gamma_perp = 2.0\n";
const std::string two_species = "[[species]]\nname = \"a\"\n[[species]]\nname = \"b\"\ncount = 3\n";

TEST(SpinKeys, NobodySpinsUnlessAsked) {
  const odpd::Scene<3> scene(settings<3>(std::string(periodic) + two_species));
  EXPECT_TRUE(scene.particles().spin_of_species.empty());
  EXPECT_FALSE(scene.particles().spins(0));
  EXPECT_EQ(odpd::spins_text(scene.settings().species), "");
}

TEST(SpinKeys, TheMomentIsThatOfASolidSphereOrDiskUnlessGiven) {
  const std::vector<std::string> keys{"fluid.lever_radius=0.5", "fluid.mass=2.0"};
  const auto sphere = settings<3>(spinning, keys);
  EXPECT_DOUBLE_EQ(sphere.species[0].moment, 0.4 * 2.0 * 0.25);
  const std::string flat = std::string(cases::channel);
  const auto disk =
      settings<2>(flat, {"fluid.gamma_perp=2.0", "fluid.lever_radius=0.5", "fluid.mass=2.0"});
  EXPECT_DOUBLE_EQ(disk.species[0].moment, 0.5 * 2.0 * 0.25);
  const auto given =
      settings<3>(spinning, {"fluid.lever_radius=0.5", "fluid.mass=2.0", "fluid.moment=0.125"});
  EXPECT_EQ(given.species[0].moment, 0.125);
  EXPECT_EQ(settings<3>(spinning, {"fluid.lever_radius=0.5"}).species[0].moment, 0.0);
}

TEST(SpinKeys, ASpeciesTakesThoseOfTheFluidOrItsOwn) {
  const std::string text = spinning + "lever_radius = 0.5\nmass = 1.0\n" +
                           "[[species]]\nname = \"a\"\n" +
                           "[[species]]\nname = \"b\"\ncount = 3\nlever_radius = 2.0\n" +
                           "[[species]]\nname = \"c\"\ncount = 4\nlever_radius = 0\n";
  const odpd::Scene<3> scene(settings<3>(text));
  const odpd::Particles<3>& particles = scene.particles();
  ASSERT_EQ(particles.spin_of_species.size(), 3u);
  EXPECT_EQ(particles.spin_of_species[0].lever_radius, 0.5);
  EXPECT_EQ(particles.spin_of_species[1].lever_radius, 2.0);
  EXPECT_DOUBLE_EQ(particles.spin_of_species[1].moment, 0.4 * 4.0);
  EXPECT_EQ(particles.spin_of_species[2].lever_radius, 0.0);
  for (std::size_t i = 0; i < particles.position.size(); ++i)
    EXPECT_EQ(particles.spins(i), particles.species[i] != 2);
  EXPECT_EQ(odpd::spins_text(scene.settings().species),
            "species 'a' (lever radius 0.5, moment of inertia 0.1), 'b' (lever radius 2, moment of "
            "inertia 1.6)");
}

TEST(SpinKeys, FrozenParticlesHaveNoSpinOfTheirOwn) {
  const odpd::Scene<2> scene(
      settings<2>(cases::channel, {"fluid.gamma_perp=2.0", "fluid.lever_radius=0.5"}));
  const odpd::Particles<2>& particles = scene.particles();
  for (std::size_t i = 0; i < particles.position.size(); ++i)
    EXPECT_EQ(particles.spins(i), particles.is_free(i));
}

TEST(SpinKeys, RefusesNumbersThatMakeNoSense) {
  const auto refuse = [](const std::vector<std::string>& keys,
                         std::initializer_list<const char*> parts) {
    expect_error<ConfigError>([&] { settings<3>(spinning, keys); }, parts);
  };
  refuse({"fluid.lever_radius=-1.0"}, {"fluid.lever_radius", "negative"});
  refuse({"fluid.lever_radius=1.0", "fluid.mass=1.0", "fluid.moment=-1.0"},
         {"fluid.moment", "negative"});
  refuse({"fluid.moment=1.0"}, {"fluid.moment", "lever_radius > 0"});
  refuse({"fluid.lever_radius=1.0", "fluid.moment=1.0"}, {"fluid.moment", "fluid.mass"});
  expect_error<ConfigError>([&] { settings<3>(spinning + two_species + "moment = 0.1\n"); },
                            {"species.1.moment", "lever_radius > 0"});
}

}  // namespace
