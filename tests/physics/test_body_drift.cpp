// Small rigid bodies must sample exp(-U/kT) whatever their resistance: many copies, each among frozen friction-only particles.
// The centre of a body in a harmonic trap knows the trap alone; a rotor (support/rotors.h) its torque alone.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "odpd/dynamics/integrator.h"
#include "odpd/pairs/dpd.h"
#include "support/rotors.h"

namespace odpd {
namespace {

constexpr double copy_spacing = 8.0;
constexpr int copies_per_side = 20;
constexpr double body_trap = 8.0;    // spring constant of the centre, kT = 1
constexpr double body_reach = 0.25;  // radius of the disc whose population is compared

Vec<2> copy_centre(const Vec<2>& r) {
  Vec<2> c;
  for (int k = 0; k < 2; ++k) c[k] = (std::floor(r[k] / copy_spacing) + 0.5) * copy_spacing;
  return c;
}

// A third of the trap on each of three constituents: its sum is body_trap/2 |X - c|^2 and a constant.
class BodyTraps : public NoSurroundings<2> {
 public:
  void add_potential_forces(const Particles<2>& particles, std::span<const Vec<2>> positions,
                            std::vector<Vec<2>>& force) const override {
    for (std::size_t i = 0; i < positions.size(); ++i)
      if (!particles.is_known(i))
        force[i] -= body_trap / 3.0 * (positions[i] - copy_centre(positions[i]));
  }
};

// Fraction of the time that centres spend closer than `body_reach` to the middle, relative to 1 - exp(-trap reach^2/2).
double body_population(const std::string& scheme, std::int64_t steps) {
  const double edge = copies_per_side * copy_spacing;
  const Box<2> box{{{edge, edge}}, {true, true}};
  Particles<2> particles;
  RigidBody<2> body;
  for (int k = 0; k < 3; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / 3.0;
    body.frame.push_back({{0.1 * std::cos(angle), 0.1 * std::sin(angle)}});
  }
  std::vector<Vec<2>> centres;
  for (int x = 0; x < copies_per_side; ++x)
    for (int y = 0; y < copies_per_side; ++y)
      centres.push_back({{(x + 0.5) * copy_spacing, (y + 0.5) * copy_spacing}});
  for (const Vec<2>& c : centres) {
    body.pose.centre = c + Vec<2>{{0.3, 0.2}};
    particles.add_body(body, box, 0);
  }
  for (const Vec<2>& c : centres) {
    particles.add(c, 0, odpd::Group::wall(0));
    for (int k = 0; k < 8; ++k) {
      const double angle = k * std::numbers::pi / 4.0;
      particles.add(c + 1.2 * Vec<2>{{std::cos(angle), std::sin(angle)}}, 0, odpd::Group::wall(0));
    }
  }
  particles.walls = 1;
  const DpdModel<2> model(1, {DpdParameters{.a = 0.0, .gamma = 1.5, .s = 0.5, .cutoff = 3.0}});
  const BodyTraps traps;
  Dynamics<2> dynamics(box, particles, model, traps,
                       make_solver({.name = "pcg", .tolerance = 1e-5}), DynamicsSettings{});
  const auto integrator = make_integrator<2>(scheme);
  double inside = 0.0, all = 0.0;
  for (Clock clock{.dt = 0.01, .total_steps = steps}; !clock.finished(); clock.advance()) {
    integrator->step(dynamics, clock);
    if (clock.step < steps / 20) continue;
    for (const RigidBody<2>& b : particles.bodies) {
      all += 1.0;
      inside += norm(b.pose.centre - copy_centre(b.pose.centre)) < body_reach ? 1.0 : 0.0;
    }
  }
  return inside / all / (1.0 - std::exp(-0.5 * body_trap * body_reach * body_reach));
}

// 400 bodies over t = 40, decorrelating within about 0.5: standard error about 1 %.
TEST(BodyDrift, BodiesSampleTheirTrap) {
  EXPECT_NEAR(body_population("trapezoidal", 4000), 1.0, 0.04);
}

TEST(BodyDrift, EulerIsRejectedWithBodiesToo) { EXPECT_LT(body_population("euler", 2000), 0.9); }

// Standard error 1.9 % over t = 70; a run of ten times that is among the long tests.
TEST(BodyDrift, RotorsSampleTheirAngles) {
  const support::Fraction f = support::rotors_turned_away("trapezoidal", 7000);
  EXPECT_LT(f.standard_error, 0.025);
  EXPECT_NEAR(f.value, 1.0, 0.075);
}

// Measured: 1.187(13) over t = 50.
TEST(BodyDrift, EulerIsRejectedWithRotors) {
  EXPECT_GT(support::rotors_turned_away("euler", 5000).value, 1.1);
}

}  // namespace
}  // namespace odpd
