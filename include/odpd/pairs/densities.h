#pragma once
// Densities: what the energy of a model may have beyond its pairs,
//
//   E = sum_pairs u(r_ij) + sum_i psi(d_i),   d_i = w_0 + sum_{j != i} W(r_ij)
//
// Both sums go over all particles, those of known velocity and constituents of bodies too. W is the same for both particles of
// a pair; it vanishes smoothly at the cutoff. The force on i along e is central, but not all of its Laplacian is of pairs:
//
//   f_c = -u' - (psi'(d_i) + psi'(d_j)) W'      k_c = u'' + (psi'(d_i) + psi'(d_j)) W''
//   L_i = sum_j [k_c - (D - 1) f_c/r + psi''(d_j) W'^2] + psi''(d_i) |sum_j W' e|^2
//
// (force: Espanol & Revenga 2003; Warren 2003). k_c is what an edge has of the stiffness. The rest, with psi'', couples
// partners of partners and is in no edge.
#include "odpd/pairs/site.h"

namespace odpd {

/// A function of one number, and its first two derivatives there.
struct Derivatives {
  double value = 0.0, first = 0.0, second = 0.0;
};

/// The functions of one model.
class Densities {
 public:
  virtual ~Densities() = default;
  /// w_0, what a particle counts for itself: W(0) or 0.
  virtual double self(Site site) const = 0;
  /// W at distance r >= 0, from the species alone; zero beyond the model's cutoff.
  virtual Derivatives weight(double r, Site site_i, Site site_j) const = 0;
  /// psi at the site's density (energy).
  virtual Derivatives energy(Site site) const = 0;
};

}  // namespace odpd
