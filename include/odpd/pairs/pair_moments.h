#pragma once
// What follows from pair(r) of two species alone, for any model. With [f] the integral of f over d-dimensional space,
//
//   random arrangement    energy per particle n/2 [u],  excess pressure n^2/(2 d) [r f_c]
//   explicit repulsion    is accurate to a step of about 0.2 zeta/k, and garbage from five times that; with mass at least a tenth of
//                         sqrt(m/k). zeta: the largest zeta_par. k: the largest of |k_c|(1 - r/r_e) and |f_c|/r_e, r_e the end of the
//                         force: what bends near the end, where little is left of the force, counts little. In DPD
//                         zeta/k = gamma r_c/(a max(1, s_bar)), gamma_far counted with gamma
//
// [f] is integrated between the model's kinks (core/quadrature.h). Where it diverges at r = 0 it is undefined.
//
// Of a model with densities, where it has a ReferenceState, f_c and k_c are those at its density, -(psi'(d_i) + psi'(d_j)) W' included; what
// the density itself does to them is in no pair.
//
// A hard core, where u, f_c or k_c is not finite at r = 0, is looked at from the distance r_core on at which u falls below 10 kT: nearer
// than that no pair comes. Without kT nothing tells how near they come.
#include <optional>
#include <vector>

#include "odpd/pairs/pair_model.h"

namespace odpd {

struct PairMoments {
  std::optional<double> energy;      ///< [u]
  std::optional<double> virial;      ///< [r f_c]
  std::optional<double> drag;        ///< [zeta_par + (d - 1) zeta_perp]
  std::optional<double> shear_par;   ///< [r^2 zeta_par]
  std::optional<double> shear_perp;  ///< [r^2 zeta_perp]
  /// [u] beyond r_core: defined for a hard core too.
  std::optional<double> energy_beyond_core;
  double kT = 0.0;
  // The largest ones, beyond r_core. Infinite where that is not known.
  double force = 0.0, stiffness = 0.0;  ///< |f_c|, and k above
  double zeta_par = 0.0, zeta_perp = 0.0;
  double force_range = 0.0;  ///< r_e (length)
  /// f_c does not go to 0 towards r_e, but for 1e-4 of the largest: there u' has a step, of which no stiffness tells, and the
  /// Laplacian of the energy no value.
  bool force_jumps = false;
  /// End of the force and of friction above a tenth of the largest: without the weak friction of longer range.
  double range = 0.0;
};

template <int D>
PairMoments pair_moments(const PairModel<D>& model, Site site_i, Site site_j);

/// Of all pairs of species: [A * species + B].
template <int D>
std::vector<PairMoments> pair_moments(const PairModel<D>& model, std::size_t species);

/// The step of explicit repulsion, above, of the stiffest pair: infinite where nothing repels, nothing where k is not known.
std::optional<double> explicit_step_limit(const std::vector<PairMoments>& pairs, double mass);

/// Of some pair.
bool some_force_jumps(const std::vector<PairMoments>& pairs);

/// Of all pairs.
double largest_kT(const std::vector<PairMoments>& pairs);

}  // namespace odpd
