#pragma once
// Filling a scene: frozen wall layers, fluid particles from random positions, a lattice or a file, and the removal of
// overlaps by damped descent in the energy (no friction matrix needed, so it works before any solve can).
#include <functional>
#include <vector>

#include "odpd/dynamics/surroundings.h"
#include "odpd/pairs/pair_model.h"
#include "odpd/scene/scene_settings.h"

namespace odpd {

/// Adds the particles of all walls, group k + 1 for walls[k].
template <int D>
void place_walls(const SceneSettings<D>& settings, Particles<D>& particles);

/// Adds the free particles in the region of the start, or without one between `low` and `high`; or those of the start file, among them
/// the beads of molecules.
template <int D>
void place_fluid(const SceneSettings<D>& settings, const Vec<D>& low, const Vec<D>& high,
                 Particles<D>& particles);

/// Gives the free particles Maxwell velocities of variance kT/mass per component, on top of a `flow`; where nothing takes
/// momentum away (`conserved`) their mean is zero; and angular velocities of variance kT/I, where they spin with a moment of inertia I.
/// With mass 0 nothing.
template <int D>
void draw_velocities(std::uint64_t seed, double kT, double mass, bool conserved,
                     const std::function<Vec<D>(const Vec<D>&)>& flow, Particles<D>& particles);

/// `sweeps` times: every free particle moves along its force F by |F| / (sum of its stiffnesses), at most r_c/20.
template <int D>
void relax(const Box<D>& box, const PairModel<D>& model, const Surroundings<D>& surroundings,
           std::int64_t sweeps, Particles<D>& particles);

}  // namespace odpd
