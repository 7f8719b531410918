#pragma once
// Particles of several lever radii at random places that move: with a Dynamics of their own, for integrators. (Frozen ones, for
// operators and solvers: spin_fluid.h.)
#include <memory>
#include <optional>
#include <vector>

#include "odpd/dynamics/integrator.h"
#include "odpd/operator/edge_sums.h"
#include "odpd/pairs/dpd.h"
#include "support/points.h"

namespace support {

using namespace odpd;  // of the library under test

struct SpinningSettings {
  DpdParameters fluid{.a = 10.0, .gamma = 3.0, .gamma_perp = 2.0};
  std::vector<double> radii{0.3, 1.0, 0.55};  ///< of as many species; of one alone 0: nobody spins
  double mass = 0.0, moment = 0.0;
  std::size_t count = 30;
  double edge = 1.6;      ///< of the cube that they start in
  bool periodic = false;  ///< otherwise they float in the middle of an open box
  std::optional<Shear> shear = {};
  double tolerance = 1e-12;
};

template <int D>
struct Spinning {
  explicit Spinning(const SpinningSettings& s)
      : model(static_cast<int>(s.radii.size()),
              std::vector(s.radii.size() * s.radii.size(), s.fluid)),
        none({.mass = s.mass, .kT = s.fluid.kT}) {
    const double margin = s.periodic ? 0.0 : 3.0;
    box.size = uniform_vec<D>(s.edge + 2.0 * margin);
    box.periodic.fill(s.periodic);
    box.shear = s.shear;
    box = box.at(0.0);
    if (s.radii.size() > 1 || s.radii[0] > 0.0)
      for (const double R : s.radii) particles.spin_of_species.push_back({R, s.moment});
    const auto places =
        random_points<D>(uniform_vec<D>(margin), uniform_vec<D>(margin + s.edge), s.count, 5);
    for (std::size_t k = 0; k < places.size(); ++k)
      particles.add(places[k], static_cast<std::int32_t>(k % s.radii.size()));
    dynamics = std::make_unique<Dynamics<D>>(box, particles, model, none,
                                             make_solver({.name = "pcg", .tolerance = s.tolerance}),
                                             DynamicsSettings{});
  }

  /// Friction and conservative force on i of each edge of a stage.
  std::vector<Vec<D>> edge_forces(const Stage<D>& stage) const {
    std::vector<Vec<D>> force;
    for (std::size_t k = 0; k < stage.network.r.size(); ++k)
      force.push_back(
          stage.network.push(k) +
          friction_of(stage.network, k, stage.network.slip(k, stage.velocity, stage.spin)));
    return force;
  }
  /// sum m r x v + I w, of particles at r.
  Vec<D> angular_momentum(const std::vector<Vec<D>>& r, const std::vector<Vec<D>>& v,
                          const std::vector<Vec<D>>& w) const {
    Vec<D> sum{};
    for (std::size_t i = 0; i < r.size(); ++i)
      sum += none.constants().mass * torque(r[i], v[i]) +
             particles.spin_of_species[index(particles.species[i])].moment * w[i];
    return sum;
  }

  Box<D> box;
  Particles<D> particles;
  DpdModel<D> model;
  NoSurroundings<D> none;
  std::unique_ptr<Dynamics<D>> dynamics;
};

}  // namespace support
