// What every kind of observer must do, over the rows of the table; and kinds of a user's own.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "odpd/analysis/registry.h"
#include "odpd/dynamics/integrator.h"
#include "records.h"
#include "support/errors.h"
#include "support/memory_archive.h"

namespace {

using odpd::Config;
using odpd::Observer;
using odpd::ObserverEntry;
using odpd::ObserverKind;
using odpd::Results;
using odpd::Scene;

using Observers = std::vector<std::unique_ptr<Observer<2>>>;

/// A scene in which every kind finds what it measures: moving walls, a free body, a molecule.
odpd::SceneSettings<2> everything(double mass = 0.0) {
  const Config config = Config::from_text(R"(
    [box]
    size = [6.0, 8.0]
    periodic = [true, false]
    [fluid]
    density = 4.0
    kT = 1.0
    a = 18.5
    gamma = 4.5
    [[species]]
    name = "fluid"
    fraction = 1.0
    [[species]]
    name = "bead"
    count = 0
    [[wall]]
    side = "y-"
    velocity = [-1.0, 0.0]
    layers = [{ depth = 0.0, count = 30 }, { depth = 0.5, count = 12 }]
    [[wall]]
    side = "y+"
    velocity = [1.0, 0.0]
    layers = [{ depth = 0.0, count = 30 }, { depth = 0.5, count = 12 }]
    [[body]]
    name = "disk"
    shape = "disk"
    radius = 0.3
    positions = [{ at = [2.0, 3.0] }]
    [[molecule]]
    name = "triangle"
    shape = "simplex"
    spacing = 0.25
    species = "bead"
    H = 1000.0
    count = 2
  )",
                                          "everything", {"fluid.mass=" + std::to_string(mass)});
  return odpd::read_scene_settings<2>(config);
}

/// A fluid at rest with a free body, for kinds that a wall stops.
odpd::SceneSettings<2> at_rest(double mass = 0.0, const std::string& kT = "1.0") {
  const Config config =
      Config::from_text(R"(
    [box]
    size = [6.0, 6.0]
    periodic = [true, true]
    [fluid]
    density = 4.0
    kT = 1.0
    a = 18.5
    gamma = 4.5
    [[body]]
    name = "disk"
    shape = "disk"
    radius = 0.3
    positions = [{ at = [2.0, 3.0] }]
  )",
                        "at rest", {"fluid.mass=" + std::to_string(mass), "fluid.kT=" + kT});
  return odpd::read_scene_settings<2>(config);
}

std::vector<std::string> names(const Results& results) {
  std::vector<std::string> list;
  for (const auto& scalar : results.scalars) list.push_back(scalar.name);
  return list;
}

/// A run of it.
struct WholeRun {
  explicit WholeRun(const odpd::SceneSettings<2>& settings = everything())
      : scene(settings),
        dynamics(scene.box(), scene.particles(), scene.model(), scene,
                 odpd::make_solver({.name = "pcg", .tolerance = 1e-5}), {.seed = 3}),
        integrator(odpd::make_integrator<2>("trapezoidal")) {}

  /// The one observer of these keys besides those that are always there.
  std::unique_ptr<Observer<2>> make(const std::string& text,
                                    const std::vector<ObserverKind<2>>& own = {}) const {
    const Config config = Config::from_text("[[observe]]\n" + text, "case.toml");
    Observers observers =
        odpd::make_observers<2>(config, scene, clock, odpd::integrator_traits("trapezoidal"), own);
    config.reject_unread();
    return std::move(observers.front());
  }
  void run(std::int64_t steps, const std::vector<Observer<2>*>& looking) {
    for (std::int64_t k = 0; k < steps; ++k) {
      const auto& record = integrator->step(dynamics, clock);
      clock.advance();
      for (Observer<2>* observer : looking)
        if (observer->is_due(clock)) observer->measure(clock, scene.particles(), record);
    }
  }

  Scene<2> scene;
  odpd::Dynamics<2> dynamics;
  std::unique_ptr<odpd::Integrator<2>> integrator;
  odpd::Clock clock{.dt = 0.04, .total_steps = 200};
};

