#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "cases.h"
#include "support/errors.h"

namespace {

using cases::channel;
using cases::periodic;
using cases::settings;
using odpd::ConfigError;
using odpd::StartKind;
using support::expect_error;
using Overrides = std::vector<std::string>;

/// Of a pair of species A, B.
template <int D>
const odpd::DpdParameters& dpd(const odpd::SceneSettings<D>& scene, std::int32_t a = 0,
                               std::int32_t b = 0) {
  return dynamic_cast<const odpd::DpdModel<D>&>(*scene.model).parameters({a}, {b});
}

void refuse(const std::string& text, const Overrides& overrides,
            std::initializer_list<const char*> parts) {
  expect_error<ConfigError>([&] { settings<2>(text, overrides); }, parts);
}

TEST(SceneSettings, ReadsAChannel) {
  const auto scene = settings<2>(channel);
  EXPECT_EQ(scene.seed, 3u);
  EXPECT_EQ(scene.box.size, (odpd::Vec<2>{{10.0, 12.0}}));
  EXPECT_TRUE(scene.box.is_periodic(0));
  EXPECT_FALSE(scene.box.is_periodic(1));
  EXPECT_EQ(scene.density, 4.0);
  EXPECT_EQ(scene.count, -1);
  EXPECT_EQ(scene.start, StartKind::random);
  EXPECT_EQ(scene.relax_sweeps, 100);
  EXPECT_EQ(scene.model->species(), 1);
  EXPECT_EQ(scene.model->name(), "dpd");
  EXPECT_EQ(dpd(scene).a, 18.75);
  EXPECT_EQ(dpd(scene).gamma, 4.5);
  EXPECT_EQ(dpd(scene).s, 0.5);
  ASSERT_EQ(scene.walls.size(), 2u);
  EXPECT_EQ(scene.wall_at(1, false), 0);
  EXPECT_EQ(scene.wall_at(1, true), 1);
  EXPECT_EQ(scene.wall_at(0, true), -1);
  EXPECT_EQ(scene.walls[1].velocity[0], 1.0);
  EXPECT_EQ(scene.walls[1].layers[1].count, 20);
  EXPECT_EQ(scene.walls[1].layers[1].depth, 0.5);
}

TEST(SceneSettings, SigmaSetsTheFriction) {
  const auto scene = settings<2>(R"(
[box]
size = [5.0, 5.0]
periodic = [true, true]
[fluid]
count = 77
a = 25.0
sigma = 3.0
kT = 0.5
[fluid.rattler_friction]
gamma = 0.1
cutoff = 2.0
[start]
from = "lattice"
)");
  EXPECT_DOUBLE_EQ(dpd(scene).gamma, 9.0);  // sigma^2 / (2 kT)
  EXPECT_EQ(dpd(scene).gamma_far, 0.1);
  EXPECT_EQ(dpd(scene).cutoff_far, 2.0);
  EXPECT_EQ(scene.count, 77);
  EXPECT_EQ(scene.start, StartKind::lattice);
  EXPECT_EQ(scene.relax_sweeps, 0);
}

const char* by_properties = R"(
[box]
size = [4.0, 5.0]
periodic = [true, true]
[fluid]
count = 80
kT = 1.0
eta = 3.0
kappa_inverse = 20.0
s_bar = 1.0
[[species]]
name = "water"
fraction = 0.5
[[species]]
name = "oil"
fraction = 0.5
[[pair]]
species = ["water", "oil"]
a = 60.0
)";

TEST(SceneSettings, PhysicalInputsSetTheFluidAndPairsOverride) {
  const auto scene = settings<2>(by_properties);
  const odpd::DpdParameters& fluid = odpd::dpd_fluid(*scene.model)->p;
  const auto theory =
      odpd::kinetic_theory<2>(odpd::pair_moments(*odpd::make_dpd<2>(fluid), 1), {1.0}, 4.0, 0.0);
  EXPECT_NEAR(theory.eta_friction, 3.0, 1e-12);
  EXPECT_NEAR(theory.kappa_inverse, 20.0, 1e-12);
  EXPECT_EQ(dpd(scene), fluid);
  EXPECT_EQ(dpd(scene, 0, 1).a, 60.0);
  EXPECT_EQ(dpd(scene, 0, 1).gamma, fluid.gamma);
}

