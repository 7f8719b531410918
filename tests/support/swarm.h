#pragma once
// A fluid with two rigid bodies of one shape in it, in a periodic box.
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "odpd/dynamics/integrator.h"
#include "odpd/pairs/dpd.h"
#include "support/points.h"
#include "support/simplex.h"

namespace support {

using namespace odpd;  // of the library under test

template <int D>
struct Swarm {
  // Fluid on a lattice 0.7 apart with two bodies in it, in a periodic box.
  Swarm(const DpdParameters& fluid, double mass, int side, double tolerance = 1e-12,
        RigidBody<D> body = support::simplex_body<D>())
      : model(1, {fluid}), nothing({.mass = mass, .kT = fluid.kT}) {
    box.size = support::uniform_vec<D>(0.7 * side);
    box.periodic.fill(true);
    for (const double where : {0.25, 0.7}) {
      body.pose.centre = where * box.size;
      particles.add_body(body, box, 0);
    }
    std::int64_t sites = 1;
    for (int c = 0; c < D; ++c) sites *= side;
    const auto shake = support::random_vectors<D>(static_cast<std::size_t>(sites), 3);
    for (std::int64_t n = 0; n < sites; ++n) {
      Vec<D> r = 0.1 * shake[static_cast<std::size_t>(n)];
      std::int64_t rest = n;
      for (int c = 0; c < D; ++c, rest /= side) r[c] += 0.7 * static_cast<double>(rest % side);
      box.wrap(r);
      particles.add(r, 0);
    }
    DynamicsSettings settings;
    settings.reorder_every = 7;
    dynamics = std::make_unique<Dynamics<D>>(box, particles, model, nothing,
                                             make_solver({.name = "pcg", .tolerance = tolerance}),
                                             settings);
  }
  void run(const std::string& scheme, double dt, std::int64_t steps) {
    const auto integrator = make_integrator<D>(scheme);
    for (Clock clock{.dt = dt, .total_steps = steps}; !clock.finished(); clock.advance())
      integrator->step(*dynamics, clock);
  }
  // Positions by identity.
  std::vector<Vec<D>> positions() const {
    std::vector<Vec<D>> r;
    for (const std::int32_t i : particles.index_of_id())
      r.push_back(particles.position[static_cast<std::size_t>(i)]);
    return r;
  }
  double distance(const Swarm& other) const {
    double sum = 0.0;
    const auto a = positions(), b = other.positions();
    for (std::size_t k = 0; k < a.size(); ++k) {
      const Vec<D> d = box.separation(a[k], b[k]);
      sum += dot(d, d);
    }
    return std::sqrt(sum);
  }

  Box<D> box;
  Particles<D> particles;
  DpdModel<D> model;
  NoSurroundings<D> nothing;
  std::unique_ptr<Dynamics<D>> dynamics;
};

}  // namespace support