/// Observers of these keys, each beginning with the line of its kind, in two runs of a scene, the second from the middle of the
/// first. Long enough for all: the longest windows are 3 time units.
void expect_named_and_continued(const odpd::SceneSettings<2>& settings,
                                const std::vector<std::string>& keys) {
  WholeRun first(settings), restarted(settings);
  Observers through, continued;
  std::vector<std::vector<std::string>> promised;
  for (const std::string& text : keys) {
    SCOPED_TRACE(text);
    through.push_back(first.make(text));
    continued.push_back(restarted.make(text));
    const Results before = records::results(*through.back());
    promised.push_back(names(before));
    EXPECT_EQ(text.find("kind = \"" + through.back()->settings().kind + "\"\n"), 0u);
    EXPECT_TRUE(before.tables.empty() && before.charts.empty()) << "nothing was measured yet";
    for (const auto& scalar : before.scalars) EXPECT_TRUE(std::isnan(scalar.mean)) << scalar.name;
    support::expect_error<odpd::ConfigError>([&] { first.make(text + "no_such_key = 1\n"); },
                                             {"no_such_key"});
  }
  const auto all = [](const Observers& observers) {
    std::vector<Observer<2>*> list;
    for (const auto& observer : observers) list.push_back(observer.get());
    return list;
  };
  first.run(51, all(through));
  support::MemoryArchive particles;
  first.scene.particles().save(particles);
  restarted.scene.particles().load(particles);
  restarted.dynamics.particles_replaced();
  restarted.clock = first.clock;
  for (std::size_t k = 0; k < through.size(); ++k) {
    support::MemoryArchive archive;
    through[k]->save(archive);
    continued[k]->load(archive);
  }
  first.run(100, all(through));
  restarted.run(100, all(continued));
  for (std::size_t k = 0; k < through.size(); ++k) {
    SCOPED_TRACE(keys[k]);
    const Results one = records::results(*through[k]), other = records::results(*continued[k]);
    EXPECT_EQ(names(one), promised[k]);
    EXPECT_TRUE(std::any_of(one.scalars.begin(), one.scalars.end(),
                            [](const auto& s) { return std::isfinite(s.mean); }) ||
                !one.tables.empty());
    for (std::size_t s = 0; s < one.scalars.size(); ++s) {
      const auto &a = one.scalars[s], &b = other.scalars[s];
      EXPECT_TRUE(a.mean == b.mean || (std::isnan(a.mean) && std::isnan(b.mean))) << a.name;
      EXPECT_TRUE(a.standard_error == b.standard_error ||
                  (std::isnan(a.standard_error) && std::isnan(b.standard_error)))
          << a.name;
      EXPECT_TRUE(a.has_error || !(a.standard_error > 0.0)) << a.name;
    }
    const auto row = through[k]->series_row();
    EXPECT_EQ(row, continued[k]->series_row());
    EXPECT_TRUE(row.empty() || row.size() == through[k]->series_columns().size());
  }
}

TEST(EveryKind, NamesWhatItGivesAndContinues) {
  std::vector<std::string> keys;
  for (const ObserverKind<2>& kind : odpd::observer_kinds<2>())
    if (const std::vector<std::string> others{"modes", "velocities", "wave", "surface-tension",
                                              "drop", "high-frequency-viscosity", "rotation"};
        std::find(others.begin(), others.end(), kind.name) == others.end())
      keys.push_back("kind = \"" + kind.name + "\"\n");
  expect_named_and_continued(everything(), keys);
  expect_named_and_continued(everything(1.0), {"kind = \"velocities\"\n"});
  odpd::SceneSettings<2> plain = at_rest();
  plain.bodies.clear();
  expect_named_and_continued(
      plain, {"kind = \"surface-tension\"\n", "kind = \"drop\"\ncore = 1.0\nevery = 2\n"});
  odpd::SceneSettings<2> spinning = at_rest();
  spinning.species = {{.name = "fluid", .fraction = 0.7, .lever_radius = 0.3},
                      {.name = "still", .fraction = 0.3}};
  spinning.model = odpd::make_dpd<2>({.gamma_perp = 2.0}, 2);
  expect_named_and_continued(spinning, {"kind = \"rotation\"\nwindow = 0.5\n"});
  support::expect_error<odpd::ConfigError>(
      [&] { WholeRun(at_rest()).make("kind = \"rotation\"\n"); }, {"kind", "lever_radius"});
  support::expect_error<odpd::ConfigError>(
      [&] { WholeRun(spinning).make("kind = \"rotation\"\nevery = 2\n"); },
      {"every", "every step"});
  const std::string modes = "kind = \"modes\"\nnumbers = [1, 3]\nwindow = 0.6\n";
  expect_named_and_continued(at_rest(), {modes, modes + "control = true\n",
                                         modes + "control = true\ncontrol_every = 3\n"});
  expect_named_and_continued(at_rest(1.0),
                             {"kind = \"modes\"\nnumbers = [1, 3]\n", modes + "every = 2\n"});
  const std::string bodies = "kind = \"bodies\"\nwindow = 0.6\ncontrol = true\n";
  expect_named_and_continued(at_rest(), {bodies, bodies + "control_every = 3\n"});
  expect_named_and_continued(
      at_rest(), {"kind = \"high-frequency-viscosity\"\nevery = 10\nplanes = [\"yx\"]\n",
                  "kind = \"mobility\"\nevery = 10\nloads = \"random\"\ncollective = true\n"});
  auto forced = at_rest(), decaying = at_rest(1.0);
  forced.force_wave = decaying.start_wave = {.along = 1, .number = 1};
  forced.body_force = decaying.start_velocity = {{1.0, 0.0}};
  expect_named_and_continued(forced, {"kind = \"wave\"\n"});
  expect_named_and_continued(decaying, {"kind = \"wave\"\nevery = 2\n"});
}

class Registry : public ::testing::Test, protected WholeRun {};