TEST(SceneSettings, TheResolvedCaseHoldsPhysicalInputsAndNothingDerived) {
  const odpd::Config first = odpd::Config::from_text(by_properties, "case.toml");
  const auto scene = odpd::read_scene_settings<2>(first);
  EXPECT_NO_THROW(first.reject_unread());
  const auto again = settings<2>(first.resolved());
  for (const auto& [a, b] : {std::pair{0, 0}, std::pair{0, 1}, std::pair{1, 1}})
    EXPECT_EQ(dpd(again, a, b), dpd(scene, a, b));
}

TEST(SceneSettings, PhysicalInputsCountParticlesBetweenTheWalls) {
  // 400 particles in 10 x 10 between walls of thickness 1 are a density of 4.
  const std::string text = channel;
  const auto without = [&](std::string line, std::string from) {
    return from.erase(from.find(line), line.size());
  };
  const std::string bare = without("gamma = 4.5\n", text);
  const auto by_density = settings<2>(bare, {"fluid.eta=3.0"});
  const auto by_count =
      settings<2>(without("density = 4.0\n", bare), {"fluid.eta=3.0", "fluid.count=400"});
  EXPECT_DOUBLE_EQ(dpd(by_count).gamma, dpd(by_density).gamma);
}

TEST(SceneSettings, RhoIsDensityTimesMass) {
  const std::string fluid =
      "[box]\nsize = [4.0, 5.0]\nperiodic = [true, true]\n"
      "[fluid]\na = 1.0\ngamma = 1.0\nkT = 1.0\nrho = 8.0\n";
  EXPECT_DOUBLE_EQ(settings<2>(fluid + "mass = 2.0\n").density, 4.0);
  EXPECT_DOUBLE_EQ(settings<2>(fluid + "density = 4.0\n").mass, 2.0);
  EXPECT_DOUBLE_EQ(settings<2>(fluid + "count = 80\n").mass, 2.0);
  refuse(fluid, {}, {"fluid.rho", "two of"});
  refuse(fluid + "mass = 0.0\n", {}, {"fluid.rho", "mass = 0"});
  refuse(fluid + "mass = 1.0\ndensity = 4.0\n", {}, {"fluid.rho", "never three"});
}

TEST(SceneSettings, PairsOfSpeciesInheritFromTheFluid) {
  const auto scene = settings<3>(std::string(periodic) + R"(
[[species]]
name = "water"
fraction = 0.75
[[species]]
name = "oil"
fraction = 0.25
[[pair]]
species = ["water", "oil"]
a = 60.0
)");
  EXPECT_EQ(scene.model->species(), 2);
  EXPECT_EQ(dpd(scene).a, 18.75);
  EXPECT_EQ(dpd(scene, 0, 1).a, 60.0);
  EXPECT_EQ(dpd(scene, 1, 0).a, 60.0);
  EXPECT_EQ(dpd(scene, 0, 1).gamma, 4.5);
  EXPECT_EQ(dpd(scene, 1, 1).a, 18.75);
}

TEST(SceneSettings, RefusesBadFluids) {
  refuse(channel, {"fluid.sigma=3.0"}, {"sigma", "never both"});
  refuse(channel, {"fluid.density=-4.0"}, {"fluid.density"});
  refuse(channel, {"fluid.density=0.0"}, {"fluid.density"});
  refuse(channel, {"fluid.count=100"}, {"fluid.count", "density or count"});
  refuse(channel, {"fluid.mass=-1.0"}, {"fluid.mass", "negative"});
  refuse(channel, {"fluid.gamma=0.0"}, {"fluid.gamma"});
  refuse(channel, {"fluid.kT=-1.0"}, {"fluid.kT"});
  refuse(channel, {"fluid.a=-1.0"}, {"fluid.a"});
  refuse(channel, {"fluid.cutoff=0.0"}, {"fluid.cutoff"});
  refuse(channel, {"fluid.model=spheres"}, {"fluid.model", "dpd"});
  refuse(channel, {"fluid.rattler_friction.gamma=0.1", "fluid.rattler_friction.cutoff=1.0"},
         {"cutoff", "larger than fluid.cutoff"});
  refuse(channel, {"seed=-1"}, {"seed"});
  refuse(channel, {"start.from=grid"}, {"start.from", "lattice"});
  refuse(channel, {"start.relax_sweeps=-1"}, {"relax_sweeps"});
  refuse(
      "[box]\nsize = [9.0, 9.0]\nperiodic = [true, true]\n"
      "[fluid]\ndensity = 4.0\na = 1.0\nkT = 0.0\nsigma = 3.0\n",
      {}, {"case.toml:", "sigma", "gamma"});
}

