#include <gtest/gtest.h>

#include "cases.h"
#include "odpd/pairs/sdpd.h"
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
  const std::string text =
      spinning + "lever_radius = 0.5\nmass = 1.0\nantisymmetric_stress = true\n" +
      "[[species]]\nname = \"a\"\n" + "[[species]]\nname = \"b\"\ncount = 3\nlever_radius = 2.0\n" +
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

// Without noise all turn at the start as the sheared flow does: v_x = rate y has half the curl -rate/2.
TEST(SpinKeys, StartTurningAsAShearedFlowDoes) {
  const odpd::Scene<3> scene(settings<3>(
      spinning +
          "lever_radius = 0.5\nmass = 1.0\n[shear]\nflow = \"x\"\ngradient = \"y\"\nrate = 0.8\n",
      {"fluid.kT=0.0"}));
  const odpd::Particles<3>& particles = scene.particles();
  ASSERT_EQ(particles.end_spin.size(), particles.position.size());
  for (std::size_t i = 0; i < particles.end_spin.size(); ++i) {
    EXPECT_NEAR(particles.end_spin[i][2], -0.4, 1e-14);
    EXPECT_EQ(particles.end_spin[i][0], 0.0);
    // The velocity of a neighbour a little up the gradient is the other reading of the same rate.
    EXPECT_NEAR(particles.end_velocity[i][0],
                0.8 * (particles.position[i][1] - 0.5 * scene.box().size[1]), 1e-9);
  }
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

TEST(SpinKeys, FrictionAcrossLinesOfCentresNeedsSpinOrInsistence) {
  const std::string insist = "fluid.antisymmetric_stress=true";
  const auto refuse = [](const std::string& text, const std::vector<std::string>& keys,
                         std::initializer_list<const char*> parts) {
    expect_error<ConfigError>([&] { settings<3>(text, keys); }, parts);
  };
  refuse(spinning, {}, {"fluid.gamma_perp", "lever_radius", "antisymmetric_stress = true"});
  refuse(spinning, {"fluid.antisymmetric_stress=false"}, {"fluid.gamma_perp"});
  EXPECT_NO_THROW(settings<3>(spinning, {insist}));
  EXPECT_NO_THROW(settings<3>(spinning, {"fluid.lever_radius=0.5", insist}));
  // One end that spins takes up the torque; between two that do not nothing does.
  const std::string species =
      "[[species]]\nname = \"a\"\n[[species]]\nname = \"b\"\ncount = 3\nlever_radius = 1.0\n";
  const auto pair = [](const char* a, const char* b) {
    return std::string("[[pair]]\nspecies = [\"") + a + "\", \"" + b + "\"]\ngamma_perp = 1.0\n";
  };
  EXPECT_NO_THROW(settings<3>(periodic + species + pair("a", "b")));
  EXPECT_NO_THROW(settings<3>(periodic + species + pair("b", "b")));
  refuse(periodic + species + pair("a", "b") + pair("a", "a"), {}, {"pair.1.gamma_perp"});
  refuse(spinning + species, {}, {"fluid.gamma_perp"});
  // Whatever the model that takes DPD's friction.
  refuse(spinning + "model = \"gaussian\"\nw = 0.3\n", {}, {"fluid.gamma_perp"});
  std::string many = spinning + "model = \"mdpd\"\nA = -10.0\nB = 12.0\nr_d = 0.9\nfilled = true\n";
  many.erase(many.find("a = 18.75\n"), 10);
  refuse(many, {}, {"fluid.gamma_perp"});
  EXPECT_NO_THROW(settings<3>(many, {"fluid.lever_radius=0.5"}));
}

TEST(SpinKeys, WhatNothingTurnsIsRefused) {
  const auto refuse = [](const std::string& text, const std::vector<std::string>& keys,
                         std::initializer_list<const char*> parts) {
    expect_error<ConfigError>([&] { settings<3>(text, keys); }, parts);
  };
  refuse(periodic, {"fluid.lever_radius=0.5"},
         {"fluid.lever_radius", "'fluid'", "across lines of centres", "gamma_perp"});
  refuse(periodic, {"fluid.lever_radius=0.5", "fluid.mass=1.0"}, {"fluid.lever_radius"});
  const std::string b =
      "[[species]]\nname = \"a\"\n[[species]]\nname = \"b\"\ncount = 3\nlever_radius = 1.0\n";
  refuse(periodic + b, {}, {"species.1.lever_radius", "'b'"});
}

const std::string sdpd = R"(
[box]
size = [7.0, 7.0, 7.0]
periodic = [true, true, true]
[fluid]
model = "sdpd"
density = 1.0
eta = 3.0
bulk_modulus = 10.0
kT = 0.1
)";

TEST(SpinKeys, SdpdSpinsAsOneFluid) {
  const auto plain = settings<3>(sdpd, {"fluid.form=classical"});
  EXPECT_EQ(plain.species[0].lever_radius, 0.0);
  const auto scene =
      settings<3>(sdpd, {"fluid.form=classical", "fluid.spin=true", "fluid.mass=2.0"});
  EXPECT_DOUBLE_EQ(scene.species[0].lever_radius, 0.5);
  EXPECT_DOUBLE_EQ(scene.species[0].moment, 0.4 * 2.0 * 0.25);
  const odpd::SdpdFriction& f = dynamic_cast<const odpd::SdpdModel<3>&>(*scene.model).friction();
  EXPECT_NEAR(f.A, 20.0 / 7.0 * 3.0, 1e-14);
  EXPECT_EQ(f.A, f.B);
  const auto own =
      settings<3>(sdpd, {"fluid.zeta_b=1.0", "fluid.spin=true", "fluid.lever_radius=0.25"});
  EXPECT_EQ(own.species[0].lever_radius, 0.25);
  EXPECT_NEAR(dynamic_cast<const odpd::SdpdModel<3>&>(*own.model).friction().zeta_b(3), 1.0, 1e-14);
  const auto refuse = [](const std::vector<std::string>& keys,
                         std::initializer_list<const char*> parts) {
    expect_error<ConfigError>([&] { settings<3>(sdpd, keys); }, parts);
  };
  refuse({"fluid.spin=true"}, {"fluid.spin", "form = \"classical\""});
  refuse({"fluid.lever_radius=0.5"}, {"fluid.lever_radius", "fluid.spin = true"});
  refuse({"fluid.form=classical", "fluid.lever_radius=0.5"},
         {"fluid.lever_radius", "another viscosity"});
  refuse({"fluid.form=classical", "fluid.spin=true", "fluid.lever_radius=0.0"},
         {"fluid.lever_radius", "fluid.spin"});
  const std::string still = "[[species]]\nname = \"a\"\nlever_radius = 0.0\n";
  expect_error<ConfigError>(
      [&] {
        settings<3>(sdpd + still, {"fluid.form=classical", "fluid.spin=true"});
      },
      {"species.0.lever_radius", "all of the fluid"});
}

}  // namespace
