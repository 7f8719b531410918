#pragma once
// Rods, rigid bodies on a line in 3D, in a trap along z among other particles, all without conservative forces between them: R
// couples them, and the exact distribution is that of each by itself,
//
//   U = k/2 sum_k z_k^2 = k/2 (n Z^2 + u_z^2 sum_k s_k^2),   s_k the places along the rod, u its direction.
#include <cmath>
#include <memory>
#include <string>

#include "odpd/dynamics/integrator.h"
#include "odpd/pairs/dpd.h"
#include "support/points.h"
#include "support/simplex.h"

namespace support {

using namespace odpd;  // of the library under test

class RodTrap : public NoSurroundings<3> {
 public:
  RodTrap(const ParticleConstants& constants, double stiffness, double centre)
      : NoSurroundings<3>(constants), stiffness_(stiffness), centre_(centre) {}
  double potential_energy_at(const Vec<3>& r) const override {
    return 0.5 * stiffness_ * (r[2] - centre_) * (r[2] - centre_);
  }
  void add_potential_forces(const Particles<3>&, std::span<const Vec<3>> positions,
                            std::vector<Vec<3>>& force) const override {
    for (std::size_t i = 0; i < positions.size(); ++i)
      force[i][2] -= stiffness_ * (positions[i][2] - centre_);
  }

 private:
  double stiffness_, centre_;
};

class TrappedRods {
 public:
  static constexpr double stiffness = 5.0;

  /// kT = 1.
  explicit TrappedRods(double mass, std::size_t rods = 40, std::size_t fluid = 80)
      : model_(1, {DpdParameters{.a = 0.0, .gamma = 1.0}}),
        trap_({.mass = mass, .zeta_0 = 2.0}, stiffness, 4.0) {
    const Vec<3> low{{0.0, 0.0, 3.5}}, high{{edge, edge, 4.5}};
    const auto angles = random_vectors<3>(rods, 3);
    const auto centres = random_points<3>(low, high, rods, 4);
    RigidBody<3> rod = rod_body<3>();
    for (std::size_t b = 0; b < rods; ++b) {
      rod.pose.centre = centres[b];
      rod.pose.orientation.advance(3.0 * angles[b]);
      particles.add_body(rod, box_, 0);
    }
    for (const Vec<3>& r : random_points<3>(low, high, fluid, 5)) particles.add(r, 0);
    dynamics_ = std::make_unique<Dynamics<3>>(box_, particles, model_, trap_,
                                              make_solver({.name = "pcg", .tolerance = 1e-6}),
                                              DynamicsSettings{});
  }

  /// Equilibrium means of u_z^2 and, with mass, of the kinetic energies of centre and rotation in units of kT/2.
  struct Means {
    double tilt = 0.0, linear = 0.0, angular = 0.0;
  };
  Means run(const std::string& scheme, double dt, std::int64_t equilibration, std::int64_t steps) {
    const auto integrator = make_integrator<3>(scheme);
    Means sum;
    Clock clock{.dt = dt, .total_steps = equilibration + steps};
    for (clock.equilibration_steps = equilibration; !clock.finished(); clock.advance()) {
      integrator->step(*dynamics_, clock);
      if (clock.step >= equilibration) add(sum);
    }
    const double share =
        1.0 / static_cast<double>(steps) / static_cast<double>(particles.bodies.size());
    return {share * sum.tilt, share * sum.linear, share * sum.angular};
  }
  /// Of u_z^2, exactly.
  static double tilt() {
    double square = 0.0, of_tilt = 0.0, all = 0.0;
    for (const double s : rod_places) square += s * s;
    for (double u = 0.0005; u < 1.0; u += 0.001) {
      const double weight = std::exp(-0.5 * stiffness * square * u * u);
      all += weight;
      of_tilt += u * u * weight;
    }
    return of_tilt / all;
  }

  Particles<3> particles;

 private:
  void add(Means& sum) const {
    const std::vector<std::int32_t> index_of = particles.index_of_id();
    const double mass = trap_.constants().mass, n = rod_places.size();
    for (const RigidBody<3>& body : particles.bodies) {
      Vec<3> u = body.pose.orientation.turn(body.frame.back());
      u *= 1.0 / norm(u);
      sum.tilt += u[2] * u[2];
      if (mass == 0.0) continue;
      Vec<3> p{}, l{};
      double inertia = 0.0;
      for (std::size_t k = 0; k < body.members.size(); ++k) {
        const Vec<3>& v = particles.end_velocity[index(index_of[index(body.members[k])])];
        p += mass * v;
        l += mass * rod_places[k] * torque(u, v);
        inertia += mass * rod_places[k] * rod_places[k];
      }
      sum.linear += dot(p, p) / (n * mass);
      sum.angular += dot(l, l) / inertia;
    }
  }

  static constexpr double edge = 8.0;
  Box<3> box_{uniform_vec<3>(edge), {true, true, true}};
  DpdModel<3> model_;
  RodTrap trap_;
  std::unique_ptr<Dynamics<3>> dynamics_;
};

}  // namespace support