TEST(SceneSettings, RefusesBadBoxes) {
  refuse(channel, {"box.size=[10.0]"}, {"box.size", "2 components"});
  refuse(channel, {"box.size=[10.0, -12.0]"}, {"box.size", "positive"});
  refuse(channel, {"box.periodic=[true]"}, {"box.periodic", "2 flags"});
  refuse(channel, {"box.periodic=[false, false]", "wall.1.velocity=[0.0, 0.0]"},
         {"direction x is bounded", "x-"});
}

TEST(SceneSettings, RefusesBadWalls) {
  refuse(channel, {"box.periodic=[true, true]"}, {"wall", "direction y is periodic"});
  refuse(channel, {"wall.1.side=y-"}, {"two walls at y-"});
  refuse(channel, {"wall.0.side=top"}, {"side", "y+"});
  refuse(channel, {"wall.0.layers.1.depth=1.01"}, {"depth", "outside the box", "thickness = 1"});
  refuse(channel, {"wall.0.layers.1.depth=-0.1"}, {"depth"});
  refuse(channel, {"wall.0.layers.0.count=0"}, {"count", "positive"});
  refuse(channel, {"wall.0.layers.0.spacing=0.2"}, {"count or spacing"});
  refuse(channel, {"wall.1.velocity=[1.0, 0.5]"}, {"velocity", "component y must be 0"});
  refuse(channel, {"wall.0.thickness=6.0"}, {"thickness", "half of the box"});
  refuse(channel, {"wall.0.species=oil"}, {"species", "'oil'", "fluid"});
  refuse(channel, {"wall.0.stiffness=0.0"}, {"stiffness"});
  refuse(channel, {"wall.0.layers=[]"}, {"layers", "at least one layer"});
  const std::string text = channel;
  const std::size_t second = text.rfind("[[wall]]");
  refuse(text.substr(0, second), {}, {"box.periodic", "direction y is bounded", "upper", "y+"});
  refuse(text.substr(0, second) + "[[wall]]\nside = \"y+\"\n", {}, {"layers", "depth = 0.0"});
}

TEST(SceneSettings, ALayerOfA3DWallHasASpacing) {
  const char* text = R"(
[[wall]]
side = "z-"
layers = [{ depth = 0.0, count = 50 }]
[[wall]]
side = "z+"
layers = [{ depth = 0.0, spacing = 0.5 }]
)";
  const Overrides bounded{"box.periodic=[true, true, false]"};
  expect_error<ConfigError>([&] { settings<3>(std::string(periodic) + text, bounded); },
                            {"count", "spacing"});
}

TEST(SceneSettings, RefusesAForceThatNothingBalances) {
  expect_error<ConfigError>([] { settings<3>(periodic, {"body_force.force=[0.1, 0.0, 0.0]"}); },
                            {"body_force.force", "net force"});
  EXPECT_NO_THROW(settings<3>(periodic, {"body_force.force=[0.0, 0.0, 0.0]"}));
  EXPECT_EQ(settings<2>(channel, {"body_force.force=[0.1, 0.0]"}).body_force[0], 0.1);
}

