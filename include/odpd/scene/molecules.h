#pragma once
// Molecules of a scene: particles of their own, free like the fluid's, joined by bonds: chains, and colloids of a few
// particles held by springs (Phan-Thien et al. 2016, sec. 4.3). Without bonds a molecule is one particle: a colloid where its species
// has a core and spins (Pan, Pivkin & Karniadakis 2008).
#include <string>
#include <vector>

#include "odpd/core/config.h"
#include "odpd/geometry/box.h"
#include "odpd/pairs/bonds.h"
#include "odpd/particles/particles.h"

namespace odpd {

/// One [[molecule]]: molecules of one shape.
template <int D>
struct MoleculeSettings {
  /// Bond between beads i and j of a molecule.
  struct Link {
    std::int64_t i = 0, j = 0;
    BondParameters p{};
  };
  std::string name = "molecule";
  std::vector<Vec<D>> shape;  ///< beads about their centre (length)
  double walk = 0.0;          ///< above 0: placed as a random walk of such steps instead (length)
  std::vector<std::string> species_names;  ///< one per bead; empty: the scene's first species
  std::vector<std::int32_t> species;       ///< one per bead
  std::vector<Link> bonds;
  double site_H =
      0.0;  ///< above 0: beads tied by such springs to a rigid frame of the shape (force/length)
  std::int64_t count = 1;         ///< at random positions, where there are no `positions`
  std::vector<Vec<D>> positions;  ///< of the centres, the shape as it stands there (length)
  /// Free space around a molecule at a random place, to the next one (length); 0: they may lie anywhere.
  double clearance = 0.0;
  // As of a [[body]] (scene/bodies.h); 0: not known.
  double hydrodynamic_radius = 0.0;  ///< (length)
  double excluded_volume = 0.0;      ///< (length^d)

  std::int64_t molecules() const {
    return positions.empty() ? count : static_cast<std::int64_t>(positions.size());
  }
  std::int64_t beads() const { return static_cast<std::int64_t>(shape.size()); }
};

/// One molecule: beads are the identities first, first + 1, ...
struct Molecule {
  std::size_t kind = 0;  ///< index of its [[molecule]]
  std::int64_t first = 0;
};

/// Reads one [[molecule]] but for `species` and its sizes. Throws ConfigError, also for a bond that is out of its reach in the shape, or
/// as long as half a periodic edge of the box.
template <int D>
MoleculeSettings<D> read_molecule(const Config& entry, const Box<D>& box);
/// law, H, r_0, r_max and exclude of a table; a bond `length` long at first (0: unknown). H and r_max may be absent where
/// `open`.
BondParameters read_bond(const Config& entry, double length, bool open = false);

/// All molecules in turn, where the first bead has the identity `first`.
template <int D>
std::vector<Molecule> list_molecules(const std::vector<MoleculeSettings<D>>& settings,
                                     std::int64_t first);
template <int D>
std::vector<Bond> bonds_of(const std::vector<MoleculeSettings<D>>& settings,
                           const std::vector<Molecule>& molecules);
/// The frames of those that have one.
template <int D>
std::vector<SiteFrame<D>> frames_of(const std::vector<MoleculeSettings<D>>& settings,
                                    const std::vector<Molecule>& molecules);
/// Adds the particles of all molecules, random ones between `low` and `high` in bounded directions and off rigid bodies.
/// Throws ConfigError where there is no room.
template <int D>
void place_molecules(const std::vector<MoleculeSettings<D>>& settings, const Box<D>& box,
                     const Vec<D>& low, const Vec<D>& high, std::uint64_t seed,
                     Particles<D>& particles);
/// Sets `image` so that unwrapped positions of bonded particles lie as close as the nearest images.
template <int D>
void join_images(const std::vector<Bond>& bonds, const Box<D>& box, Particles<D>& particles);

}  // namespace odpd
