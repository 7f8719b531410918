#pragma once
// A pair model looks at two particles and writes one edge; nothing else in the code knows which model it was.
#include <span>

#include "odpd/geometry/pair_list.h"
#include "odpd/pairs/densities.h"
#include "odpd/pairs/network.h"
#include "odpd/pairs/site.h"
#include "odpd/particles/particles.h"

namespace odpd {

template <int D>
class PairModel {
 public:
  virtual ~PairModel() = default;
  /// Largest distance at which a pair interacts (length).
  virtual double cutoff() const = 0;
  /// Terms of one pair at distance r >= 0; all zero beyond the cutoff. In a model with densities its energy, force and
  /// stiffness are those of the pair part u alone, and its friction is that at the densities of the sites.
  virtual PairTerms pair(double r, Site site_i, Site site_j) const = 0;
  /// Replaces `network` by the edges of all pairs of the list closer than the cutoff at these positions.
  virtual void write_edges(const PairList<D>& list, const Box<D>& box,
                           std::span<const Vec<D>> positions, const Particles<D>& particles,
                           PairNetwork<D>& network) const = 0;
  /// What the energy has beyond pairs, as long as the model lives; null in models of pairs.
  virtual const Densities* densities() const { return nullptr; }
  /// Some pair has a conservative force (a > 0); otherwise energy and pressure are those of an ideal gas.
  virtual bool conservative() const = 0;
  /// Some pair has kT > 0.
  virtual bool thermal() const = 0;
  /// What bonds add to the energy of particle i at r among the others (and exclusions take from it); infinite where one does
  /// not reach.
  virtual double bonded_energy(std::size_t, const Vec<D>&, const Box<D>&,
                               const Particles<D>&) const {
    return 0.0;
  }
};

}  // namespace odpd