TEST(SceneSettings, ReadsAWaveAndRegions) {
  const auto wave = settings<3>(
      periodic, {"body_force.force=[0.1, 0.0, 0.0]", "body_force.wave={along=\"y\", number=2}"});
  EXPECT_EQ(wave.force_wave.along, 1);
  EXPECT_EQ(wave.force_wave.number, 2);
  EXPECT_TRUE(wave.driven() && wave.force_varies() && wave.forces_along(0));
  EXPECT_FALSE(wave.forces_along(1));
  EXPECT_NEAR(wave.force_at({{1.0, 0.5, 2.0}})[0], 0.1, 1e-15);  // a quarter of the period 2
  const std::string half = "[[body_force.region]]\naxis = \"y\"\n";
  const std::string up = half + "from = 0.0\nto = 2.0\nforce = [0.3, 0.0, 0.0]\n";
  const auto two =
      settings<3>(periodic + up + half + "from = 2.0\nto = 4.0\nforce = [-0.3, 0.0, 0.0]\n", {});
  EXPECT_TRUE(two.driven() && two.force_varies() && two.forces_along(0));
  EXPECT_EQ(two.force_at({{1.0, 1.99, 2.0}})[0], 0.3);
  EXPECT_EQ(two.force_at({{1.0, 2.0, 2.0}})[0], -0.3);
  expect_error<ConfigError>([&] { settings<3>(periodic + up, {}); },
                            {"body_force.region", "net force"});
}

// Without divergence, and an eigenfunction of the Laplacian, by differences.
TEST(SceneSettings, TaylorGreenVorticesAreAWaveWithoutDivergence) {
  const auto s =
      settings<3>(periodic, {"box.size=[5.0, 4.0, 6.0]", "body_force.force=[0.1, 0.0, 0.0]",
                             "body_force.wave={shape=\"taylor-green\", along=\"z\", number=2}"});
  EXPECT_TRUE(s.forces_along(0) && s.forces_along(2));
  EXPECT_FALSE(s.forces_along(1));
  const double k2 = s.force_wave.wave_number_squared(s.box, s.body_force), h = 1e-3;
  EXPECT_NEAR(k2, 16.0 * std::numbers::pi * std::numbers::pi * (1.0 / 25.0 + 1.0 / 36.0), 1e-12);
  const odpd::Vec<3> r{{1.3, 0.4, 2.9}};
  const auto f = s.force_at(r);
  odpd::Vec<3> laplacian{};
  double divergence = 0.0, largest = 0.0;
  for (int c = 0; c < 3; ++c) {
    odpd::Vec<3> step{};
    step[c] = h;
    const auto above = s.force_at(r + step), below = s.force_at(r - step);
    divergence += (above[c] - below[c]) / (2.0 * h);
    laplacian += 1.0 / (h * h) * (above + below - 2.0 * f);
  }
  EXPECT_NEAR(divergence, 0.0, 1e-7);
  EXPECT_GT(norm(f), 0.02);
  EXPECT_LT(norm(laplacian + k2 * f), 1e-5 * k2 * norm(f) + 1e-6);
  for (int k = 0; k < 1000; ++k)
    largest = std::max(largest, norm(s.force_at({{0.005 * k, 0.0, 0.0371 * k}})));
  EXPECT_LE(largest, s.largest_force());
  EXPECT_GT(largest, 0.95 * s.largest_force());
}

TEST(SceneSettings, ReadsAFlowAtTheStart) {
  const Overrides flow{"start.velocity=[0.0, 0.3, 0.0]",
                       "start.wave={shape=\"taylor-green\", along=\"x\"}"};
  Overrides heavy = flow;
  heavy.push_back("fluid.mass=1.0");
  const auto s = settings<3>(periodic, heavy);
  EXPECT_TRUE(s.driven());
  EXPECT_EQ(s.start_velocity[1], 0.3);
  EXPECT_EQ(s.start_wave.number, 1);
  const auto refused = [&](const Overrides& overrides, std::initializer_list<const char*> parts) {
    expect_error<ConfigError>([&] { settings<3>(periodic, overrides); }, parts);
  };
  refused(flow, {"start.velocity", "fluid.mass", "body_force.wave"});
  Overrides sheared = heavy, alone = heavy, both = heavy, along = heavy;
  sheared.push_back("shear.rate=0.1");
  refused(sheared, {"start.velocity", "[shear]"});
  refused({heavy[0], heavy[2]}, {"start.velocity", "start.wave"});
  refused({heavy[1], heavy[2]}, {"start.wave", "amplitude", "start.velocity"});
  both.push_back("start.velocity=[0.0, 0.3, 0.1]");
  refused(both, {"start.velocity", "one component"});
  along.push_back("start.velocity=[0.1, 0.3, 0.0]");
  refused(along, {"start.velocity", "component x"});
  expect_error<ConfigError>(
      [] {
        settings<2>(channel, {"fluid.mass=1.0", "start.velocity=[0.0, 0.3]",
                              "start.wave={shape=\"taylor-green\", along=\"x\"}"});
      },
      {"start.wave.along", "y is bounded"});
}