/// Mean speed of the free particles times a factor: one constructor, one function.
class MeanSpeed : public Observer<2> {
 public:
  MeanSpeed(odpd::ObserverSettings settings, double factor)
      : Observer<2>(std::move(settings), {"mean", "largest"}), factor_(factor) {}
  void measure(const odpd::Clock&, const odpd::Particles<2>& particles,
               const odpd::StepRecord<2>& record) override {
    double sum = 0.0, largest = 0.0;
    for (std::size_t i = 0; i < record.v_mid.size(); ++i) {
      if (!particles.is_free(i)) continue;
      sum += factor_ * norm(record.v_mid[i]);
      largest = std::max(largest, factor_ * norm(record.v_mid[i]));
    }
    add({sum / static_cast<double>(particles.free_count()), largest});
  }

 private:
  double factor_;
};

TEST_F(Registry, TakesKindsOfAUser) {
  const std::vector<ObserverKind<2>> own{
      {.name = "mean-speed", .make = [](const ObserverEntry<2>& entry) {
         auto settings = entry.settings(2);
         return std::make_unique<MeanSpeed>(settings, entry.config.positive("factor", 1.0));
       }}};
  const auto plain = make("kind = \"mean-speed\"\n", own);
  const auto tenfold = make("kind = \"mean-speed\"\nname = \"u\"\nfactor = 10.0\n", own);
  EXPECT_EQ(names(records::results(*tenfold)), (std::vector<std::string>{"u.mean", "u.largest"}));
  run(40, {plain.get(), tenfold.get()});
  const Results one = records::results(*plain), ten = records::results(*tenfold);
  EXPECT_GT(records::mean(one, "mean-speed.mean"), 0.0);
  EXPECT_NEAR(records::mean(ten, "u.mean"), 10.0 * records::mean(one, "mean-speed.mean"), 1e-10);
  EXPECT_GT(records::error(ten, "u.largest"), 0.0);
  EXPECT_EQ(tenfold->series_columns(), (std::vector<std::string>{"mean", "largest"}));
  EXPECT_EQ(tenfold->series_row().size(), 2u);
  support::MemoryArchive archive;
  plain->save(archive);
  const auto copy = make("kind = \"mean-speed\"\n", own);
  copy->load(archive);
  EXPECT_EQ(records::error(records::results(*copy), "mean-speed.mean"),
            records::error(one, "mean-speed.mean"));
  support::expect_error<odpd::ConfigError>([&] { make("kind = \"mean-speed\"\n"); },
                                           {"kind", "mean-speed", "profile"});
  support::expect_error<odpd::ConfigError>(
      [&] {
        make("kind = \"mean-speed\"\n", {own[0], own[0]});
      },
      {"already", "mean-speed"});
}

// Two runs with the same forces and next to no noise, one with a force on the body: the difference of the velocities is the force times what
// control finds without one. The opposite force is on the fluid alone, that of control on all particles.
TEST(BodiesWithControl, FrozenMobilityIsVelocityPerForce) {
  constexpr double force = 10.0;
  auto settings = at_rest(0.0, "1e-12");
  WholeRun calm(settings);
  settings.bodies[0].load.force = {{force, 0.0}};
  WholeRun pushed(settings);
  calm.clock.dt = pushed.clock.dt = 1e-4;
  const auto observer = calm.make(
      "kind = \"bodies\"\nwindow = 1e-3\ncontrol = true\ncontrol_tolerance = 1e-6\ndirections = "
      "[\"x\"]\n");
  calm.run(12, {observer.get()});
  pushed.run(12, {});
  const auto mean_speed = [](WholeRun& run) {
    const auto& record = run.integrator->step(run.dynamics, run.clock);
    double sum = 0.0, members = 0.0;
    for (std::size_t i = 0; i < record.v_mid.size(); ++i) {
      if (run.scene.particles().is_free(i)) continue;
      sum += record.v_mid[i][0];
      members += 1.0;
    }
    return std::pair(sum / members, members / static_cast<double>(record.v_mid.size()));
  };
  const auto [with, share] = mean_speed(pushed);
  const double mobility = (with - mean_speed(calm).first) / force * (1.0 - share);
  EXPECT_GT(mobility, 0.01);
  EXPECT_NEAR(records::mean(records::results(*observer), "bodies.disk.frozen_mobility"), mobility,
              0.01 * mobility);
}

TEST(Results, ObjectToWhatNobodyMeasures) {
  Results results;
  results.scalars = {{"pressure"}, {"profile.slope"}, {"profile.bulk_density"}};
  EXPECT_EQ(results.objection("profile.slope"), "");
  const auto objects = [&](const char* name, std::initializer_list<const char*> parts) {
    for (const char* part : parts)
      EXPECT_NE(results.objection(name).find(part), std::string::npos) << results.objection(name);
  };
  objects("presure", {"'presure'", "did you mean 'pressure'", "one of pressure, profile"});
  objects("profile.slop", {"did you mean 'profile.slope'", "profile.bulk_density"});
  objects("wall.y-.x", {"'wall.y-.x'", "one of pressure, profile"});
}

}  // namespace
