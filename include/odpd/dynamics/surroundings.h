#pragma once
// What a scene imposes on the particles, as the dynamics sees it: what free particles have in common, external
// potentials and forces, the prescribed motion of particles with known velocity, and the mirror that catches what
// should never arrive there.
#include <cstdint>
#include <span>
#include <vector>

#include "odpd/particles/particles.h"

namespace odpd {

/// The same for all free particles of a scene, through all of a run.
struct ParticleConstants {
  double mass = 0.0;
  double zeta_0 = 0.0;  ///< uniform drag, with its noise (mass/time)
  double kT = 1.0;      ///< of that noise, and the largest of the scene's pairs (energy)
};

template <int D>
class Surroundings {
 public:
  virtual ~Surroundings() = default;
  virtual ParticleConstants constants() const = 0;
  /// Adds the forces of potentials (smooth walls) on free particles.
  virtual void add_potential_forces(const Particles<D>& particles,
                                    std::span<const Vec<D>> positions,
                                    std::vector<Vec<D>>& force) const = 0;
  /// Energy of a free particle at r in these potentials.
  virtual double potential_energy_at(const Vec<D>& r) const = 0;
  /// Energy of this rank's particles in the potentials, and the Laplacian added for every particle (for the configurational
  /// temperature).
  virtual double potential_energy(const Particles<D>& particles, std::span<const Vec<D>> positions,
                                  std::vector<double>& laplacian) const = 0;
  /// Adds driving forces (body force) on the particles that move, at these positions at time t. All ranks call it together.
  virtual void add_driving_forces(const Particles<D>& particles, std::span<const Vec<D>> positions,
                                  double t, std::vector<Vec<D>>& force) const = 0;
  /// Those forces depend on position, so they have no linear potential.
  virtual bool driving_varies() const { return false; }
  /// Velocity at time t of wall `group` >= 1.
  virtual Vec<D> known_velocity(Group group, double t) const = 0;
  /// Motion at time t of a body that has a known one.
  virtual RigidMotion<D> known_motion(std::size_t /*body*/, double /*t*/) const { return {}; }
  /// Force and torque at time t on a body, besides those on its constituents.
  virtual RigidLoad<D> body_load(std::size_t /*body*/, double /*t*/) const { return {}; }
  /// Mirrors a free particle that left the box in a bounded direction back into it; true when it had.
  virtual bool confine(Vec<D>& r) const = 0;
};

/// A fully periodic scene without driving.
template <int D>
class NoSurroundings : public Surroundings<D> {
 public:
  NoSurroundings() = default;
  explicit NoSurroundings(const ParticleConstants& constants) : constants_(constants) {}
  ParticleConstants constants() const override { return constants_; }
  void add_potential_forces(const Particles<D>&, std::span<const Vec<D>>,
                            std::vector<Vec<D>>&) const override {}
  double potential_energy_at(const Vec<D>&) const override { return 0.0; }
  double potential_energy(const Particles<D>&, std::span<const Vec<D>>,
                          std::vector<double>&) const override {
    return 0.0;
  }
  void add_driving_forces(const Particles<D>&, std::span<const Vec<D>>, double,
                          std::vector<Vec<D>>&) const override {}
  Vec<D> known_velocity(Group, double) const override { return {}; }
  bool confine(Vec<D>&) const override { return false; }

 private:
  ParticleConstants constants_;
};

}  // namespace odpd
