// What every integrator's header claims: order without noise, momentum, the same bits on any thread count and after a
// restart, which masses it takes.
#include <gtest/gtest.h>

#include <map>
#include <vector>

#include "odpd/core/error.h"
#include "odpd/core/parallel.h"
#include "support/memory_archive.h"
#include "toy.h"

namespace odpd {
namespace {

struct Scheme {
  std::string label;
  IntegratorSettings settings;
  double mass = 0.0;
  double order = 2.0;
  bool pairwise = true;  // conserves momentum
};

IntegratorSettings named(const std::string& name) {
  IntegratorSettings s;
  s.name = name;
  return s;
}

std::vector<Scheme> schemes() {
  std::vector<Scheme> all;
  for (const double mass : {0.0, 0.5}) {
    const std::string suffix = mass > 0.0 ? "_with_mass" : "_massless";
    for (const char* name : {"trapezoidal", "midpoint", "extrapolated", "implicit"})
      all.push_back({name + suffix, named(name), mass, 2.0});
  }
  all.push_back({"euler", named("euler"), 0.0, 1.0});
  all.push_back({"setd_1", named("setd"), 0.5, 1.0, false});
  all.push_back({"setd_2", named("setd"), 0.5, 2.0, false});
  all.back().settings.order = 2;
  all.push_back({"verlet_half", named("velocity-verlet"), 0.5, 1.0});
  all.push_back({"verlet_one", named("velocity-verlet"), 0.5, 2.0});
  all.back().settings.lambda = 1.0;
  all.push_back({"shardlow", named("shardlow"), 0.5, 1.0});
  return all;
}

class Integrators : public testing::TestWithParam<Scheme> {
 protected:
  ToySettings toy(double kT) const {
    ToySettings s;
    s.fluid.kT = kT;
    s.constants.mass = GetParam().mass;
    s.constants.kT = kT;
    return s;
  }
  // A shear wave, so that mass has something to carry.
  static void set_in_motion(Toy& toy) {
    if (!toy.dynamics->has_mass()) return;
    for (std::size_t i = 0; i < toy.particles.position.size(); ++i)
      toy.particles.end_velocity[i][0] =
          std::sin(2.0 * 3.14159265358979 * toy.particles.position[i][1] / toy.box.size[1]);
  }
  std::unique_ptr<Integrator<2>> make() const { return make_integrator<2>(GetParam().settings); }
};

std::vector<Vec<2>> by_id(const Toy& toy, const std::vector<Vec<2>>& field) {
  std::vector<Vec<2>> sorted;
  for (const std::int32_t i : toy.particles.index_of_id())
    sorted.push_back(field[static_cast<std::size_t>(i)]);
  return sorted;
}

// Errors at t = 0.08 of 16 and 32 steps fall by 2^order. Smooth weights (exponent 2): with the usual ones a pair that
// crosses the cutoff costs some of the order.
TEST_P(Integrators, OrderWithoutNoise) {
  const auto end_of = [&](const IntegratorSettings& settings, std::int64_t steps) {
    ToySettings s = toy(0.0);
    s.fluid.s = 2.0;
    s.fluid.s_bar = 2.0;
    s.solver.tolerance = 1e-12;
    s.constants.zeta_0 = 0.1;
    Toy t(s);
    set_in_motion(t);
    t.run(*make_integrator<2>(settings),
          Clock{.dt = 0.08 / static_cast<double>(steps), .total_steps = steps});
    return by_id(t, t.particles.position);
  };
  static std::map<double, std::vector<Vec<2>>> of_mass;
  std::vector<Vec<2>>& exact = of_mass[GetParam().mass];
  if (exact.empty()) exact = end_of(named("trapezoidal"), 256);
  const auto error = [&](std::int64_t steps) {
    const std::vector<Vec<2>> end = end_of(GetParam().settings, steps);
    const Box<2> box{{{5.0, 5.0}}, {true, true}};
    double sum = 0.0;
    for (std::size_t i = 0; i < end.size(); ++i) {
      const Vec<2> d = box.separation(end[i], exact[i]);
      sum += dot(d, d);
    }
    return std::sqrt(sum);
  };
  const double coarse = error(16), fine = error(32);
  EXPECT_NEAR(std::log2(coarse / fine), GetParam().order, 0.25) << coarse << " " << fine;
}

// With noise, a loose solver tolerance, and mass or not: the sum of the velocities stays what it was.
TEST_P(Integrators, MomentumToRounding) {
  ToySettings s = toy(1.0);
  s.solver.tolerance = 1e-3;
  Toy t(s);
  set_in_motion(t);
  const auto total = [](const std::vector<Vec<2>>& velocity) {
    Vec<2> sum{};
    for (const Vec<2>& v : velocity) sum += v;
    return sum;
  };
  const Vec<2> before = total(t.particles.end_velocity);
  t.run(*make(), Clock{.dt = 0.005, .total_steps = 20});
  const auto& velocity = t.dynamics->has_mass() ? t.particles.end_velocity : t.particles.velocity;
  double scale = 0.0;
  for (const Vec<2>& v : velocity) scale += norm(v);
  const double change = norm(total(velocity) - before) / scale;
  if (GetParam().pairwise) {
    EXPECT_LT(change, 1e-13);
  } else {
    EXPECT_GT(change, 1e-6) << "its header says that momentum is lost";
  }
}

TEST_P(Integrators, SameBitsOnAnyThreadCount) {
  const auto end_of = [&](int count) {
    set_threads(count, 0);
    ToySettings s = toy(1.0);
    s.walled = true;
    s.side = 50;  // enough for loops in parallel, within a colour of shardlow as well
    s.solver.tolerance = 1e-2;
    Toy t(s);
    t.run(*make(), Clock{.dt = 0.005, .total_steps = 4});
    set_threads(1, 0);
    return t.particles.position;
  };
  const auto one = end_of(1);
  EXPECT_EQ(one, end_of(2));
}

TEST_P(Integrators, RestartIsBitwise) {
  ToySettings s = toy(1.0);
  s.walled = true;
  s.dynamics.reorder_every = 5;
  s.constants.zeta_0 = 0.2;
  Toy unbroken(s);
  set_in_motion(unbroken);
  const auto first = make();
  unbroken.run(*first, Clock{.dt = 0.005, .total_steps = 7});
  support::MemoryArchive particles, integrator;
  unbroken.particles.save(particles);
  first->save(integrator);
  unbroken.run(*first, Clock{.dt = 0.005, .step = 7, .total_steps = 13});

  Toy resumed(s);
  const auto second = make();
  second->prepare(*resumed.dynamics);
  resumed.particles.load(particles);
  resumed.dynamics->particles_replaced();
  second->load(integrator);
  resumed.run(*second, Clock{.dt = 0.005, .step = 7, .total_steps = 13});
  EXPECT_EQ(unbroken.particles.id, resumed.particles.id);
  EXPECT_EQ(unbroken.particles.position, resumed.particles.position);
  EXPECT_EQ(unbroken.particles.end_velocity, resumed.particles.end_velocity);
}

TEST_P(Integrators, TheNameIsItsOwnAndItTakesThisMass) {
  EXPECT_EQ(make()->name(), GetParam().settings.name);
  EXPECT_EQ(mass_objection(GetParam().settings.name, GetParam().mass), "");
}

INSTANTIATE_TEST_SUITE_P(All, Integrators, testing::ValuesIn(schemes()),
                         [](const auto& test) { return test.param.label; });

// A column that nobody registered is not read from a checkpoint: what was kept would be zero from then on.
TEST(CarriedUnknowns, AreNotLoadedUnprepared) {
  Toy toy(ToySettings{});
  odpd::CarriedUnknowns<2> kept("kept"), unprepared("kept");
  support::MemoryArchive archive;
  kept.prepare(*toy.dynamics);
  kept.save(archive);
  EXPECT_NO_THROW(unprepared.load(archive)) << "nothing was kept";
  kept.keep(*toy.dynamics,
            std::vector<double>(static_cast<std::size_t>(toy.dynamics->dofs().unknowns()), 1.0));
  archive = {};
  kept.save(archive);
  EXPECT_NO_THROW(kept.load(archive));
  EXPECT_THROW(unprepared.load(archive), odpd::IoError);
}

TEST(IntegratorTable, SchemesThatCannotTakeAMassSayWhichCan) {
  EXPECT_NE(mass_objection("euler", 1.0).find("trapezoidal"), std::string::npos);
  for (const char* name : {"setd", "velocity-verlet", "shardlow"})
    EXPECT_NE(mass_objection(name, 0.0).find("trapezoidal"), std::string::npos) << name;
  for (const std::string& name : integrator_names())
    EXPECT_EQ(make_integrator<3>(name)->name(), name);
}

// 3000 particles out of each other's reach.
struct Strangers {
  explicit Strangers(const ParticleConstants& constants)
      : nothing(constants),
        dynamics(box, scattered(particles), model, nothing, make_solver({.name = "pcg"}), {}) {}
  static Particles<2>& scattered(Particles<2>& particles) {
    for (int k = 0; k < 3000; ++k) particles.add({{7.0 * (k % 57) + 1.0, 7.0 * (k / 57) + 1.0}}, 0);
    return particles;
  }
  Box<2> box{{{400.0, 400.0}}, {true, true}};
  Particles<2> particles;
  DpdModel<2> model{1, {DpdParameters{.a = 0.0}}};
  NoSurroundings<2> nothing;
  Dynamics<2> dynamics;
};

// Nothing but a uniform drag and its noise: the velocity is an Ornstein-Uhlenbeck process. N = 3000 particles;
// sampled over 40 correlation times, so that the variance has a standard error of about 0.4 %. x = zeta_0
// dt/m = 1: schemes that freeze the noise are off by what their headers say, (2/x) tanh(x/2) = 0.924.
double drag_temperature(const IntegratorSettings& settings, double dt) {
  constexpr double zeta_0 = 2.0, mass = 0.1;
  Strangers strangers(ParticleConstants{.mass = mass, .zeta_0 = zeta_0});
  const auto integrator = make_integrator<2>(settings);
  const auto relaxed = static_cast<std::int64_t>(6.0 * mass / zeta_0 / dt) + 1;
  Clock clock{.dt = dt, .total_steps = 7 * relaxed};
  double square = 0.0;
  for (; !clock.finished(); clock.advance()) {
    const StepRecord<2>& record = integrator->step(strangers.dynamics, clock);
    if (clock.step < relaxed) continue;
    for (const Vec<2>& v : record.v_start) square += dot(v, v);
  }
  return mass * square / (2.0 * 3000.0 * static_cast<double>(6 * relaxed));
}

TEST(Drag, VelocityHasTheVarianceThatTheHeadersState) {
  for (const char* name : {"trapezoidal", "midpoint", "extrapolated", "implicit", "shardlow"})
    EXPECT_NEAR(drag_temperature(named(name), 0.05), 1.0, 0.02) << name;
  EXPECT_NEAR(drag_temperature(named("setd"), 0.05), 2.0 * std::tanh(0.5), 0.02);
  // To first order in x = 0.1: 1 - (lambda - 1/2) x.
  IntegratorSettings verlet = named("velocity-verlet");
  EXPECT_NEAR(drag_temperature(verlet, 0.005), 1.0, 0.02);
  verlet.lambda = 1.0;
  EXPECT_NEAR(drag_temperature(verlet, 0.005), 0.95, 0.02);
}

// Massless: each step is a Gaussian of variance 2 kT dt/zeta_0 per component. 2 x 3000 x 20 samples: standard error 0.4 %.
TEST(Drag, MasslessParticlesDiffuseWithKTOverZeta) {
  Strangers strangers(ParticleConstants{.zeta_0 = 2.0});
  const auto integrator = make_integrator<2>("trapezoidal");
  double square = 0.0;
  for (Clock clock{.dt = 0.01, .total_steps = 20}; !clock.finished(); clock.advance())
    for (const Vec<2>& v : integrator->step(strangers.dynamics, clock).v_mid) square += dot(v, v);
  EXPECT_NEAR(square * 0.01 * 0.01 / (2.0 * 3000.0 * 20.0) / (2.0 * 0.01 / 2.0), 1.0, 0.02);
}

}  // namespace
}  // namespace odpd
