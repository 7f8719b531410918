#pragma once
// A pair model looks at two particles and writes one edge; nothing else in the code knows which model it was. Its contract, to which
// tests/pairs/test_pair_contract.cpp and tests/physics/test_pair_models.cpp hold every row of the name table (pairs/registry.cpp):
//
//   f_c = -u' and k_c = -f_c' between the kinks. u is continuous and so 0 at the cutoff; f_c may jump there, but then the
//   configurational temperature is undefined.
//   From the cutoff on all terms but kT are 0.
//   zeta_par, zeta_perp and kT are not negative. None of the terms depends on which of the two particles comes first.
//   write_edges gives each edge what pair(r) says of it, in the same bits on any number of threads. The step asks nothing else of
//   the force, so motion samples what Monte Carlo samples, which takes u alone.
//   Where the model has no numbers, u is infinite: trial moves do not go there, and refuse_unknown ends a stage that does. Nothing is
//   ever not a number.
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "odpd/geometry/pair_list.h"
#include "odpd/pairs/densities.h"
#include "odpd/pairs/network.h"
#include "odpd/pairs/site.h"
#include "odpd/particles/particles.h"

namespace odpd {

/// Numbers of a model for reports: those of [fluid], before any [[pair]].
struct ModelParameters {
  std::string heading = "parameters";
  std::vector<std::pair<std::string, double>> values;
};

/// A fluid of densities as its model means it, where integrals over pairs do not tell (pairs/pair_moments.h).
struct ReferenceState {
  double density = 0.0;  ///< d of its particles
  /// density^(-1/d) where particles fill space, those of walls and bodies as the fluid's; else 0.
  double spacing = 0.0;
  double pressure = 0.0;      ///< without n kT (energy/length^d)
  double bulk_modulus = 0.0;  ///< n dp/dn, without n kT (energy/length^d)
  // Of explicit forces (time); infinite where nothing repels.
  double accurate_step = 0.0;  ///< up to which they are accurate
  double stable_step = 0.0;    ///< from which on they are garbage
};

/// Immutable once made: scenes share it.
template <int D>
class PairModel {
 public:
  virtual ~PairModel() = default;
  /// As fluid.model has it; for messages and reports.
  virtual std::string name() const { return "custom"; }
  /// How many species it has parameters for; 0: any number, they are all alike.
  virtual int species() const { return 0; }
  /// Largest distance at which a pair interacts (length).
  virtual double cutoff() const = 0;
  /// Of each pair of species [A * species + B], the distance beyond which it has no edge (length); empty: that is the cutoff for all.
  virtual std::span<const double> reaches() const { return {}; }
  /// Terms of one pair at distance r >= 0; all but kT, which does not depend on r, are zero beyond the cutoff. In a model with
  /// densities its energy, force and stiffness are those of the pair part u alone, and its friction is that at the densities
  /// of the sites.
  virtual PairTerms pair(double r, Site site_i, Site site_j) const = 0;
  /// Where a term of this pair of species is not smooth in r > 0, ascending, the end of its last term among them: integrals over r
  /// stop there.
  virtual std::vector<double> kinks(Site, Site) const { return {cutoff()}; }
  /// Replaces `network` by the edges of all pairs of the list closer than the reach of their species at these positions.
  virtual void write_edges(const PairList<D>& list, const Box<D>& box,
                           std::span<const Vec<D>> positions, const Particles<D>& particles,
                           PairNetwork<D>& network) const = 0;
  /// Throws BlowUpError where `network` holds a pair of infinite u, and says what the model lacks there. Called once the edges
  /// of a stage are written, not while a start is relaxed: it may begin so.
  virtual void refuse_unknown(const PairNetwork<D>&, const Particles<D>&) const {}
  /// What the energy has beyond pairs, as long as the model lives; null in models of pairs.
  virtual const Densities* densities() const { return nullptr; }
  /// Of particles of this mass. Nothing in models of pairs, and where the model does not know.
  virtual std::optional<ReferenceState> reference_state(double /*mass*/) const {
    return std::nullopt;
  }
  /// How far a particle may come at its thermal speed in one step, sqrt(kT/m) dt (length): a larger step is warned of. Infinite where
  /// repulsion and friction alone limit steps.
  virtual double thermal_path() const { return std::numeric_limits<double>::infinity(); }
  /// That of particles that spin where a case gives none (length); 0: they do not spin unless it does (particles/spin.h).
  virtual double lever_radius() const { return 0.0; }
  /// Some pair has a conservative force; otherwise energy and pressure are those of an ideal gas.
  virtual bool conservative() const = 0;
  /// Some pair has kT > 0.
  virtual bool thermal() const = 0;
  /// What bonds add to the energy of particle i at r among the others (and exclusions take from it); infinite where one does
  /// not reach.
  virtual double bonded_energy(std::size_t, const Vec<D>&, const Box<D>&,
                               const Particles<D>&) const {
    return 0.0;
  }
  /// Bonds take this pair's energy out again.
  virtual bool excludes(std::size_t, std::size_t, const Particles<D>&) const { return false; }
  virtual ModelParameters parameters() const { return {}; }
};

}  // namespace odpd
