// Lees-Edwards shear: nothing may depend on where the box is cut, and without a rate it is the periodic box.
#include <gtest/gtest.h>

#include <cmath>

#include "odpd/core/parallel.h"
#include "odpd/dynamics/integrator.h"
#include "odpd/operator/edge_sums.h"
#include "odpd/pairs/bonds.h"
#include "odpd/pairs/dpd.h"
#include "support/dimensions.h"
#include "support/points.h"
#include "support/simplex.h"

namespace odpd {
namespace {

template <typename T>
class ShearedDynamics : public testing::Test {};
TYPED_TEST_SUITE(ShearedDynamics, support::Dimensions);

struct ShearedToySettings {
  std::optional<Shear> shear = Shear{0, 1, 2.0, 0.0, 0.0};
  DpdParameters fluid{};
  double mass = 0.0;
  double cut = 0.0;  ///< all positions are moved by so much along the gradient
  double edge = 3.2;
  std::size_t count = 0;  ///< 0: of density 4
  std::int64_t reorder_every = 7;
  std::string preconditioner = "auto";
  bool bonded = false;
  bool bodies = false;  ///< four that move, across the faces of this box or of one cut 1.3 further
  bool held = false;    ///< one more, at rest
};

template <int D>
struct ShearedToy {
  explicit ShearedToy(const ShearedToySettings& s) : none({.mass = s.mass, .kT = s.fluid.kT}) {
    for (int c = 0; c < D; ++c) box.size[c] = s.edge + 0.4 * c;
    box.periodic.fill(true);
    box.shear = s.shear;
    box = box.at(0.0);
    if (s.bodies) add_bodies(s);
    const auto count = s.count > 0 ? s.count : static_cast<std::size_t>(4.0 * box.volume());
    for (Vec<D> r : support::random_points<D>(Vec<D>{}, box.size, count, 9)) {
      if (s.shear) r[s.shear->gradient] += s.cut;
      box.wrap(r);
      particles.add(r, 0);
    }
    std::vector<Bond> bonds;
    std::vector<SiteFrame<D>> frames;
    constexpr std::int64_t tied = 4;  // the first, to sites of a frame
    if (s.bonded) {
      frames.push_back({0, 0, support::random_vectors<D>(tied, 11), 100.0});
      for (Vec<D>& b : frames[0].sites) b *= 0.2;
      Vec<D> middle{};
      for (const Vec<D>& b : frames[0].sites) middle += (1.0 / tied) * b;
      for (std::int64_t i = 0; i < tied; ++i) {
        const auto k = static_cast<std::size_t>(i);
        frames[0].sites[k] -= middle;
        if (i > 0) particles.position[k] = particles.position[0] + 1.2 * frames[0].sites[k];
        box.wrap(particles.position[k]);
        for (std::int64_t j = i + 1; j < tied; ++j)
          bonds.push_back({i, j, {.law = BondLaw::sites, .H = 100.0}});
      }
    }
    for (std::int64_t i = tied; i < particles.size() && s.bonded; ++i)
      for (std::int64_t j = tied; j < i; ++j)
        if (norm(box.separation(particles.position[static_cast<std::size_t>(i)],
                                particles.position[static_cast<std::size_t>(j)])) < 0.25)
          bonds.push_back({i, j, BondParameters{.H = 100.0, .r_0 = 0.3}});
    model = std::make_unique<BondedModel<D>>(std::make_unique<DpdModel<D>>(1, std::vector{s.fluid}),
                                             bonds, frames);
    DynamicsSettings settings;
    settings.reorder_every = s.reorder_every;
    SolverOptions solver{.name = "pcg", .tolerance = 1e-12};
    solver.preconditioner = s.preconditioner;
    dynamics =
        std::make_unique<Dynamics<D>>(box, particles, *model, none, make_solver(solver), settings);
    for (std::size_t i = 0; i < particles.end_velocity.size() && s.shear; ++i) {
      particles.end_velocity[i] = box.flow_velocity(particles.position[i]);
      particles.end_velocity[i][s.shear->flow] += boxes_from_centre(i) * box.sliding;
    }
  }

