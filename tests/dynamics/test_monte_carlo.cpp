// Metropolis sampling: energies of trial moves, exact distributions of small systems, what is tuned and when, restart,
// and what it refuses.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>

#include "odpd/core/parallel.h"
#include "odpd/dynamics/monte_carlo.h"
#include "odpd/pairs/dpd.h"
#include "support/dimensions.h"
#include "support/errors.h"
#include "support/memory_archive.h"
#include "support/points.h"
#include "support/rods.h"

namespace odpd {
namespace {

// A harmonic trap along the last direction and a uniform force; walls of known velocity.
template <int D>
class Trap : public NoSurroundings<D> {
 public:
  using NoSurroundings<D>::NoSurroundings;
  double stiffness = 0.0;
  double centre = 0.0;
  Vec<D> force{};
  Vec<D> wall_velocity{};

  double potential_energy_at(const Vec<D>& r) const override {
    const double h = r[D - 1] - centre;
    return 0.5 * stiffness * h * h;
  }
  void add_driving_forces(const Particles<D>& particles, std::span<const Vec<D>>, double,
                          std::vector<Vec<D>>& out) const override {
    for (std::size_t i = 0; i < out.size(); ++i)
      if (particles.is_free(i)) out[i] += force;
  }
  Vec<D> known_velocity(odpd::Group, double) const override { return wall_velocity; }
};

// `count` particles at random places of a box with edges `edge`, bounded along the last direction.
template <int D>
struct Toy {
  Toy(double edge, std::int64_t count, DynamicsSettings settings = {}, DpdParameters pair = {})
      : model(1, {pair}), trap({.kT = pair.kT}) {
    box.size = support::uniform_vec<D>(edge);
    box.periodic.fill(true);
    box.periodic.back() = false;
    for (const Vec<D>& r : support::random_points<D>(
             Vec<D>{}, box.size, static_cast<std::size_t>(count), settings.seed))
      particles.add(r, 0);
    remake(settings);
  }
  void remake(const DynamicsSettings& settings) {
    dynamics =
        std::make_unique<Dynamics<D>>(box, particles, model, trap, make_solver({}), settings);
  }
  void run(MonteCarlo<D>& sampler, std::int64_t from, std::int64_t to,
           std::int64_t equilibration = 0) {
    for (Clock clock{.dt = 1.0, .step = from, .equilibration_steps = equilibration};
         clock.step < to; clock.advance())
      sampler.step(*dynamics, clock);
  }

