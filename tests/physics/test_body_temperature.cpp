// Rigid bodies with mass have the temperature of the fluid, moving and turning.
#include <gtest/gtest.h>

#include "support/rods.h"
#include "support/swarm.h"

namespace odpd {
namespace {

using support::Swarm;

// <P^2> = d M kT (1 - M/M_all) of a body of mass M where all momenta add up to zero, and <L w> = kT; 2 bodies over 60000
// steps, decorrelating within about 10: standard error about 1.3 %.
TEST(BodyTemperature, IsThatOfTheFluid) {
  constexpr int D = 2;
  const double mass = 1.0;
  Swarm<D> swarm(DpdParameters{}, mass, 6, 1e-6);
  const auto integrator = make_integrator<D>("trapezoidal");
  double linear = 0.0, angular = 0.0, samples = 0.0;
  for (Clock clock{.dt = 0.02, .total_steps = 61000}; !clock.finished(); clock.advance()) {
    integrator->step(*swarm.dynamics, clock);
    if (clock.step < 1000) continue;
    const auto index = swarm.particles.index_of_id();
    for (const RigidBody<D>& body : swarm.particles.bodies) {
      Vec<D> p{};
      double l = 0.0, inertia = 0.0;
      for (std::size_t k = 0; k < body.members.size(); ++k) {
        const Vec<D> a = body.pose.orientation.turn(body.frame[k]);
        const Vec<D>& v = swarm.particles.end_velocity[static_cast<std::size_t>(
            index[static_cast<std::size_t>(body.members[k])])];
        p += mass * v;
        l += mass * torque(a, v)[0];
        inertia += mass * dot(a, a);
      }
      linear += dot(p, p) / (mass * static_cast<double>(body.members.size())) / D;
      angular += l * l / inertia;
      samples += 1.0;
    }
  }
  EXPECT_NEAR(linear / samples, 1.0 - 3.0 / 42.0, 0.06);
  EXPECT_NEAR(angular / samples, 1.0, 0.06);
}

// Rods, with five freedoms in 3D: u_z^2 as Boltzmann has it, kinetic energies of three and of two times kT/2. From the spread
// over six seeds the standard errors are 0.005 of <u_z^2> and 1 % of the energies.
TEST(BodyTemperature, OfRodsIsThatOfTheFluid) {
  for (const double mass : {0.0, 1.0}) {
    support::TrappedRods rods(mass);
    const auto means = rods.run("trapezoidal", 0.02, 150, 3000);
    EXPECT_NEAR(means.tilt, support::TrappedRods::tilt(), 0.025) << mass;
    if (mass == 0.0) continue;
    EXPECT_NEAR(means.linear, 3.0, 0.05 * 3.0);
    EXPECT_NEAR(means.angular, 2.0, 0.05 * 2.0);
  }
}

}  // namespace
}  // namespace odpd