  // Simplices, 0.5 wide, their centres next to a face.
  void add_bodies(const ShearedToySettings& s) {
    const int up = s.shear ? s.shear->gradient : 0;
    const std::vector<double> heights{0.01, -0.02, -1.28, -1.31, 1.7};
    for (std::size_t n = 0; n < (s.held ? 5U : 4U); ++n) {
      RigidBody<D> body = support::simplex_body<D>();
      body.pose.centre = (n % 2 == 0 ? 0.3 : 0.8) * box.size;
      body.pose.centre[up] = heights[n] + s.cut;
      box.wrap(body.pose.centre);
      body.known = n == 4;
      particles.add_body(body, box, 0);
    }
  }
  std::int32_t boxes_from_centre(std::size_t i) const {
    const auto up = static_cast<std::size_t>(box.shear->gradient);
    return particles.image[i][up] - particles.moving_image(i)[up];
  }

  std::vector<Vec<D>> by_id(const std::vector<Vec<D>>& v) const {
    std::vector<Vec<D>> sorted(v.size());
    for (std::size_t i = 0; i < v.size(); ++i)
      sorted[static_cast<std::size_t>(particles.id[i])] = v[i];
    return sorted;
  }
  void run(Integrator<D>& integrator, Clock clock) {
    for (; !clock.finished(); clock.advance()) integrator.step(*dynamics, clock);
  }

