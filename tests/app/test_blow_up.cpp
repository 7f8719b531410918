// What is judged a blow-up: configurations and velocities made for it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "odpd/app/blow_up.h"
#include "odpd/core/random.h"
#include "odpd/operator/edge_sums.h"
#include "odpd/pairs/dpd.h"
#include "odpd/pairs/levers.h"
#include "odpd/scene/fill.h"
#include "support/pair_functions.h"
#include "support/points.h"

namespace odpd {
namespace {

template <int D>
SceneSettings<D> box_of(StartKind start) {
  SceneSettings<D> s;
  for (int c = 0; c < D; ++c) s.box.size[c] = D == 2 ? 8.0 : 5.0;
  s.box.periodic.fill(true);
  s.start = start;
  s.relax_sweeps = 0;
  return s;
}

template <int D>
Stage<D> stage_of(const Scene<D>& scene) {
  Stage<D> stage;
  stage.position = scene.particles().position;
  PairList<D> list(scene.box(), scene.model().cutoff(), 0.0);
  list.update(stage.position);
  scene.model().write_edges(list, scene.box(), stage.position, scene.particles(), stage.network);
  stage.potential_force.resize(stage.position.size());
  add_conservative_forces(stage.network, stage.potential_force);
  return stage;
}

template <class T>
class BlowUp : public testing::Test {};
using Dimensions = testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;
TYPED_TEST_SUITE(BlowUp, Dimensions);

// Only the configurational temperature tells a random arrangement: its energy is that of the bound's unit.
TYPED_TEST(BlowUp, RandomArrangementAfterAnOrderedOne) {
  constexpr int D = TypeParam::value;
  Scene<D> scene(box_of<D>(StartKind::random));
  BlowUpWatch<D> watch(scene, 10.0);
  EXPECT_EQ(watch.judge(stage_of(scene), 0.01), "") << "an unrelaxed start is no blow-up";
  const std::vector<Vec<D>> random = scene.particles().position;
  relax<D>(scene.box(), scene.model(), scene, 200, scene.particles());
  EXPECT_EQ(watch.judge(stage_of(scene), 0.01), "");
  scene.particles().position = random;
  EXPECT_NE(watch.judge(stage_of(scene), 0.01).find("configurational temperature"),
            std::string::npos);
}

// Small random arrangements have a scatter that lets one in ten of them look ordered; an unrelaxed start goes through several.
TYPED_TEST(BlowUp, UnrelaxedSmallSystemsAreSound) {
  constexpr int D = TypeParam::value;
  SceneSettings<D> s = box_of<D>(StartKind::random);
  for (int c = 0; c < D; ++c) s.box.size[c] = D == 2 ? 4.5 : 2.7;
  for (std::uint64_t start = 0; start < 500; ++start) {
    s.seed = 4 * start + 1;
    Scene<D> scene(s);
    BlowUpWatch<D> watch(scene, 10.0);
    for (int k = 0; k < 4; ++k) {
      Stage<D> stage = stage_of(scene);
      stage.time = 0.02 * k;
      ASSERT_EQ(watch.judge(stage, 1e-4), "") << "start " << start << ", arrangement " << k;
      s.seed = 4 * start + 2 + static_cast<std::uint64_t>(k);
      scene.particles().position = Scene<D>(s).particles().position;
    }
  }
}

TYPED_TEST(BlowUp, EnergyOfParticlesPressedTogether) {
  constexpr int D = TypeParam::value;
  Scene<D> scene(box_of<D>(StartKind::lattice));
  BlowUpWatch<D> watch(scene, 10.0);
  EXPECT_EQ(watch.judge(stage_of(scene), 0.01), "");
  for (Vec<D>& r : scene.particles().position) r *= 0.1;
  EXPECT_NE(watch.judge(stage_of(scene), 0.01).find("energy per particle"), std::string::npos);
}

// What is told and judged is the energy of all that move, not of the only particle that is in no body.
TEST(BlowUpOfBodies, EnergyIsSharedByTheirParticles) {
  SceneSettings<2> s = box_of<2>(StartKind::file);
  s.start_positions = {{{7.5, 7.5}}};
  BodySettings<2> pair;
  pair.shape = {{{-0.1, 0.0}}, {{0.1, 0.0}}};
  pair.clearance = 0.0;
  for (int k = 0; k < 25; ++k)
    pair.positions.push_back({{0.5 + 1.4 * (k % 5), 0.5 + 1.4 * (k / 5)}});
  s.bodies = {pair};
  Scene<2> scene(s);
  BlowUpWatch<2> watch(scene, 10.0);
  EXPECT_EQ(watch.judge(stage_of(scene), 0.01), "");
  for (Vec<2>& r : scene.particles().position) r *= 0.1;
  const Stage<2> pressed = stage_of(scene);
  const std::string why = watch.judge(pressed, 0.01);
  EXPECT_NE(why.find(fmt::format("energy per particle, {:.4g},", pressed.network.energy() / 51.0)),
            std::string::npos)
      << why;
}

// Of a hard core the energy of a random arrangement diverges: the bound takes one of pairs that kT lets come near.
TYPED_TEST(BlowUp, HardCoresPressedTogether) {
  constexpr int D = TypeParam::value;
  SceneSettings<D> settings = box_of<D>(StartKind::lattice);
  settings.model = support::lennard_jones<D>(1.0, 1.0);
  Scene<D> scene(settings);
  BlowUpWatch<D> watch(scene, 10.0);
  EXPECT_EQ(watch.judge(stage_of(scene), 1e-4), "");
  std::vector<Vec<D>>& position = scene.particles().position;
  const std::vector<Vec<D>> lattice = position;
  // Half of them next to the others: u = 4 (2^12 - 2^6) kT or so, where a soft particle would not have noticed.
  for (std::size_t i = 0; i + 1 < position.size(); i += 2) {
    position[i] = position[i + 1];
    position[i][0] += 0.2;
    scene.box().wrap(position[i]);
  }
  EXPECT_NE(watch.judge(stage_of(scene), 1e-4).find("energy per particle"), std::string::npos);
  position = lattice;
  EXPECT_EQ(watch.judge(stage_of(scene), 1e-4), "");
}

// An unrelaxed start of hard cores has any energy: no bound, and the configurational temperature takes its place.
TYPED_TEST(BlowUp, HardCoresAfterAnUnrelaxedStart) {
  constexpr int D = TypeParam::value;
  SceneSettings<D> settings = box_of<D>(StartKind::random);
  settings.model = support::lennard_jones<D>(1.0, 1.0);
  Scene<D> scene(settings);
  BlowUpWatch<D> watch(scene, 10.0);
  const std::vector<Vec<D>> random = scene.particles().position;
  EXPECT_EQ(watch.judge(stage_of(scene), 1e-4), "") << "an unrelaxed start is no blow-up";
  relax<D>(scene.box(), scene.model(), scene, 2000, scene.particles());
  EXPECT_EQ(watch.judge(stage_of(scene), 1e-4), "");
  scene.particles().position = random;
  EXPECT_NE(watch.judge(stage_of(scene), 1e-4).find("configurational temperature"),
            std::string::npos);
}

// Attraction takes the energy of the start below zero, which is no scale.
TYPED_TEST(BlowUp, AttractiveStart) {
  constexpr int D = TypeParam::value;
  SceneSettings<D> settings = box_of<D>(StartKind::lattice);
  settings.model = support::lennard_jones<D>(5.0, 1.0);
  Scene<D> scene(settings);
  BlowUpWatch<D> watch(scene, 10.0);
  for (int k = 0; k < 2; ++k) EXPECT_EQ(watch.judge(stage_of(scene), 1e-4), "");
}

// A common velocity heats nobody; 30 times the thermal one of each does, where the energy of the start is small.
TYPED_TEST(BlowUp, VelocitiesRelativeToNeighbours) {
  constexpr int D = TypeParam::value;
  SceneSettings<D> settings = box_of<D>(StartKind::lattice);
  settings.mass = 0.01;
  settings.model = make_dpd<D>({.a = 1.0});
  Scene<D> scene(settings);
  Particles<D>& particles = scene.particles();
  particles.carry_inertia();
  BlowUpWatch<D> watch(scene, 10.0);
  const auto set = [&](double thermal, double common) {
    const CounterRandom random(3, Stream::probe);
    for (std::size_t i = 0; i < particles.end_velocity.size(); ++i)
      for (int c = 0; c < D; ++c)
        particles.end_velocity[i][c] =
            common + thermal * std::sqrt(1.0 / settings.mass) *
                         random.normal(i, 0, 0, static_cast<std::uint64_t>(c));
  };
  set(1.0, 0.0);
  EXPECT_EQ(watch.judge(stage_of(scene), 0.01), "");
  set(1.0, 1000.0);
  EXPECT_EQ(watch.judge(stage_of(scene), 0.01), "");
  set(30.0, 0.0);
  EXPECT_NE(watch.judge(stage_of(scene), 0.01).find("kinetic temperature"), std::string::npos);
}

// The same velocities are no blow-up where a body of that speed stirs the fluid.
TYPED_TEST(BlowUp, VelocitiesNextToAFastBody) {
  constexpr int D = TypeParam::value;
  for (const double speed : {0.0, 1e4}) {
    SceneSettings<D> settings = box_of<D>(StartKind::random);
    settings.mass = 0.01;
    settings.model = make_dpd<D>({.a = 1.0});
    BodySettings<D> body;
    body.shape = {Vec<D>{}};
    body.motion = BodyMotion::given;
    body.positions = {support::uniform_vec<D>(1.0)};
    body.velocity.velocity[0] = speed;
    settings.bodies = {body};
    Scene<D> scene(settings);
    Particles<D>& particles = scene.particles();
    particles.carry_inertia();
    BlowUpWatch<D> watch(scene, 10.0);
    for (std::size_t i = 0; i < particles.end_velocity.size(); ++i)
      particles.end_velocity[i][0] = i % 2 == 0 ? 500.0 : -500.0;
    const std::string judgement = watch.judge(stage_of(scene), 1e-6);
    EXPECT_EQ(judgement.find("kinetic temperature") != std::string::npos, speed == 0.0)
        << judgement;
  }
}

TYPED_TEST(BlowUp, JumpsOfNeighboursPastEachOther) {
  constexpr int D = TypeParam::value;
  Scene<D> scene(box_of<D>(StartKind::lattice));
  Particles<D>& particles = scene.particles();
  BlowUpWatch<D> watch(scene, 10.0);
  for (Vec<D>& v : particles.velocity) v[0] = 500.0;
  EXPECT_EQ(watch.judge(stage_of(scene), 0.01), "") << "all together";
  particles.velocity[7][0] = 1000.0;
  EXPECT_EQ(watch.judge(stage_of(scene), 0.01), "") << "one alone";
  EXPECT_EQ(watch.fastest(), particles.id[7]);
  for (std::size_t i = 0; i < particles.velocity.size(); ++i)
    particles.velocity[i][0] = 500.0 * static_cast<double>(particles.id[i] * 7 % 5);
  EXPECT_NE(watch.judge(stage_of(scene), 0.01).find("neighbours moved"), std::string::npos);
}

TEST(BlowUpCure, NamesTheLimitThatIsExceeded) {
  SceneSettings<2> settings = box_of<2>(StartKind::lattice);  // a = 18.5, gamma = 4.5
  Scene<2> scene(settings);
  const BlowUpWatch<2> watch(scene, 10.0);
  const Stage<2> stage = stage_of(scene);
  IntegratorSettings integrator;
  EXPECT_NE(watch.cure(integrator, stage, 0.5, -1).find("explicit repulsion"), std::string::npos);
  EXPECT_DOUBLE_EQ(watch.smaller_step(integrator, stage, 0.5), 0.048);
  EXPECT_DOUBLE_EQ(watch.smaller_step(integrator, stage, 0.02), 0.01);
  EXPECT_EQ(watch.cure(integrator, stage, 0.02, 0).find("rattler"), std::string::npos);
  integrator.name = "implicit";
  EXPECT_DOUBLE_EQ(watch.smaller_step(integrator, stage, 0.5), 0.25);
}

TEST(BlowUpCure, OfAnyModel) {
  SceneSettings<2> settings = box_of<2>(StartKind::lattice);
  settings.model = support::gaussian<2>(18.5, 0.3, 1.0);
  Scene<2> scene(settings);
  const BlowUpWatch<2> watch(scene, 10.0);
  // 0.2 gamma w/A = 0.01459
  EXPECT_DOUBLE_EQ(watch.smaller_step({}, stage_of(scene), 0.5), 0.014);
  EXPECT_NE(watch.cure({}, stage_of(scene), 0.5, -1).find("explicit repulsion"), std::string::npos);
  // Where the stiffness is not known, the step is halved.
  settings.model = support::lennard_jones<2>(1.0, 0.0);
  Scene<2> cold(settings);
  const BlowUpWatch<2> other(cold, 10.0);
  EXPECT_DOUBLE_EQ(other.smaller_step({}, stage_of(cold), 0.5), 0.25);
  EXPECT_EQ(other.cure({}, stage_of(cold), 0.5, -1).find("explicit repulsion"), std::string::npos);
}

TEST(BlowUpCure, InertiaOfExplicitFriction) {
  SceneSettings<2> settings = box_of<2>(StartKind::lattice);
  settings.mass = 0.01;
  Scene<2> scene(settings);
  const BlowUpWatch<2> watch(scene, 10.0);
  const Stage<2> stage = stage_of(scene);
  IntegratorSettings integrator;
  integrator.name = "velocity-verlet";
  double friction =
      0.0;  // mean over particles and directions: each edge acts on both ends along one of two directions
  for (const double zeta : stage.network.zeta_par) friction += zeta;
  friction /= static_cast<double>(scene.particles().size());
  const double limit = settings.mass / friction;
  EXPECT_NE(watch.cure(integrator, stage, 2.0 * limit, -1).find("m/(friction"), std::string::npos);
  EXPECT_EQ(watch.cure(integrator, stage, 0.9 * limit, -1).find("m/(friction"), std::string::npos);
}

// Of a spin it is I/(sum of l^2 zeta_perp), the smaller one where levers are long for the moment of inertia.
TEST(BlowUpCure, InertiaOfSpins) {
  SceneSettings<2> settings = box_of<2>(StartKind::lattice);
  settings.mass = 1.0;
  settings.model = make_dpd<2>({.gamma_perp = 3.0});
  IntegratorSettings integrator;
  integrator.name = "velocity-verlet";
  const auto limit = [&](double moment) {
    settings.species[0].lever_radius = 0.3;
    settings.species[0].moment = moment;
    Scene<2> scene(settings);
    Stage<2> stage = stage_of(scene);
    write_levers(scene.particles(), stage.network);
    const BlowUpWatch<2> watch(scene, 10.0);
    double friction = 0.0;  // of the one with most
    for (std::int64_t i = 0; i < scene.particles().size(); ++i) {
      double own = 0.0;  // the lever arm is half the distance
      for (const std::int32_t edge : stage.network.edges_of(i)) {
        const auto k = static_cast<std::size_t>(edge);
        own += 0.25 * stage.network.r[k] * stage.network.r[k] * stage.network.zeta_perp[k];
      }
      friction = std::max(friction, own);
    }
    const auto told = [&](double dt) {
      return watch.cure(integrator, stage, dt, -1).find("I/(friction of its spin)") !=
             std::string::npos;
    };
    EXPECT_TRUE(told(1.01 * moment / friction));
    EXPECT_EQ(told(0.99 * moment / friction), moment > 0.1);
  };
  limit(1e-3);
  limit(1e3);  // that of m, smaller by far
}

TEST(BlowUpCure, RattlersAreNamed) {
  SceneSettings<2> settings = box_of<2>(StartKind::lattice);
  settings.density = 0.2;
  Scene<2> scene(settings);
  const BlowUpWatch<2> watch(scene, 10.0);
  const std::string text = watch.cure({}, stage_of(scene), 0.01, 4);
  for (const char* word :
       {"rattler", "particle 4", "rattler_friction", "mass", "density", "zeta_0"})
    EXPECT_NE(text.find(word), std::string::npos) << word;
}

}  // namespace
}  // namespace odpd
