#pragma once
// A periodic box of fluid on a shaken lattice for the tests of integrators; `walled` adds a row of particles that move
// with velocity (0.5, 0) along x.
#include <cmath>
#include <memory>

#include "odpd/dynamics/integrator.h"
#include "odpd/pairs/dpd.h"

namespace odpd {

class MovingRow : public NoSurroundings<2> {
 public:
  using NoSurroundings<2>::NoSurroundings;
  Vec<2> known_velocity(odpd::Group, double) const override { return {{0.5, 0.0}}; }
};

struct ToySettings {
  DpdParameters fluid{};
  ParticleConstants constants{};
  DynamicsSettings dynamics{};
  SolverOptions solver{.name = "pcg", .tolerance = 1e-10};
  bool walled = false;
  int side = 10;  ///< particles along each edge of the box, 0.5 apart
};

struct Toy {
  explicit Toy(const ToySettings& s)
      : box{{{0.5 * s.side, 0.5 * s.side}}, {true, true}}, model(1, {s.fluid}), row(s.constants) {
    for (int x = 0; x < s.side; ++x)
      for (int y = 0; y < s.side; ++y)
        particles.add(
            {{0.5 * x + 0.1 * std::sin(3.0 * x + y), 0.5 * y + 0.1 * std::cos(2.0 * x - y)}}, 0);
    for (Vec<2>& r : particles.position) box.wrap(r);
    if (s.walled)
      for (int x = 0; x < s.side; ++x) particles.add({{0.5 * x, 2.5}}, 0, odpd::Group::wall(0));
    dynamics = std::make_unique<Dynamics<2>>(box, particles, model, row, make_solver(s.solver),
                                             s.dynamics);
  }
  explicit Toy(double kT, bool walled = false,
               SolverOptions solver = {.name = "pcg", .tolerance = 1e-10})
      : Toy(ToySettings{.fluid = {.kT = kT}, .solver = std::move(solver), .walled = walled}) {}

  void run(Integrator<2>& integrator, Clock clock) {
    for (; !clock.finished(); clock.advance()) integrator.step(*dynamics, clock);
  }
  void run(const std::string& scheme, double dt, std::int64_t steps) {
    run(*make_integrator<2>(scheme), Clock{.dt = dt, .total_steps = steps});
  }

  Box<2> box;
  Particles<2> particles;
  DpdModel<2> model;
  MovingRow row;
  std::unique_ptr<Dynamics<2>> dynamics;
};

}  // namespace odpd