  Box<D> box;
  Particles<D> particles;
  std::unique_ptr<PairModel<D>> model;
  const NoSurroundings<D> none;
  std::unique_ptr<Dynamics<D>> dynamics;
};

// Largest difference between the paths, and those of the last step, of two runs, but for a motion of all particles as one. `crossed`: how many went
// through the sliding faces.
template <int D>
double difference_of_paths(const ShearedToySettings& settings, const std::string& scheme,
                           const Clock& clock, double cut, int& crossed,
                           int* bodies_crossed = nullptr) {
  ShearedToySettings moved = settings;
  moved.cut = cut;
  ShearedToy<D> a(settings), b(moved);
  const auto step_a = make_integrator<D>(scheme), step_b = make_integrator<D>(scheme);
  a.run(*step_a, clock);
  b.run(*step_b, clock);
  const Box<D> box = a.box.at(static_cast<double>(clock.total_steps) * clock.dt);
  const auto r = a.by_id(a.particles.position), s = b.by_id(b.particles.position);
  const auto v = a.by_id(a.particles.velocity), u = b.by_id(b.particles.velocity);
  double most = 0.0;
  for (std::size_t i = 1; i < r.size(); ++i) {
    const Vec<D> d = box.separation(r[i], r[0]), e = box.separation(s[i], s[0]);
    // Only as close as nearest images are.
    if (norm(d) >= 1.5) continue;
    most = std::max(most, norm(d - e));
    if (box.shear->frequency > 0.0) continue;
    // The velocity of what is in the box.
    Vec<D> slip = v[i] - v[0] - (u[i] - u[0]);
    slip[box.shear->flow] -=
        (box.images_up(r[i] - r[0]) - box.images_up(s[i] - s[0])) * box.sliding;
    most = std::max(most, clock.dt * norm(slip));
  }
  crossed = 0;
  const auto up = static_cast<std::size_t>(box.shear->gradient);
  for (const ShearedToy<D>* toy : {&a, &b}) {
    for (const auto& image : toy->particles.image) crossed += image[up] != 0 ? 1 : 0;
    for (const auto& body : toy->particles.bodies)
      if (bodies_crossed != nullptr) *bodies_crossed += body.pose.image[up] != 0 ? 1 : 0;
  }
  return most;
}

TYPED_TEST(ShearedDynamics, PathsDoNotDependOnWhereTheBoxIsCut) {
  constexpr int D = TypeParam::D;
  struct Run {
    const char* scheme;
    double mass;
  };
  for (const Run& run : {Run{"trapezoidal", 0.0}, Run{"midpoint", 0.0}, Run{"extrapolated", 0.0},
                         Run{"implicit", 0.0}, Run{"implicit", 1.0}, Run{"euler", 0.0},
                         Run{"trapezoidal", 1.0}, Run{"midpoint", 1.0}, Run{"extrapolated", 1.0},
                         Run{"setd", 1.0}, Run{"velocity-verlet", 1.0}, Run{"shardlow", 1.0}}) {
    ShearedToySettings settings;
    settings.mass = run.mass;
    settings.shear->gradient = D - 1;
    int crossed = 0;
    const Clock clock{.dt = 0.015, .total_steps = 15};
    // Shardlow's colours follow the order of memory.
    if (std::string(run.scheme) == "shardlow") settings.reorder_every = 0;
    // Rounding grows along the paths; a velocity of the wrong image would be off by 0.1.
    EXPECT_LT(difference_of_paths<D>(settings, run.scheme, clock, 1.3, crossed), 1e-6)
        << run.scheme << " mass " << run.mass;
    EXPECT_GT(crossed, 3);
  }
}

TYPED_TEST(ShearedDynamics, PathsOfBondedParticlesDoNotDependOnTheCutEither) {
  constexpr int D = TypeParam::D;
  for (const char* scheme : {"trapezoidal", "midpoint", "implicit"}) {
    ShearedToySettings settings;
    settings.bonded = true;
    int crossed = 0;
    const Clock clock{.dt = 0.015, .total_steps = 15};
    EXPECT_LT(difference_of_paths<D>(settings, scheme, clock, 1.3, crossed), 1e-6) << scheme;
    EXPECT_GT(crossed, 3);
  }
}

// Each body lies across the faces in one of the two boxes, in one piece in the other.
TYPED_TEST(ShearedDynamics, PathsOfRigidBodiesDoNotDependOnTheCutEither) {
  constexpr int D = TypeParam::D;
  struct Run {
    const char* scheme;
    double mass;
    bool held;
  };
  int bodies_crossed = 0;
  for (const Run& run :
       {Run{"trapezoidal", 0.0, false}, Run{"trapezoidal", 0.0, true}, Run{"midpoint", 0.0, false},
        Run{"extrapolated", 0.0, false}, Run{"implicit", 0.0, false}, Run{"euler", 0.0, false},
        Run{"trapezoidal", 1.0, false}, Run{"extrapolated", 1.0, false}}) {
    ShearedToySettings settings;
    settings.bodies = true;
    settings.held = run.held;
    settings.mass = run.mass;
    settings.shear->gradient = D - 1;
    settings.shear->rate = 3.0;
    int crossed = 0;
    const Clock clock{.dt = 0.015, .total_steps = 12};
    EXPECT_LT(difference_of_paths<D>(settings, run.scheme, clock, 1.3, crossed, &bodies_crossed),
              1e-6)
        << run.scheme << " mass " << run.mass << (run.held ? " held" : "");
    EXPECT_GT(crossed, 3);
  }
  EXPECT_GT(bodies_crossed, 3);
}

TYPED_TEST(ShearedDynamics, OscillationDependsOnTheCutOnlyByTheErrorOfTheStep) {
  constexpr int D = TypeParam::D;
  for (const bool bodies : {false, true}) {
    ShearedToySettings settings;
    settings.fluid.kT = 0.0;
    settings.bodies = bodies;
    settings.shear->rate = 3.0;
    settings.shear->frequency = 5.0;
    int crossed = 0;
    const double coarse = difference_of_paths<D>(settings, "trapezoidal",
                                                 {.dt = 0.01, .total_steps = 40}, 1.3, crossed);
    const double fine = difference_of_paths<D>(settings, "trapezoidal",
                                               {.dt = 0.0025, .total_steps = 160}, 1.3, crossed);
    EXPECT_LT(coarse, 0.02);
    EXPECT_LT(fine, coarse / 10.0) << "second order: a factor of 16";
    EXPECT_GT(crossed, 3);
  }
}

TYPED_TEST(ShearedDynamics, SlipsOfTheShearedFlowFollowFromTheSeparationsAlone) {
  constexpr int D = TypeParam::D;
  ShearedToySettings settings;
  settings.shear = Shear{D - 1, 0, 0.7, 0.0, 0.0};
  ShearedToy<D> toy(settings);
  Stage<D> stage;
  toy.dynamics->evaluate(toy.particles.position, 1.9, stage);
  std::vector<Vec<D>> flow, bulk(stage.position.size()), force(stage.position.size());
  for (const Vec<D>& r : stage.position) flow.push_back(stage.box.flow_velocity(r));
  const PairNetwork<D>& n = stage.network;
  ASSERT_EQ(n.slip_0.size(), n.e.size());
  int across = 0;
  for (std::size_t k = 0; k < n.e.size(); ++k) {
    Vec<D> expected{};
    expected[D - 1] = 0.7 * n.r[k] * n.e[k][0];
    EXPECT_LT(norm(n.slip(k, flow) - expected), 1e-13);
    across += n.slip_0[k] != Vec<D>{} ? 1 : 0;
    const Vec<D> f = -n.zeta_par[k] * dot(expected, n.e[k]) * n.e[k];
    bulk[static_cast<std::size_t>(n.i[k])] += f;
    bulk[static_cast<std::size_t>(n.j[k])] -= f;
  }
  EXPECT_GT(across, 10);
  add_friction_forces<D>(n, flow, force);
  add_sliding_friction(n, force);
  for (std::size_t i = 0; i < force.size(); ++i) EXPECT_LT(norm(force[i] - bulk[i]), 1e-11);
}

TYPED_TEST(ShearedDynamics, ForcesBalanceInBothStages) {
  constexpr int D = TypeParam::D;
  ShearedToySettings settings;
  settings.shear->rate = 20.0;  // particles cross within the step
  ShearedToy<D> toy(settings);
  const auto integrator = make_integrator<D>("trapezoidal");
  const auto& record = integrator->step(*toy.dynamics, Clock{.dt = 0.02, .total_steps = 1});
  int crossed = 0;
  for (const std::int32_t up : record.corrector.crossed) crossed += up != 0 ? 1 : 0;
  EXPECT_GT(crossed, 0);
  for (const Stage<D>* stage : {&record.start, &record.corrector}) {
    std::vector<Vec<D>> force(stage->position.size());
    add_edge_forces<D>(record.start.network, record.edge_noise, force);
    add_conservative_forces(stage->network, force);
    add_friction_forces<D>(stage->network, stage->velocity, force);
    add_sliding_friction(stage->network, force);
    for (const Vec<D>& f : force) EXPECT_LT(norm(f), 1e-8);
  }
}

// Friction, noise and conservative forces on a body: no force and no torque is left, the random one with the arms of the
// step's start; its constituents move as one, in the velocities of one image.
TYPED_TEST(ShearedDynamics, ForcesAndTorquesOnBodiesBalanceInBothStages) {
  constexpr int D = TypeParam::D;
  ShearedToySettings settings;
  settings.bodies = true;
  settings.shear = Shear{D - 1, 0, 5.0, 0.0, 0.3};
  ShearedToy<D> toy(settings);
  int across = 0;
  const auto integrator = make_integrator<D>("trapezoidal");
  for (Clock clock{.dt = 0.01, .total_steps = 4}; !clock.finished(); clock.advance()) {
    const auto& record = integrator->step(*toy.dynamics, clock);
    for (const Stage<D>* stage : {&record.start, &record.corrector}) {
      std::vector<Vec<D>> force(stage->position.size()), noise(force.size());
      add_edge_forces<D>(record.start.network, record.edge_noise, noise);
      add_conservative_forces(stage->network, force);
      add_friction_forces<D>(stage->network, stage->velocity, force);
      add_sliding_friction(stage->network, force);
      for (std::size_t b = 0; b < toy.particles.bodies.size(); ++b) {
        Vec<D> f{}, t{};
        double size = 0.0;
        std::vector<Vec<D>> arms, velocities;
        for (const std::int32_t particle : toy.dynamics->dofs().constituents(b)) {
          const auto p = static_cast<std::size_t>(particle);
          f += force[p] + noise[p];
          t += torque(stage->arms[p], force[p]) + torque(record.start.arms[p], noise[p]);
          size += norm(noise[p]);
          arms.push_back(stage->arms[p]);
          velocities.push_back(stage->velocity[p]);
          EXPECT_LT(norm(stage->arms[p]), 0.5) << "in one piece";
          across += stage->crossed[p] != 0 ? 1 : 0;
        }
        EXPECT_LT(norm(f), 1e-8 * size);
        EXPECT_LT(norm(t), 1e-8 * size);
        const RigidMotion<D> motion = rigid_motion<D>(arms, velocities);
        for (std::size_t k = 0; k < arms.size(); ++k)
          EXPECT_LT(norm(velocities[k] - motion.velocity - swing(motion.angular, arms[k])), 1e-10);
      }
    }
  }
  EXPECT_GT(across, 8);
}

TEST(ShearedBodies, HaveTheSameBitsOnAnyThreadCount) {
  const int before = threads();
  std::vector<std::vector<Vec<2>>> results;
  for (const int count : {1, 2}) {
    set_threads(count, 0);
    ShearedToySettings settings;
    settings.bodies = settings.held = true;
    settings.shear->frequency = 30.0;
    ShearedToy<2> toy(settings);
    const auto integrator = make_integrator<2>("trapezoidal");
    toy.run(*integrator, {.dt = 0.01, .total_steps = 8});
    results.push_back(toy.by_id(toy.particles.position));
  }
  set_threads(before, 0);
  EXPECT_EQ(results[0], results[1]);
}

TYPED_TEST(ShearedDynamics, WithoutARateItIsThePeriodicBoxToTheBitWithBodiesToo) {
  constexpr int D = TypeParam::D;
  for (const bool held : {false, true})
    for (const double mass : {0.0, 0.5}) {
      ShearedToySettings settings;
      settings.bodies = true;
      settings.held = held;
      settings.mass = mass;
      settings.shear = Shear{1, 0, 0.0, 0.0, 0.0};
      ShearedToy<D> sheared(settings);
      settings.shear.reset();
      ShearedToy<D> plain(settings);
      const Clock clock{.dt = 0.01, .total_steps = 20};
      const auto a = make_integrator<D>("trapezoidal"), b = make_integrator<D>("trapezoidal");
      sheared.run(*a, clock);
      plain.run(*b, clock);
      EXPECT_EQ(sheared.particles.position, plain.particles.position);
      EXPECT_EQ(sheared.particles.velocity, plain.particles.velocity);
      EXPECT_EQ(sheared.particles.end_velocity, plain.particles.end_velocity);
      EXPECT_EQ(sheared.particles.image, plain.particles.image);
    }
}

TYPED_TEST(ShearedDynamics, WithoutARateItIsThePeriodicBoxToTheBit) {
  constexpr int D = TypeParam::D;
  for (const char* scheme : {"trapezoidal", "midpoint", "extrapolated", "euler"})
    for (const char* preconditioner : {"block-jacobi", "multilevel"}) {
      ShearedToySettings settings;
      settings.preconditioner = preconditioner;
      settings.shear = Shear{1, 0, 0.0, 0.0, 0.0};
      ShearedToy<D> sheared(settings);
      settings.shear.reset();
      ShearedToy<D> plain(settings);
      const Clock clock{.dt = 0.01, .total_steps = 20};
      const auto a = make_integrator<D>(scheme), b = make_integrator<D>(scheme);
      sheared.run(*a, clock);
      plain.run(*b, clock);
      EXPECT_EQ(sheared.particles.position, plain.particles.position) << scheme;
      EXPECT_EQ(sheared.particles.velocity, plain.particles.velocity) << scheme;
      EXPECT_EQ(sheared.particles.image, plain.particles.image) << scheme;
    }
}

// Slope of the velocities of a step over the gradient direction.
template <int D>
double slope_of(const StepRecord<D>& record) {
  const Shear& shear = *record.start.box.shear;
  double n = 0.0, y = 0.0, v = 0.0, yy = 0.0, yv = 0.0;
  for (std::size_t i = 0; i < record.v_mid.size(); ++i) {
    const double at = record.start.position[i][shear.gradient];
    const double u = record.v_mid[i][shear.flow];
    n += 1.0;
    y += at;
    v += u;
    yy += at * at;
    yv += at * u;
  }
  return (n * yv - y * v) / (n * yy - y * y);
}

TYPED_TEST(ShearedDynamics, TheMeanProfileHasTheRateAsItsSlope) {
  constexpr int D = TypeParam::D;
  ShearedToySettings settings;
  settings.shear = Shear{D - 1, 0, 1.0, 0.0, 0.0};
  settings.edge = D == 2 ? 5.0 : 4.0;
  ShearedToy<D> toy(settings);
  const auto integrator = make_integrator<D>("trapezoidal");
  Clock clock{.dt = 0.02, .total_steps = 600};
  std::vector<double> block(12, 0.0);
  for (; !clock.finished(); clock.advance())
    block[static_cast<std::size_t>(clock.step / 50)] +=
        slope_of(integrator->step(*toy.dynamics, clock)) / 50.0;
  // The first block is left out: it starts from random points.
  double mean = 0.0, square = 0.0;
  for (std::size_t k = 1; k < block.size(); ++k) mean += block[k] / 11.0;
  for (std::size_t k = 1; k < block.size(); ++k) square += std::pow(block[k] - mean, 2);
  const double error = std::sqrt(square / 110.0);
  EXPECT_LT(error, 0.1);
  EXPECT_NEAR(mean, 1.0, 4.0 * error) << "standard error " << error;
}

}  // namespace
}  // namespace odpd
