// What frozen configurations answer to loads, against the dense matrix P^T R P and against dashpots in series.
#include <gtest/gtest.h>

#include <cmath>

#include "frozen_steps.h"
#include "odpd/analysis/high_frequency_viscosity.h"
#include "odpd/analysis/mobility.h"
#include "odpd/analysis/registry.h"
#include "records.h"
#include "support/dimensions.h"
#include "support/errors.h"
#include "support/simplex.h"

namespace {

using odpd::HighFrequencyViscosity;
using odpd::index;
using odpd::Mobility;
using odpd::MobilitySettings;
using odpd::Scene;
using odpd::Vec;

using frozen_steps::body_of;
using frozen_steps::OneStep;
using frozen_steps::some_fluid;

/// Of friction alone, measured at the same step several times.
template <int D>
odpd::Results measured(OneStep<D>& step, MobilitySettings settings, std::int64_t times = 1) {
  settings.incompressible = false;
  Mobility<D> mobility({.kind = "mobility", .name = "m"}, settings, step.scene);
  for (std::int64_t t = 0; t < times; ++t) {
    step.record.step = t;
    mobility.measure(odpd::Clock{}, step.scene.particles(), step.record);
  }
  return records::results(mobility);
}

template <class T>
class MobilityTest : public ::testing::Test {};
TYPED_TEST_SUITE(MobilityTest, support::Dimensions);

// Unit loads on two bodies and, within the spread of what they feel of each other, random ones on both and unit ones on either. A
// loose tolerance does: its error counts squared.
TYPED_TEST(MobilityTest, OfBodiesIsThatOfTheDenseMatrix) {
  constexpr int D = TypeParam::D;
  constexpr int turns = odpd::rotation_components<D>;
  auto settings = some_fluid<D>();
  settings.bodies = {body_of<D>(support::simplex_body<D>().frame, 2)};
  OneStep<D> step(settings);
  double translation = 0.0, rotation = 0.0, collective = 0.0;
  std::array<double, D> component{};
  for (std::size_t c = 0; c < D; ++c) {
    for (const std::size_t b : {0, 1}) component[c] += 0.5 * step.of_bodies({b}, c, false);
    translation += component[c] / D;
    collective += step.of_bodies({0, 1}, c, false) / (2.0 * D);
  }
  for (std::size_t c = 0; c < turns; ++c)
    for (const std::size_t b : {0, 1}) rotation += step.of_bodies({b}, c, true) / (2.0 * turns);
  EXPECT_GT(std::abs(collective / translation - 1.0), 0.05);
  for (const double tolerance : {1e-10, 0.1}) {
    SCOPED_TRACE(tolerance);
    const auto results = measured<D>(
        step, {.bodies = {0}, .molecules = {}, .collective = true, .tolerance = tolerance});
    const double bound = tolerance < 0.01 ? 1e-8 : 0.02;
    EXPECT_NEAR(records::mean(results, "m.body.translation"), translation, bound * translation);
    EXPECT_NEAR(records::mean(results, "m.body.translation.y"), component[1], bound * component[1]);
    EXPECT_NEAR(records::mean(results, "m.body.rotation"), rotation, bound * rotation);
    EXPECT_NEAR(records::mean(results, "m.body.collective"), collective, bound * collective);
  }
  for (const bool random : {false, true}) {
    SCOPED_TRACE(random);
    const auto results = measured<D>(
        step,
        {.bodies = {0}, .molecules = {}, .sample = 1, .random_loads = random, .tolerance = 1e-4},
        256);
    for (const auto& [name, exact] :
         {std::pair{"m.body.translation", translation}, std::pair{"m.body.rotation", rotation}}) {
      const double error = records::error(results, name);
      EXPECT_GT(error, 1e-5 * exact) << name;
      EXPECT_LT(error, 0.04 * exact) << name;
      EXPECT_NEAR(records::mean(results, name), exact, 4.0 * error) << name;
    }
  }
}

// Bodies of known volume v take of the opposite force as much as the fluid in their place, n v = v (N - 2 p)/(V - 2 v), instead of as many
// as their particles p. On all of them alike the forces on bodies and on the fluid are those of before but for a factor.
TYPED_TEST(MobilityTest, OppositeForceGoesByVolumeWhereItIsKnown) {
  constexpr int D = TypeParam::D;
  auto settings = some_fluid<D>();
  settings.bodies = {body_of<D>(support::simplex_body<D>().frame, 2)};
  const MobilitySettings wanted{
      .bodies = {0}, .molecules = {}, .collective = true, .tolerance = 1e-10};
  OneStep<D> step(settings);
  const auto by_particles = measured<D>(step, wanted);
  const auto p = static_cast<double>(settings.bodies[0].shape.size());
  const auto fluid = static_cast<double>(settings.count);
  const double volume = settings.box.volume(), excluded = 0.1 * volume;
  settings.bodies[0].excluded_volume = excluded;
  OneStep<D> known(settings);
  const auto by_volume = measured<D>(known, wanted);
  const double factor = (1.0 - 2.0 * excluded / volume) / (1.0 - 2.0 * p / (fluid + 2.0 * p));
  EXPECT_GT(std::abs(factor - 1.0), 0.01);
  const double collective = records::mean(by_particles, "m.body.collective") * factor * factor;
  EXPECT_NEAR(records::mean(by_volume, "m.body.collective"), collective, 1e-8 * collective);

  const double all = fluid / (1.0 - 2.0 * excluded / volume);  // as fluid of the whole box
  double translation = 0.0;
  for (std::size_t c = 0; c < D; ++c)
    for (const std::int32_t body : {0, 1})
      translation += known.answer(known.of_forces([&](std::size_t i) {
        const std::int32_t b = known.scene.particles().body_of(i);
        Vec<D> f{};
        f.x[c] = (b == body ? 1.0 / p : 0.0) - (b < 0 ? 1.0 : excluded / volume * all / p) / all;
        return f;
      }));
  EXPECT_NEAR(records::mean(by_volume, "m.body.translation"), translation / (2.0 * D),
              1e-8 * translation);
}

// Two colloids that are one particle each and spin.
template <int D>
odpd::SceneSettings<D> fluid_with_spinning_particles() {
  auto settings = some_fluid<D>();
  settings.species = {{.name = "fluid"}, {.name = "ball", .fraction = 0.0, .lever_radius = 0.5}};
  settings.model = odpd::make_dpd<D>({.a = 5.0, .gamma = 3.0, .gamma_perp = 1.0, .cutoff = 1.0}, 2);
  odpd::MoleculeSettings<D> ball;
  ball.name = "ball";
  ball.shape = {Vec<D>{}};
  ball.species = {1};
  ball.count = 2;
  settings.molecules = {ball};
  return settings;
}

// The angular velocity that a torque on the particle itself gives it.
TYPED_TEST(MobilityTest, OfAParticleThatSpinsIsThatOfATorqueOnIt) {
  constexpr int D = TypeParam::D;
  constexpr int turns = odpd::rotation_components<D>;
  OneStep<D> step(fluid_with_spinning_particles<D>());
  const auto n = step.record.start.position.size();
  double rotation = 0.0, component = 0.0, both = 0.0;
  const auto index_of = step.scene.particles().index_of_id();
  const std::array balls{index(index_of[n - 2]), index(index_of[n - 1])};
  for (const std::size_t ball : balls)
    for (int c = 0; c < turns; ++c) {
      odpd::ParticleLoads<D> loads{std::vector<Vec<D>>(n), std::vector<Vec<D>>(n)};
      loads.torque[ball][c] = 1.0;
      const auto motions = step.record.respond(loads, 1e-12);
      rotation += motions.spin[ball][c] / (2.0 * turns);
      both += motions.spin[balls[ball == balls[0] ? 1 : 0]][c];
      if (c == 0) component += 0.5 * motions.spin[ball][c];
    }
  ASSERT_GT(rotation, 0.0);
  const auto results = measured<D>(step, {.bodies = {}, .molecules = {0}, .tolerance = 1e-10});
  EXPECT_NEAR(records::mean(results, "m.ball.rotation"), rotation, 1e-8 * rotation);
  if (D == 3) {
    EXPECT_NEAR(records::mean(results, "m.ball.rotation.x"), component, 1e-8 * component);
  }
  const auto random = measured<D>(
      step, {.bodies = {}, .molecules = {0}, .random_loads = true, .tolerance = 1e-6}, 64);
  EXPECT_NEAR(records::mean(random, "m.ball.rotation"), rotation,
              1e-6 * rotation + std::abs(both) / turns);
}

// One pressure everywhere pushes nobody, and turns nobody.
TYPED_TEST(MobilityTest, EvenPressureDoesNotTurnParticles) {
  constexpr int D = TypeParam::D;
  OneStep<D> step(fluid_with_spinning_particles<D>());
  const odpd::FrozenPressure<D> pressure(step.scene.particles(), step.record,
                                         odpd::pressure_range(step.scene), 1.0, 1e-11);
  const odpd::ParticleLoads<D> loads = pressure.push(std::vector<double>(pressure.nodes(), 1.0));
  double most = 0.0;
  for (std::size_t i = 0; i < loads.force.size(); ++i)
    most = std::max({most, norm(loads.force[i]), norm(loads.torque[i])});
  EXPECT_LT(most, 1e-7);
  std::vector<double> uneven(pressure.nodes(), 0.0);
  uneven[0] = 1.0;
  most = 0.0;
  for (const Vec<D>& t : pressure.push(uneven).torque) most = std::max(most, norm(t));
  EXPECT_GT(most, 1e-4);
}

// A dimer across a corner of the box: forces of half each on its beads, and opposite ones across its line.
TYPED_TEST(MobilityTest, OfMoleculesIsThatOfTheDenseMatrix) {
  constexpr int D = TypeParam::D;
  auto settings = some_fluid<D>();
  odpd::MoleculeSettings<D> dimer;
  dimer.name = "dimer";
  Vec<D> half{};
  half[0] = half[1] = 0.25;
  dimer.shape = {half, -1.0 * half};
  dimer.species = {0, 0};
  dimer.bonds = {{.i = 0, .j = 1, .p = {.H = 100.0, .r_0 = 0.7}}};
  dimer.positions = {Vec<D>{}};
  settings.molecules = {dimer};
  OneStep<D> step(settings);
  const auto first = step.scene.molecules()[0].first;
  const auto index_of = step.scene.particles().index_of_id();
  const auto one = index(index_of[index(first)]), two = index(index_of[index(first) + 1]);
  const Vec<D> r =
      step.scene.box().separation(step.record.start.position[one], step.record.start.position[two]);
  const auto mean_of = [&](std::size_t directions, const auto& load) {
    double sum = 0.0;
    for (std::size_t c = 0; c < directions; ++c)
      sum += step.answer(step.of_forces([&](std::size_t i) {
        return i == one ? load(c, 1.0) : i == two ? load(c, -1.0) : Vec<D>{};
      }));
    return sum / static_cast<double>(directions);
  };
  const double translation = mean_of(D, [](std::size_t c, double) {
    Vec<D> f{};
    f.x[c] = 0.5;
    return f;
  });
  // Directions across r, and across the one before.
  std::vector<Vec<D>> across;
  for (int c = 0; c + 1 < D; ++c) {
    Vec<D> n{};
    n[c + 1] = 1.0;
    n -= dot(n, r) / dot(r, r) * r;
    for (const Vec<D>& other : across) n -= dot(n, other) * other;
    across.push_back(1.0 / norm(n) * n);
  }
  const double rotation =
      mean_of(D - 1, [&](std::size_t c, double sign) { return sign / norm(r) * across[c]; });
  const auto results = measured<D>(step, {.bodies = {}, .molecules = {0}, .tolerance = 1e-10});
  EXPECT_NEAR(records::mean(results, "m.dimer.translation"), translation, 1e-8 * translation);
  EXPECT_NEAR(records::mean(results, "m.dimer.rotation"), rotation, 1e-8 * rotation);
}

// Along the axes of a rod, wherever it points: it has no rotation about its line, and the two across are alike by trace.
TEST(MobilityOfARod, HasItsOwnAxes) {
  auto settings = some_fluid<3>();
  settings.bodies = {body_of<3>({{{-0.5, 0.0, 0.0}}, {{0.0, 0.0, 0.0}}, {{0.5, 0.0, 0.0}}}, 1)};
  OneStep<3> step(settings);
  const Vec<3> line = step.scene.particles().bodies[0].pose.orientation.turn({{1.0, 0.0, 0.0}});
  ASSERT_LT(std::abs(line[0]), 0.95);
  MobilitySettings wanted{.bodies = {0}, .molecules = {}, .tolerance = 1e-10};
  const auto space = measured<3>(step, wanted);
  wanted.own_axes = true;
  const auto own = measured<3>(step, wanted);
  const auto mean = [](const odpd::Results& results, const std::string& name) {
    return records::mean(results, "m.body." + name);
  };
  for (const char* what : {"translation", "rotation"})
    EXPECT_NEAR(mean(own, what), mean(space, what), 1e-8 * mean(space, what));
  EXPECT_TRUE(std::isnan(mean(own, "rotation.x")));
  EXPECT_NEAR(mean(own, "rotation"), 0.5 * (mean(own, "rotation.y") + mean(own, "rotation.z")),
              1e-12);
  // e . mu e of its line, from the dense matrix.
  std::vector<Vec<3>> arms;
  for (const std::int32_t p : step.dynamics.dofs().constituents(0))
    arms.push_back(step.record.start.arms[index(p)]);
  const Vec<3> e = 1.0 / norm(arms[2]) * arms[2];
  std::vector<double> force(step.matrix.size(), 0.0), spin(force);
  for (std::size_t c = 0; c < 3; ++c) {
    force[step.dynamics.dofs().body_node(0) * 3 + c] = e.x[c];
    spin[c] = e.x[c];
  }
  step.nulls.push_back(spin);
  const double along = step.answer(force);
  EXPECT_NEAR(mean(own, "translation.x"), along, 1e-8 * along);
  EXPECT_GT(std::abs(mean(space, "translation.x") - along), 1e-3 * along);
}

// One along an axis of space does not turn about it, which is a mobility of 0 along this axis and no undefined mean.
TEST(MobilityOfARod, DoesNotTurnAboutItsLine) {
  auto settings = some_fluid<3>();
  settings.bodies = {body_of<3>({{{-0.5, 0.0, 0.0}}, {{0.0, 0.0, 0.0}}, {{0.5, 0.0, 0.0}}}, 1)};
  settings.bodies[0].positions = {support::uniform_vec<3>(1.1)};
  OneStep<3> step(settings);
  const auto results = measured<3>(step, {.bodies = {0}, .molecules = {}, .tolerance = 1e-10});
  const auto mean = [&](const std::string& axis) {
    return records::mean(results, "m.body.rotation" + axis);
  };
  EXPECT_EQ(mean(".x"), 0.0);
  EXPECT_GT(mean(".y"), 0.0);
  EXPECT_NEAR(mean(""), 0.5 * (mean(".y") + mean(".z")), 1e-12);
}

/// Particles on the diagonal of the xy plane, a ring through the corner of the box.
template <int D>
odpd::SceneSettings<D> ring() {
  std::vector<Vec<D>> r;
  for (const double x : {0.1, 0.5, 1.1, 1.5}) {
    r.push_back(support::uniform_vec<D>(0.3));
    r.back()[0] = r.back()[1] = x;
  }
  auto s = records::periodic<D>(2.0, r);
  s.model =
      odpd::make_dpd<D>({.a = 0.0, .gamma = 2.0, .gamma_perp = 1.0, .s = 1.0, .cutoff = 0.95});
  return s;
}

template <int D>
odpd::Results flown(OneStep<D>& step) {
  HighFrequencyViscosity<D> eta(
      {.kind = "high-frequency-viscosity", .name = "h"},
      {.planes = {{0, 1}, {1, 0}}, .incompressible = false, .tolerance = 1e-10}, step.scene);
  eta.measure(odpd::Clock{}, step.scene.particles(), step.record);
  return records::results(eta);
}

// The slips along and across the ring, r/2 of each edge in either plane, are those of dashpots in series: the same force in all, so that
// V eta is the square of their sum, 1/2 of the diagonal 2 sqrt 2, over the sum of 1/zeta. Equal forces are not equal slips: particles
// that did not give way would dissipate more.
TYPED_TEST(MobilityTest, HighFrequencyViscosityIsThatOfDashpotsInSeries) {
  constexpr int D = TypeParam::D;
  OneStep<D> step(ring<D>());
  const auto& network = step.record.start.network;
  ASSERT_EQ(network.size(), 4);
  double along = 0.0, across = 0.0, stiff = 0.0;
  for (std::size_t k = 0; k < 4; ++k) {
    along += 1.0 / network.zeta_par[k];
    across += 1.0 / network.zeta_perp[k];
    stiff += 0.25 * network.r[k] * network.r[k] * (network.zeta_par[k] + network.zeta_perp[k]);
  }
  const double exact = (2.0 / along + 2.0 / across) / std::pow(2.0, D);
  EXPECT_GT(stiff / std::pow(2.0, D), 1.05 * exact);
  const auto results = flown(step);
  for (const char* name : {"h.eta", "h.xy", "h.yx"})
    EXPECT_NEAR(records::mean(results, name), exact, 1e-8 * exact) << name;
}

// Two of them a rigid body, that turns: it opens the ring for slips across, and a part of the slip along falls on its length, where
// nothing gives way.
TYPED_TEST(MobilityTest, HighFrequencyViscosityOfARigidPair) {
  constexpr int D = TypeParam::D;
  auto s = ring<D>();
  Vec<D> half{};
  half[0] = half[1] = 0.2;
  odpd::BodySettings<D> body = body_of<D>({half, -1.0 * half}, 1);
  body.positions = {0.5 * (s.start_positions[0] + s.start_positions[1])};
  s.bodies = {body};
  s.start_positions.erase(s.start_positions.begin(), s.start_positions.begin() + 2);
  OneStep<D> step(s);
  const auto& network = step.record.start.network;
  ASSERT_EQ(network.size(), 3);
  double along = 0.0;
  for (std::size_t k = 0; k < 3; ++k) along += 1.0 / network.zeta_par[k];
  const double exact = 2.0 / along / std::pow(2.0, D);
  EXPECT_NEAR(records::mean(flown(step), "h.xy"), exact, 1e-8 * exact);
}

TEST(FrozenAnswers, RefuseWhatTheyCannotTell) {
  const auto refused = [](const odpd::SceneSettings<2>& s, const std::string& keys,
                          std::initializer_list<const char*> parts,
                          const char* integrator = "trapezoidal") {
    const Scene<2> scene(s);
    const odpd::Config config = odpd::Config::from_text("[[observe]]\n" + keys, "case.toml");
    support::expect_error<odpd::ConfigError>(
        [&] {
          odpd::make_observers<2>(config, scene, odpd::Clock{.dt = 0.02},
                                  odpd::integrator_traits(integrator));
        },
        parts);
  };
  auto s = some_fluid<2>();
  const std::string mobility = "kind = \"mobility\"\n",
                    viscosity = "kind = \"high-frequency-viscosity\"\n";
  refused(s, mobility, {"case.toml:2", "kind", "[[body]]", "[[molecule]]"});
  s.bodies = {body_of<2>(support::simplex_body<2>().frame, 1)};
  auto heavy = s, dragged = s, held = s;
  heavy.mass = 1.0;
  dragged.zeta_0 = 0.1;
  held.bodies[0].motion = odpd::BodyMotion::fixed;
  refused(heavy, mobility, {"kind", "fluid.mass = 0"});
  refused(heavy, viscosity, {"kind", "fluid.mass = 0"});
  refused(s, mobility, {"kind", "'trapezoidal' or 'midpoint'"}, "euler");
  refused(s, viscosity, {"kind", "'trapezoidal' or 'midpoint'"}, "euler");
  refused(held, mobility, {"kind", "free [[body]]"});
  refused(held, viscosity, {"kind", "held"});
  refused(dragged, viscosity, {"kind", "zeta_0"});
  auto dry = s;
  dry.count = 0;
  refused(dry, mobility, {"kind", "no particle is free", "incompressible = false"});
  refused(dry, mobility + "incompressible = true\n",
          {"case.toml:3", "incompressible", "no particle is free"});
  refused(s, mobility + "of = [\"ball\"]\n", {"case.toml:3", "of", "'ball'", "body"});
  refused(s, mobility + "of = []\n", {"of", "at least one"});
  refused(s, mobility + "loads = \"random\"\nsample = 2\n", {"case.toml:4", "sample", "unit"});
  refused(s, mobility + "tolerance = 1.5\n", {"tolerance", "less than 1"});
  refused(s, viscosity + "planes = [\"xx\"]\n", {"case.toml:3", "planes", "'xx'", "xy, yx"});
  refused(s, viscosity + "planes = [\"xy\", \"xy\"]\n", {"planes", "twice"});
  refused(s, viscosity + "planes = []\n", {"planes", "at least one"});
  odpd::MoleculeSettings<2> bead;
  bead.name = "body";
  bead.shape = {Vec<2>{}};
  bead.species = {0};
  s.molecules = {bead};
  refused(s, mobility, {"of", "'body'", "name of its own"});
  s.molecules[0].name = "bead";
  refused(s, mobility + "axes = \"body\"\n", {"axes", "molecule", "of"});
}

// A solve for each load, with a pressure one for the configuration and some for each load; a sample of the bodies is no more than there are.
TEST(FrozenAnswers, TellTheirSolves) {
  auto s = some_fluid<2>();
  s.bodies = {body_of<2>(support::simplex_body<2>().frame, 2)};
  const Scene<2> scene(s);
  const auto solves = [&](const std::string& keys) {
    const odpd::Config config = odpd::Config::from_text("[[observe]]\n" + keys, "case.toml");
    return odpd::make_observers<2>(config, scene, odpd::Clock{.dt = 0.02},
                                   odpd::integrator_traits("trapezoidal"))
        .front()
        ->solves();
  };
  const std::string plain = "every = 10\nincompressible = false\n",
                    mobility = "kind = \"mobility\"\n" + plain,
                    viscosity = "kind = \"high-frequency-viscosity\"\n";
  EXPECT_DOUBLE_EQ(solves(mobility), 0.6);
  EXPECT_DOUBLE_EQ(solves(mobility + "sample = 1\ncollective = true\n"), 0.5);
  EXPECT_DOUBLE_EQ(solves(mobility + "loads = \"random\"\n"), 0.2);
  EXPECT_DOUBLE_EQ(solves(viscosity + plain), 0.1);
  EXPECT_DOUBLE_EQ(solves("kind = \"mobility\"\nevery = 10\n"),
                   0.1 + 0.6 * odpd::solves_with_pressure);
  EXPECT_DOUBLE_EQ(solves(viscosity + "every = 10\n"), 0.1 + 0.1 * odpd::solves_with_pressure);
}

}  // namespace