  Box<D> box;
  Particles<D> particles;
  DpdModel<D> model;
  Trap<D> trap;
  std::unique_ptr<Dynamics<D>> dynamics;
};

template <int D>
double total_energy(Toy<D>& toy) {
  Stage<D> stage;
  toy.dynamics->evaluate(toy.particles.position, 0.0, stage);
  double energy = stage.network.energy();
  for (const Vec<D>& r : toy.particles.position) energy += toy.trap.potential_energy_at(r);
  return energy;
}

template <class T>
class MonteCarloTest : public ::testing::Test {};
TYPED_TEST_SUITE(MonteCarloTest, support::Dimensions);

// In boxes of many cells, of two (each seen once) and of one along the bounded direction.
TYPED_TEST(MonteCarloTest, AMoveChangesTheTotalEnergyByItsLocalChange) {
  constexpr int D = TypeParam::D;
  for (const double edge : {5.3, 2.0}) {
    Toy<D> toy(edge, 60);
    toy.trap.stiffness = 3.0;
    LocalEnergy<D> local(toy.box, toy.model, toy.trap, toy.particles);
    local.sort_in();
    const auto targets = support::random_points<D>(Vec<D>{}, toy.box.size, 60, 9);
    double energy = total_energy(toy);
    for (std::size_t i = 0; i < targets.size(); ++i) {
      const auto self = static_cast<std::int32_t>(i);
      const double change = local.change({&self, 1}, {&targets[i], 1});
      local.accept();
      toy.particles.position[i] = targets[i];
      const double after = total_energy(toy);
      EXPECT_NEAR(change, after - energy, 1e-10 * std::abs(after)) << "particle " << i;
      energy = after;
    }
  }
}

// One particle in a trap and a uniform force: <z> = centre + f/k, variance kT/k. About 40000 sweeps of correlation time
// 10: standard errors 0.0075 (mean) and 2.2 % of the variance. The box is 8 standard deviations away.
TYPED_TEST(MonteCarloTest, ATrappedParticleHasItsBoltzmannDistribution) {
  constexpr int D = TypeParam::D;
  Toy<D> toy(8.0, 1, {}, {.kT = 0.5});
  toy.particles.position[0] = support::uniform_vec<D>(4.0);
  toy.trap.stiffness = 2.0;
  toy.trap.centre = 3.5;
  toy.trap.force[D - 1] = 1.0;
  MonteCarlo<D> sampler(1.2);
  double sum = 0.0, squares = 0.0;
  constexpr int sweeps = 40000;
  for (Clock clock{.dt = 1.0, .sampled = false}; clock.step < sweeps; clock.advance()) {
    sampler.step(*toy.dynamics, clock);
    const double z = toy.particles.position[0][D - 1] - 4.0;
    sum += z;
    squares += z * z;
  }
  EXPECT_NEAR(sum / sweeps, 0.0, 0.03);
  EXPECT_NEAR(squares / sweeps, 0.25, 0.025);
}

// 40 rods in a trap over 1500 sweeps: standard error of <u_z^2> 0.0023, from the spread over 12 seeds.
TEST(MonteCarlo, RodsPointAsBoltzmannHasIt) {
  support::TrappedRods rods(0.0);
  EXPECT_NEAR(rods.run("monte-carlo", 1.0, 200, 1500).tilt, support::TrappedRods::tilt(), 0.012);
}

// A gas without energy fills the box evenly up to its bounded ends: the mean of |z - L/2| is L/4, its standard error
// (independent sweeps: the step is half the box) below 0.2 %.
TYPED_TEST(MonteCarloTest, AnIdealGasIsEvenUpToTheWalls) {
  constexpr int D = TypeParam::D;
  Toy<D> toy(4.0, 50, {}, {.a = 0.0});
  MonteCarlo<D> sampler(2.0);
  double sum = 0.0;
  constexpr int sweeps = 8000;
  for (Clock clock{.dt = 1.0, .sampled = false}; clock.step < sweeps; clock.advance()) {
    sampler.step(*toy.dynamics, clock);
    for (const Vec<D>& r : toy.particles.position) {
      ASSERT_GE(r[D - 1], 0.0);
      ASSERT_LE(r[D - 1], 4.0);
      sum += std::abs(r[D - 1] - 2.0);
    }
  }
  EXPECT_NEAR(sum / sweeps / 50.0, 1.0, 0.01);
}

// Two particles in two dimensions: <u> = int u exp(-u/kT) 2 pi r dr / (area + int (exp(-u/kT) - 1) 2 pi r dr), periodic.
TEST(MonteCarlo, TwoParticlesHaveTheExactMeanEnergy) {
  const DpdParameters pair{.a = 6.0};
  Toy<2> toy(2.0, 2, {}, pair);
  toy.box.periodic.back() = true;
  toy.remake({});
  double energy = 0.0, weight = 4.0;
  constexpr int points = 20000;
  for (int k = 0; k < points; ++k) {
    const double r = (k + 0.5) / points;
    const double u = 3.0 * (1.0 - r) * (1.0 - r);
    energy += u * std::exp(-u) * 2.0 * std::numbers::pi * r / points;
    weight += (std::exp(-u) - 1.0) * 2.0 * std::numbers::pi * r / points;
  }
  MonteCarlo<2> sampler(0.9);
  constexpr int blocks = 100, sweeps = 1000;
  double sum = 0.0, squares = 0.0;
  Clock clock{.dt = 1.0, .sampled = false};
  for (int b = 0; b < blocks; ++b) {
    double block = 0.0;
    for (int s = 0; s < sweeps; ++s, clock.advance()) {
      sampler.step(*toy.dynamics, clock);
      const Vec<2> d = toy.box.separation(toy.particles.position[0], toy.particles.position[1]);
      block += toy.model.pair(norm(d), {}, {}).u / sweeps;
    }
    sum += block / blocks;
    squares += block * block / blocks;
  }
  const double standard_error = std::sqrt((squares - sum * sum) / blocks);
  EXPECT_LT(standard_error, 0.01 * energy / weight);
  EXPECT_NEAR(sum, energy / weight, 4.0 * standard_error);
}

// From far too large and far too small a step to 40 % acceptance; not touched afterwards.
TYPED_TEST(MonteCarloTest, TheStepIsTunedDuringEquilibrationOnly) {
  constexpr int D = TypeParam::D;
  for (const double start : {2.0, 0.01}) {
    Toy<D> toy(4.0, 100);
    MonteCarlo<D> sampler(start);
    toy.run(sampler, 0, 400, 400);
    const double tuned = sampler.trial_step();
    EXPECT_NE(tuned, start);
    toy.run(sampler, 400, 700, 400);
    EXPECT_EQ(sampler.trial_step(), tuned);
    EXPECT_NEAR(sampler.acceptance(), 0.4, 0.04);
  }
  Toy<D> toy(4.0, 100);
  MonteCarlo<D> sampler(0.3);
  toy.run(sampler, 0, 50);
  EXPECT_EQ(sampler.trial_step(), 0.3);
}

// Interrupted within a tuning interval and just before a reordering of memory.
TYPED_TEST(MonteCarloTest, ARestartContinuesBitForBit) {
  constexpr int D = TypeParam::D;
  const DynamicsSettings settings{.reorder_every = 25};
  Toy<D> whole(4.0, 90, settings);
  MonteCarlo<D> straight(0.4);
  whole.run(straight, 0, 120, 80);

  Toy<D> before(4.0, 90, settings);
  MonteCarlo<D> first(0.4);
  before.run(first, 0, 49, 80);
  support::MemoryArchive particles, state;
  before.particles.save(particles);
  first.save(state);

  Toy<D> after(4.0, 90, settings);
  after.run(first, 0, 0);
  after.particles.load(particles);
  after.dynamics->particles_replaced();
  MonteCarlo<D> second;
  second.prepare(*after.dynamics);
  second.load(state);
  after.run(second, 49, 120, 80);
  EXPECT_EQ(after.particles.position, whole.particles.position);
  EXPECT_EQ(after.particles.image, whole.particles.image);
  EXPECT_EQ(after.particles.id, whole.particles.id);
  EXPECT_EQ(second.trial_step(), straight.trial_step());
  EXPECT_EQ(second.acceptance(), straight.acceptance());
}

TYPED_TEST(MonteCarloTest, SameBitsOnAnyThreadCountAndWhoeverLooks) {
  constexpr int D = TypeParam::D;
  const auto end_of = [](int count, bool sampled) {
    set_threads(count, 0);
    Toy<D> toy(5.0, 600);
    MonteCarlo<D> sampler;
    for (Clock clock{.dt = 1.0, .sampled = sampled}; clock.step < 5; clock.advance())
      sampler.step(*toy.dynamics, clock);
    set_threads(1, 0);
    return toy.particles.position;
  };
  const auto one = end_of(1, true);
  EXPECT_EQ(one, end_of(3, true));
  EXPECT_EQ(one, end_of(1, false));
}

TYPED_TEST(MonteCarloTest, TheRecordHoldsTheSweepsStartAtRest) {
  constexpr int D = TypeParam::D;
  Toy<D> toy(4.0, 80, {.reorder_every = 0});
  MonteCarlo<D> sampler;
  const std::vector<Vec<D>> start = toy.particles.position;
  const StepRecord<D>& record = sampler.step(*toy.dynamics, {.dt = 1.0});
  EXPECT_EQ(record.start.position, start);
  EXPECT_NE(toy.particles.position, start);
  EXPECT_GT(record.start.network.size(), 0);
  EXPECT_TRUE(record.edge_noise.empty());
  EXPECT_EQ(record.v_mid, std::vector<Vec<D>>(80));
  EXPECT_EQ(toy.dynamics->statistics().solves, 0);
}

TYPED_TEST(MonteCarloTest, KnownParticlesStay) {
  constexpr int D = TypeParam::D;
  Toy<D> toy(4.0, 60);
  for (std::size_t i = 0; i < 20; ++i) toy.particles.group[i] = odpd::Group::wall(0);
  const std::vector<Vec<D>> start = toy.particles.position;
  MonteCarlo<D> sampler;
  toy.run(sampler, 1, 50);
  for (std::size_t i = 0; i < 60; ++i)
    EXPECT_EQ(toy.particles.position[i] == start[i], i < 20) << "particle " << i;
}

TEST(MonteCarlo, RefusesWhatHasNoEquilibrium) {
  const auto check = [](const auto& change, double kT) {
    Toy<2> toy(4.0, 20);
    toy.particles.group[0] = odpd::Group::wall(0);
    toy.trap = Trap<2>({.kT = kT});
    change(toy.trap);
    toy.remake({});
    MonteCarlo<2>().prepare(*toy.dynamics);
  };
  const auto nothing = [](Trap<2>&) {};
  const auto lift = [](Trap<2>& trap) { trap.force = {{0.0, 1.0}}; };
  const auto push = [](Trap<2>& trap) { trap.force = {{1.0, 0.0}}; };
  const auto slide = [](Trap<2>& trap) { trap.wall_velocity = {{1.0, 0.0}}; };
  EXPECT_NO_THROW(check(nothing, 1.0));
  EXPECT_NO_THROW(check(lift, 1.0));
  support::expect_error<ConfigError>([&] { check(push, 1.0); }, {"body_force.force", "along x"});
  support::expect_error<ConfigError>([&] { check(slide, 1.0); }, {"wall.velocity"});
  support::expect_error<ConfigError>([&] { check(nothing, 0.0); }, {"fluid.kT > 0"});
  support::expect_error<ConfigError>([&] { check(nothing, 0.7); }, {"one temperature"});
}

}  // namespace
}  // namespace odpd
