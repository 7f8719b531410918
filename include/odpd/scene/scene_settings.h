#pragma once
// What a scene is made of, as plain values; `read_scene_settings` fills it from a case file.
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "odpd/core/config.h"
#include "odpd/geometry/box.h"
#include "odpd/pairs/bonds.h"
#include "odpd/pairs/registry.h"
#include "odpd/scene/bodies.h"
#include "odpd/scene/flow_wave.h"
#include "odpd/scene/molecules.h"
#include "odpd/scene/start_region.h"

namespace odpd {

struct SpeciesSettings {
  std::string name = "fluid";
  double fraction = 1.0;    ///< of the fluid's particles; used where count < 0
  std::int64_t count = -1;  ///< exact number of fluid particles; -1: by fraction
  // Of Spin (particles/spin.h).
  double lever_radius = 0.0;  ///< length; 0: it does not spin
  double moment = 0.0;        ///< moment of inertia (mass length^2)
};

/// A sheet of frozen particles parallel to a wall's surface.
struct WallLayer {
  double depth = 0.0;      ///< behind the surface (length)
  std::int64_t count = 0;  ///< particles, evenly spaced (2D); 0: by spacing
  double spacing = 0.0;    ///< distance between them, rounded to fit the box (length)
};

/// One flat wall at an end of a bounded direction.
template <int D>
struct WallSettings {
  int axis = 1;            ///< direction of the normal
  bool high = false;       ///< at the upper end
  double thickness = 1.0;  ///< from the end of the box to the surface (length)
  Vec<D> velocity{};       ///< tangential (length/time)
  std::vector<WallLayer> layers;
  bool lattice =
      false;  ///< the layers fill it, so that where walls of two directions meet they are those of the first
  std::int32_t species = 0;
  /// Smooth potential u = stiffness/2 h^2 of a fluid particle a depth h > 0 behind the surface (force/length).
  double stiffness = 1000.0;
};

/// A force on the free particles with from <= r_axis < to.
template <int D>
struct ForceRegion {
  int axis = 0;
  double from = 0.0, to = 0.0;  ///< coordinates (length)
  Vec<D> force{};
};

enum class StartKind { random, lattice, file };

template <int D>
struct SceneSettings {
  std::uint64_t seed = 1;
  Box<D> box;
  std::vector<SpeciesSettings> species{SpeciesSettings{}};
  /// Of all pairs of species; a library user may give one of their own.
  std::shared_ptr<const PairModel<D>> model = default_pair_model<D>();
  std::int64_t count = -1;  ///< fluid particles; -1: by density
  double density = 4.0;  ///< fluid particles per volume where the fluid starts; not used with count
  double start_density = 0.0;  ///< what the start file must hold, where there is no count; 0: any
  double mass = 0.0;           ///< of every fluid particle
  double zeta_0 = 0.0;         ///< uniform drag on every fluid particle (mass/time)
  std::vector<WallSettings<D>> walls;
  std::vector<BodySettings<D>> bodies;
  std::vector<MoleculeSettings<D>> molecules;
  std::string bonds_file;    ///< of [bonds], resolved; empty: none
  BondParameters file_bond;  ///< of its bonds, where the file does not say
  /// Contents of that file, particles of the start file counted from 0.
  std::vector<Bond> start_bonds;
  Vec<D> body_force{};  ///< on every particle that moves, or amplitude of the wave (force)
  FlowWave force_wave;  ///< number 0: the force is uniform
  std::vector<ForceRegion<D>> force_regions;
  StartKind start = StartKind::random;
  std::optional<StartRegion<D>>
      start_region;        ///< where the fluid starts; none: all between the walls
  std::string start_file;  ///< for StartKind::file, resolved
  std::optional<std::int64_t> first_species;  ///< number of the first species in it, where given
  std::vector<Vec<D>> start_positions;        ///< contents of the start file, filled by io's caller
  std::vector<std::int32_t> start_species;    ///< one per start position
  /// Constituents of each body in the file, in the order of the particles' bodies; empty: bodies start as the case says.
  std::vector<std::vector<Vec<D>>> start_bodies;
  std::int64_t relax_sweeps = 100;  ///< of overlap removal before the run
  Vec<D> start_velocity{};          ///< amplitude of the flow at the start, with mass (length/time)
  FlowWave start_wave;              ///< number 0: none

  std::int64_t molecule_beads() const;  ///< of all molecules
  std::int64_t body_particles() const;  ///< of all bodies
  /// Something drives a flow, or has at the start: a force, a moving wall, a body that is moved or pushed, shear.
  bool driven() const;
  /// Walls, or bodies of known motion, hold the fluid and take up a net force.
  bool held() const;
  /// Whether a force or torque acts on a body.
  bool loaded() const;
  /// Driving force on a particle at r: body force or wave, and regions. Where nothing takes up a net force, the scene
  /// balances it on the free particles (Scene::add_driving_forces).
  Vec<D> force_at(const Vec<D>& r) const;
  /// It depends on r.
  bool force_varies() const { return force_wave.number > 0 || !force_regions.empty(); }
  /// It, or the flow at the start, has this component somewhere.
  bool forces_along(int component) const;
  /// A bound of its magnitude.
  double largest_force() const;
  int wall_at(int axis, bool high) const;  ///< index into walls, -1 when there is none
  /// Ends of the space between the wall surfaces (the box itself where it is periodic), and its volume.
  Vec<D> fluid_low() const;
  Vec<D> fluid_high() const;
  double fluid_volume() const;
  /// Of the region in which the fluid starts, and which `density` is of.
  double start_volume() const;
};

/// Reads [box], [fluid], [[species]], [[pair]], [[wall]], [[body]], [[molecule]], [bonds], [shear], [body_force], [start] and `seed`. Throws ConfigError for
/// values out of range and for contradictions (both gamma and sigma, a wall in a periodic direction, ...).
/// `calibration` is the contents of the file that fluid.calibration names, which io's caller reads.
template <int D>
SceneSettings<D> read_scene_settings(const Config& config,
                                     const std::optional<Calibration>& calibration = {});

/// The part of it that [[molecule]] and [bonds] are.
template <int D>
void read_molecules(const Config& config, SceneSettings<D>& scene);

/// Reads `hydrodynamic_radius` and `excluded_volume` of a [[molecule]], as read_body_sizes does.
template <int D>
void read_molecule_sizes(const Config& entry, const SceneSettings<D>& scene,
                         MoleculeSettings<D>& molecule);

/// Index of a species name; ConfigError at `key` listing the names.
std::int32_t species_index(const std::vector<SpeciesSettings>& species, const Config& where,
                           const std::string& key, const std::string& name);

}  // namespace odpd
