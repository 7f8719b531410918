#pragma once
// Random fluids of particles that spin, frozen: an operator at one configuration. (Moving ones: spinning.h.)
#include <algorithm>
#include <cmath>

#include "odpd/operator/spin_resistance.h"
#include "odpd/pairs/levers.h"
#include "support/network.h"

namespace support {

struct SpinFluidSpec {
  std::size_t count = 1000;
  bool walls =
      false;  ///< x is bounded, and what lies in its first and last unit is at rest and does not spin
  double gamma_perp = 4.5;
  double spinning = 1.0;       ///< part of the free particles
  double radius_spread = 0.0;  ///< lever radii from 0.5 to 0.5 + this, in ten steps
  double inertia = 0.0;        ///< 2 m/dt, and 0.3 of it on spins
  double s = 0.5;              ///< exponent of w_D
  bool held = false;           ///< the centre of mass
  double density = 8.0;
  std::uint64_t seed = 3;
};

/// Their particles and edges.
template <int D>
struct SpinParticles : Fluid<D> {
  explicit SpinParticles(const SpinFluidSpec& spec)
      : Fluid<D>(std::pow(static_cast<double>(spec.count) / spec.density, 1.0 / D), true) {
    constexpr std::size_t radii = 10;
    if (spec.walls) this->box.periodic[0] = false;
    const double length = this->box.size[0];
    // Species 0 does not spin.
    this->particles.spin_of_species.resize(1 + radii);
    for (std::size_t k = 0; k < radii; ++k) {
      const double radius = 0.5 + spec.radius_spread * static_cast<double>(k) / radii;
      this->particles.spin_of_species[1 + k] = {radius, 0.3 * radius * radius};
    }
    const odpd::CounterRandom random(spec.seed, odpd::Stream::probe);
    std::uint64_t which = 0;
    for (const auto& r : random_points<D>({}, this->box.size, spec.count, spec.seed)) {
      const auto u = random.uniforms(2, 0, which++, 0);
      const bool at_rest = spec.walls && (r[0] < 1.0 || r[0] > length - 1.0);
      const bool spins = !at_rest && u[0] < spec.spinning;
      const auto radius = std::min(radii - 1, static_cast<std::size_t>(u[1] * radii));
      this->particles.add(r, spins ? static_cast<int>(1 + radius) : 0,
                          at_rest ? odpd::Group::wall(0) : odpd::Group());
    }
    odpd::DpdParameters p;
    p.gamma_perp = spec.gamma_perp;
    p.s = spec.s;
    const auto species = 1 + radii;
    this->connect(odpd::DpdModel<D>(static_cast<int>(species),
                                    std::vector<odpd::DpdParameters>(species * species, p)));
    odpd::write_levers(this->particles, this->network);
  }
};

template <int D>
struct SpinFluid {
  explicit SpinFluid(const SpinFluidSpec& spec)
      : fluid(spec), dofs(fluid.particles, 1.0), resistance(fluid.box, spec.held) {
    resistance.rebuild(fluid.network, dofs, fluid.particles, fluid.particles.position, {},
                       {.inertia = spec.inertia});
  }
  const odpd::System& system() const { return resistance.system(); }
  const odpd::Resistance<D>& velocities() const { return resistance.velocities().mobile(); }

  SpinParticles<D> fluid;
  odpd::DofMap<D> dofs;
  odpd::SpinResistance<D> resistance;
};

}  // namespace support
