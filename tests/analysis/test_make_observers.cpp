#include <gtest/gtest.h>

#include "odpd/analysis/observer.h"
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
    auto observers = odpd::make_observers(config, scene, odpd::Clock{.dt = 0.02});
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
    const auto observers = odpd::make_observers(config, scene, odpd::Clock{.dt = 1.0}, false);
    config.reject_unread();
    ASSERT_EQ(observers.size(), 1u);
    EXPECT_EQ(observers[0]->settings().kind, "thermo");
  }
}

TEST_F(MakeObservers, EveryKindCanBeMade) {
  std::string text;
  for (const char* kind : {"thermo", "profile", "density-residual", "rdf", "msd"}) {
    text += std::string("[[observe]]\nkind = \"") + kind + "\"\nevery = 2\n";
  }
  const auto observers = make(text);
  ASSERT_EQ(observers.size(), 5u);
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

TEST_F(MakeObservers, RefuseWhatTheyDoNotKnow) {
  refuse("kind = \"viscosity\"\n", {"kind", "profile", "rdf"});
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
  refuse("kind = \"density-residual\"\nbins = [5.0]\n", {"bins", "2 counts"});
  refuse("kind = \"density-residual\"\nbins = [5.0, 2.5]\n", {"bins", "whole"});
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