TEST(SceneSettings, RefusesBadWavesAndRegions) {
  const auto refuse_3d = [](const std::string& text, const Overrides& overrides,
                            std::initializer_list<const char*> parts) {
    expect_error<ConfigError>([&] { settings<3>(text, overrides); }, parts);
  };
  const std::string force = "body_force.force=[0.1, 0.0, 0.0]", wave = "body_force.wave=";
  refuse_3d(periodic, {wave + "{along=\"y\"}"}, {"body_force.wave", "amplitude"});
  refuse_3d(periodic, {force, wave + "{along=\"x\"}"}, {"body_force.force", "along the wave"});
  refuse_3d(periodic, {force, wave + "{along=\"y\", number=0}"}, {"body_force.wave.number"});
  refuse_3d(periodic, {force, wave + "{along=\"w\"}"}, {"body_force.wave.along"});
  expect_error<ConfigError>(
      [&] {
        settings<2>(channel, {"body_force.force=[0.1, 0.0]", wave + "{along=\"y\"}"});
      },
      {"body_force.wave.along", "bounded"});
  const auto region = [](const std::string& keys) {
    return "body_force.region=[{axis=\"y\", force=[0.1, 0.0, 0.0], " + keys + "}]";
  };
  refuse_3d(periodic, {region("from=2.0, to=1.0")}, {"to", "larger than from"});
  refuse_3d(periodic, {region("from=2.0, to=4.1")}, {"to", "outside the box"});
  refuse_3d(periodic, {region("from=-1.0, to=1.0")}, {"from"});
}

TEST(SceneSettings, RefusesBadSpecies) {
  const auto with = [](const std::string& species) {
    expect_error<ConfigError>([&] { settings<3>(periodic + species); }, {"species"});
  };
  const std::string a = "[[species]]\nname = \"a\"\n", b = "[[species]]\nname = \"b\"\n";
  with(a + "fraction = 0.5\n" + b + "fraction = 0.6\n");
  with(a + "fraction = 0.5\n" + a + "fraction = 0.5\n");
  with(a + "fraction = 0.5\ncount = 3\n" + b + "fraction = 0.5\n");
  with(a + "count = -3\n" + b);
  with(a + "fraction = -0.5\n" + b + "fraction = 1.5\n");
  with(a + "[[pair]]\nspecies = [\"a\", \"c\"]\na = 3.0\n");
  with(a + "[[pair]]\nspecies = [\"a\"]\na = 3.0\n");
  EXPECT_NO_THROW(settings<3>(periodic + a + "fraction = 0.5\n" + b + "fraction = 0.5\n"));
  EXPECT_NO_THROW(settings<3>(periodic + a + "count = 3\n" + b));
}

TEST(SceneSettings, ReadsEveryKeyItKnowsAndNoOther) {
  const odpd::Config good = odpd::Config::from_text(channel, "case.toml");
  odpd::read_scene_settings<2>(good);
  EXPECT_NO_THROW(good.reject_unread());
  const odpd::Config typo = odpd::Config::from_text(channel, "case.toml", {"fluid.gama_perp=1.0"});
  odpd::read_scene_settings<2>(typo);
  expect_error<ConfigError>([&] { typo.reject_unread(); }, {"gama_perp", "gamma_perp"});
}

}  // namespace
