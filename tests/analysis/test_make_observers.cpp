#include <gtest/gtest.h>

#include "odpd/analysis/registry.h"
#include "records.h"
#include "support/errors.h"

namespace {

using odpd::Config;
using odpd::ConfigError;
using odpd::Scene;
using support::expect_error;

class MakeObservers : public ::testing::Test {
 protected:
  MakeObservers()
      : scene(records::periodic<2>(
            5.0, support::random_points<2>({}, support::uniform_vec<2>(5.0), 20, 1))) {}

  std::vector<std::unique_ptr<odpd::Observer<2>>> make(const std::string& text) const {
    const Config config = Config::from_text(text, "case.toml");
    auto observers = odpd::make_observers<2>(config, scene, odpd::Clock{.dt = 0.02});
    config.reject_unread();
    return observers;
  }
  void refuse(const std::string& text, std::initializer_list<const char*> parts) const {
    expect_error<ConfigError>([&] { make("[[observe]]\n" + text); }, parts);
  }

  Scene<2> scene;
};

TEST_F(MakeObservers, ThermoAndMsdAreAlwaysThere) {
  const auto defaults = make("");
  ASSERT_EQ(defaults.size(), 2u);
  EXPECT_EQ(defaults[0]->settings().name, "thermo");
  EXPECT_EQ(defaults[1]->settings().name, "msd");
  EXPECT_FALSE(defaults[0]->settings().series);
  const auto own = make("[[observe]]\nkind = \"thermo\"\nevery = 3\nseries = true\n");
  ASSERT_EQ(own.size(), 2u);
  EXPECT_EQ(own[0]->settings().every, 3);
  EXPECT_TRUE(own[0]->settings().series);
}

TEST_F(MakeObservers, WithoutTimeThereIsNoMsd) {
  for (const char* text : {"", "[[observe]]\nkind = \"msd\"\nwindow = 2.0\n"}) {
    const Config config = Config::from_text(text, "case.toml");
    const auto observers = odpd::make_observers<2>(config, scene, odpd::Clock{.dt = 1.0},
                                                   odpd::integrator_traits("monte-carlo"));
    config.reject_unread();
    ASSERT_EQ(observers.size(), 1u);
    EXPECT_EQ(observers[0]->settings().kind, "thermo");
  }
}

TEST_F(MakeObservers, EveryKindCanBeMade) {
  std::string text;
  for (const char* kind :
       {"thermo", "profile", "density-residual", "rdf", "msd", "stress", "divergence", "heat"}) {
    text += std::string("[[observe]]\nkind = \"") + kind + "\"\nevery = 2\n";
  }
  const auto observers = make(text);
  ASSERT_EQ(observers.size(), 8u);
  for (const auto& observer : observers) {
    EXPECT_EQ(observer->settings().name, observer->settings().kind);
    EXPECT_FALSE(observer->series_columns().empty());
  }
}

TEST_F(MakeObservers, TellWhenTheyAreDue) {
  const auto observers = make("[[observe]]\nkind = \"thermo\"\nevery = 3\n");
  odpd::Clock clock{.dt = 0.02, .step = 0, .equilibration_steps = 10, .total_steps = 100};
  for (clock.step = 0; clock.step < 20; ++clock.step) {
    EXPECT_EQ(observers[0]->is_due(clock), clock.step > 10 && (clock.step - 10) % 3 == 0)
        << "step " << clock.step;
  }
}

TEST_F(MakeObservers, SampleATimeWindowOnly) {
  odpd::Clock clock{.dt = 0.02, .step = 0, .equilibration_steps = 10, .total_steps = 100};
  const auto made = [&](const std::string& keys) {
    const Config config =
        Config::from_text("[[observe]]\nkind = \"thermo\"\nevery = 4\n" + keys, "case.toml");
    auto observers = odpd::make_observers<2>(config, scene, clock);
    config.reject_unread();
    return observers;
  };
  const auto observers = made("from = 0.2\nuntil = 0.4\n");  // measured steps 11 to 20
  for (clock.step = 0; clock.step < 50; ++clock.step)
    EXPECT_EQ(observers[0]->is_due(clock), clock.step == 22 || clock.step == 26 || clock.step == 30)
        << "step " << clock.step;
  for (const char* keys : {"from = 1.8\n", "from = 0.4\nuntil = 0.4\n", "until = 0.06\n"})
    expect_error<ConfigError>([&] { made(keys); }, {"no step of the run", "1.8"});
}

TEST_F(MakeObservers, RefuseWhatTheyDoNotKnow) {
  refuse("kind = \"viscosities\"\n", {"kind", "profile", "rdf", "viscosity"});
  refuse("name = \"x\"\n", {"kind"});
  refuse("kind = \"thermo\"\nevery = 0\n", {"every"});
  refuse("kind = \"thermo\"\nbins = 3\n", {"bins"});
  refuse("kind = \"rdf\"\nr_max = 2.51\n", {"r_max", "half the shortest periodic edge", "2.5"});
  refuse("kind = \"rdf\"\nbins = 0\n", {"bins"});
  refuse("kind = \"msd\"\nwindow = 1.0\nfit_from = 1.0\n", {"fit_from", "window"});
  refuse("kind = \"msd\"\ndirections = [\"z\"]\n", {"directions", "'z'"});
  refuse("kind = \"msd\"\ndirections = []\n", {"directions"});
  refuse("kind = \"profile\"\naxis = \"z\"\n", {"axis"});
  refuse("kind = \"profile\"\nfit = \"cubic\"\n", {"fit", "parabola"});
  refuse("kind = \"profile\"\nfit_from = 3.0\nfit_to = 2.0\n", {"fit_from", "fit_to"});
  refuse("kind = \"profile\"\nfit = \"sine\"\n", {"fit", "body_force.wave"});
  refuse("kind = \"stress\"\nbins = -1\n", {"bins"});
  refuse("kind = \"stress\"\naxis = \"x\"\n", {"axis"});
  refuse("kind = \"viscosity\"\nwindow = 0.1\nfit_from = 0.2\n", {"fit_from", "window"});
  refuse("kind = \"viscosity\"\nevery = 2\n", {"every", "every step"});
  refuse("kind = \"viscosity\"\nbins = 20\n", {"bins"});
  refuse("kind = \"divergence\"\nbins = [2.0, 5.0]\n", {"bins", "at least 3"});
  refuse("kind = \"density-residual\"\nbins = [5.0]\n", {"bins", "2 counts"});
  refuse("kind = \"density-residual\"\nbins = [5.0, 2.5]\n", {"bins", "whole"});
  refuse("kind = \"density-residual\"\nclear_of_bodies = 1.0\n", {"clear_of_bodies", "[[body]]"});
}

// What no key in the file asks for is refused by none: a channel two cutoffs wide has no room for the default range of a fit.
TEST_F(MakeObservers, TakeAChannelWithoutRoomForAFit) {
  auto s = records::periodic<2>(4.0, {{{1.0, 2.0}}, {{3.0, 2.2}}});
  records::add_walls(s, 1.0);
  const Scene<2> thin(s);
  const auto made = [&](const std::string& keys) {
    const Config config = Config::from_text("[[observe]]\n" + keys, "case.toml");
    auto observers = odpd::make_observers<2>(config, thin, odpd::Clock{.dt = 0.02});
    config.reject_unread();
    return observers;
  };
  auto profile = std::move(made("kind = \"profile\"\n").front());
  profile->measure(odpd::Clock{.dt = 0.02}, thin.particles(), records::record(thin));
  const auto results = records::results(*profile);
  ASSERT_EQ(results.tables.size(), 1u);
  EXPECT_EQ(results.tables[0].second.rows.size(), 20u);
  EXPECT_TRUE(results.scalars.empty()) << "no fit, no numbers of one";
  ASSERT_EQ(results.notes.size(), 1u);
  EXPECT_NE(results.notes[0].find("two cutoffs"), std::string::npos);
  const auto refused = [&](const std::string& keys, std::initializer_list<const char*> parts) {
    expect_error<ConfigError>([&] { made(keys); }, parts);
  };
  refused("kind = \"profile\"\nfit = \"linear\"\n", {"case.toml:3", "fit'", "fit_from and fit_to"});
  refused(
      "kind = \"profile\"\nfit_from = 2.5\n",
      {"case.toml:3", "fit_from'", "fit_from = 2.5 must be less than fit_to = 2 (the default)"});
  refused("kind = \"profile\"\nfit_to = 1.5\n", {"case.toml:3", "fit_to'", "2 (the default)"});
  refused("kind = \"profile\"\nfit_from = 2.0\nfit_to = 1.5\n", {"case.toml:3", "fit_from'"});
  refused("kind = \"viscosity\"\n", {"case.toml:2", "kind'", "wider than two cutoffs"});
  EXPECT_EQ(made("kind = \"profile\"\nfit = \"linear\"\nfit_from = 1.2\nfit_to = 2.8\n").size(),
            3u);
  EXPECT_EQ(made("kind = \"divergence\"\n").size(), 3u)
      << "three cells across, though it is 2 wide";
  refused("kind = \"rdf\"\nreference = 1.0\ncompare_from = 2.0\n",
          {"case.toml:4", "compare_from'"});
}

TEST_F(MakeObservers, RefuseWhatTheSceneHasNot) {
  const auto refused = [](odpd::SceneSettings<2> s, const std::string& kind,
                          std::initializer_list<const char*> parts) {
    const Scene<2> other(std::move(s));
    const Config config = Config::from_text("[[observe]]\nkind = \"" + kind + "\"\n", "case.toml");
    expect_error<ConfigError>(
        [&] { odpd::make_observers<2>(config, other, odpd::Clock{.dt = 0.02}); }, parts);
  };
  const auto s = records::periodic<2>(5.0, {{{1.0, 1.0}}, {{3.0, 3.0}}});
  auto cold = s, heavy = s, dragged = s;
  cold.model = odpd::make_dpd<2>({.kT = 0.0});
  heavy.mass = 1.0;
  dragged.zeta_0 = 0.1;
  refused(cold, "viscosity", {"kind", "move a wall", "body_force.wave"});
  refused(dragged, "viscosity", {"kind"});
  refused(heavy, "heat", {"kind", "fluid.mass"});
  refused(dragged, "heat", {"kind", "fluid.zeta_0"});
  auto disk = s, fixed = s;
  odpd::BodySettings<2> body;
  body.shape = {{{0.0, 0.0}}, {{0.4, 0.0}}, {{0.0, 0.4}}};
  body.positions = {{{2.0, 4.0}}};
  disk.bodies = {body};
  body.motion = odpd::BodyMotion::fixed;
  fixed.bodies = {body};
  auto pushed = disk, heavy_disk = disk, dragged_disk = disk;
  dragged_disk.zeta_0 = 0.1;
  pushed.bodies[0].load.force = {{1.0, 0.0}};
  heavy_disk.mass = 1.0;
  const std::string control = "bodies\"\ncontrol = true\nwindow = 1.0\n";
  refused(fixed, control + "name = \"b", {"control", "must be free"});
  refused(dragged_disk, control + "name = \"b", {"control", "zeta_0"});
  refused(pushed, control + "name = \"b", {"control", "equilibrium"});
  refused(heavy_disk, control + "name = \"b", {"control", "fluid.mass"});
  refused(disk, control + "every = 2\nname = \"b", {"control", "every must be 1"});
  refused(heavy, "wave", {"kind", "body_force.wave", "start.wave"});
  auto vortices = s;
  vortices.body_force = {{1.0, 0.0}};
  vortices.force_wave = {.along = 1, .number = 1, .shape = odpd::FlowWave::Shape::taylor_green};
  refused(vortices, "viscosity", {"kind", "'wave'"});
  refused(vortices, "profile\"\nfit = \"sine", {"fit", "body_force.wave"});
}

TEST_F(MakeObservers, RefuseTwoOfOneName) {
  refuse("kind = \"rdf\"\n[[observe]]\nkind = \"rdf\"\n", {"name", "'rdf'"});
  refuse("kind = \"rdf\"\nname = \"x\"\n[[observe]]\nkind = \"thermo\"\nname = \"x\"\n", {"'x'"});
  EXPECT_EQ(
      make("[[observe]]\nkind = \"rdf\"\n[[observe]]\nkind = \"rdf\"\nname = \"fine\"\n").size(),
      4u);
  refuse("kind = \"rdf\"\nname = \"thermo\"\n", {"'thermo'"});
}

}  // namespace
