#pragma once
// A scene: the particles in their box, the pair model, flat walls of frozen particles with a smooth potential behind
// their surface, obstacles and rigid bodies, molecules, and a body force. It is what the dynamics sees as its surroundings.
#include <memory>
#include <vector>

#include "odpd/dynamics/surroundings.h"
#include "odpd/pairs/kinetic_theory.h"
#include "odpd/scene/scene_settings.h"

namespace odpd {

template <int D>
class Scene : public Surroundings<D> {
 public:
  /// Builds the model, places walls and fluid, and relaxes overlaps. Throws ConfigError (box too small, more particles
  /// of a species than the fluid has, start positions outside the box, a model for another number of species).
  /// `ranks`, which must outlive it: they share the particles, and make the scene together.
  explicit Scene(SceneSettings<D> settings, const Communicator& ranks = Communicator::alone());

  const SceneSettings<D>& settings() const { return settings_; }
  const Box<D>& box() const { return settings_.box; }
  Particles<D>& particles() { return particles_; }
  const Particles<D>& particles() const { return particles_; }
  /// That of the settings, and the bonds.
  const PairModel<D>& model() const { return *model_; }

  /// Ends of the space between the wall surfaces (the box itself where it is periodic).
  Vec<D> fluid_low() const { return settings_.fluid_low(); }
  Vec<D> fluid_high() const { return settings_.fluid_high(); }
  double fluid_volume() const { return settings_.fluid_volume(); }
  double largest_kT() const { return largest_kT_; }
  /// What follows from the pairs of species alone: [A * species + B].
  const std::vector<PairMoments>& pair_moments() const { return pair_moments_; }
  /// The step up to which explicit repulsion is accurate, of pairs (pairs/pair_moments.h) and of densities: infinite where nothing
  /// repels, nothing where it is not known.
  std::optional<double> explicit_step_limit() const;
  /// Nothing takes momentum from the particles: no walls, no bodies of known motion and no uniform drag.
  bool conserves_momentum() const { return !settings_.held() && settings_.zeta_0 == 0.0; }
  /// Molecules in the order of their identities; their settings by `kind`.
  const std::vector<Molecule>& molecules() const { return molecules_; }
  /// All bonds: of the molecules, then of [bonds].
  const std::vector<Bond>& bonds() const { return bonds_; }
  /// The [[body]] that a body of the particles comes from.
  const BodySettings<D>& body_settings(std::size_t body) const {
    return settings_.bodies[body_kind_[body]];
  }
  std::size_t body_kind(std::size_t body) const { return body_kind_[body]; }

  ParticleConstants constants() const override {
    return {settings_.mass, settings_.zeta_0, largest_kT()};
  }
  void add_potential_forces(const Particles<D>& particles, std::span<const Vec<D>> positions,
                            std::vector<Vec<D>>& force) const override;
  double potential_energy_at(const Vec<D>& r) const override;
  double potential_energy(const Particles<D>& particles, std::span<const Vec<D>> positions,
                          std::vector<double>& laplacian) const override;
  void add_driving_forces(const Particles<D>& particles, std::span<const Vec<D>> positions,
                          double t, std::vector<Vec<D>>& force) const override;
  bool driving_varies() const override { return settings_.force_varies(); }
  Vec<D> known_velocity(Group group, double t) const override;
  RigidMotion<D> known_motion(std::size_t body, double t) const override;
  RigidLoad<D> body_load(std::size_t body, double t) const override;
  bool confine(Vec<D>& r) const override;

 private:
  void join_molecules();
  void start_flow();
  double wall_energy(const WallSettings<D>& wall, const Vec<D>& r) const;
  double depth_behind(const WallSettings<D>& wall, const Vec<D>& r) const;

  SceneSettings<D> settings_;
  std::shared_ptr<const PairModel<D>> model_;
  std::vector<PairMoments> pair_moments_;
  double largest_kT_;
  Particles<D> particles_;
  std::vector<Molecule> molecules_;
  std::vector<Bond> bonds_;
  std::vector<std::size_t> body_kind_;  // of each body: its [[body]]
};

}  // namespace odpd
