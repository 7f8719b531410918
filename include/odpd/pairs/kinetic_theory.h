#pragma once
// A fluid by kinetic theory without structure (g = 1, particles that follow the mean flow; Marsh 1998, Nguyen 2021), of any
// pair model. With [f] the integral of f over d-dimensional space (pairs/pair_moments.h):
//
//   pressure   p = n kT + n^2 [r f_c]/(2 d)
//   viscosity  eta = n^2 [r^2 (zeta_par + (d + 1) zeta_perp)]/(2 d (d+2)) + rho D/2; of the stress of the flow's direction across the gradient
//   diffusion  D = d kT/(n [zeta_par + (d - 1) zeta_perp]),  rho = n m
//
//   collisions w_0 = n [zeta_par + (d - 1) zeta_perp]/(d m),  l_0 = sqrt(kT/m)/w_0    (thesis 4.1, 4.2)
//   time       tau_P = R^2/D,  R = kT/(6 pi D eta_friction), 3D               (4.43) to (4.45)
//
// Where one of a pair spins (particles/spin.h), w follows the flow, w = 1/2 curl v, and the slip is that of the symmetric part of the
// velocity gradient. So in place of the viscosity above
//
//   viscosity   eta = n^2 [r^2 zeta_par]/(2 d (d+2)) + n^2 [r^2 zeta_perp]/(4 (d+2)) + rho D/2
//   rotational  eta_r = n^2 [r^2 zeta_perp]/(4 d):  4 eta_r |1/2 curl v - w|^2 is what a difference dissipates per volume
//   spin        relaxes to 1/2 curl v in n I/(4 eta_r),  I the moment of inertia
//
// The pressure of a model with densities is that of its ReferenceState, and so is what follows from it; its energy is undefined.
// In a mixture [...] are means over the pairs of species at random.
#include <vector>

#include "odpd/pairs/pair_moments.h"
#include "odpd/particles/spin.h"

namespace odpd {

/// What kinetic theory says of a fluid. Infinite: Sc, alpha, w_0 and speed_of_sound at mass = 0, alpha without force,
/// diffusion without friction, kappa_inverse and tau_P at kT = 0. Not a number: undefined, where an integral diverges, and
/// tau_P in 2D.
struct KineticTheory {
  double rho = 0.0;              ///< n m (mass/length^d)
  double eta_friction = 0.0;     ///< (3.8); an upper bound on that of friction alone
  double eta_kinetic = 0.0;      ///< rho D/2 (3.12)
  double eta_rotational = 0.0;   ///< eta_r; 0 where nobody spins
  double spin_relaxation = 0.0;  ///< n I/(4 eta_r), of the mean I (time)
  double diffusion = 0.0;        ///< D, of friction alone (length^2/time)
  double Sc = 0.0;               ///< eta()/(rho D): 1/2 above that of eta_friction
  double w_0 = 0.0;              ///< at which a particle forgets its velocity (1/time)
  double l_0 = 0.0;              ///< how far it gets in 1/w_0 at its thermal velocity (length)
  double tau_P = 0.0;            ///< in which it diffuses by its Stokes-Einstein radius (time)
  double alpha =
      0.0;  ///< largest zeta^2 r_e/(m |f_c|), of the pair of species where it is least (3.3)
  double energy = 0.0;          ///< per particle
  double pressure = 0.0;        ///< (3.1), (3.2) (energy/length^d)
  double bulk_modulus = 0.0;    ///< n dp/dn (energy/length^d)
  double kappa_inverse = 0.0;   ///< (dp/dn)/kT (3.4)
  double speed_of_sound = 0.0;  ///< sqrt((dp/dn)/m) (3.42)

  double eta() const { return eta_friction + eta_kinetic; }
};

/// `reference`: of a model with densities. `spins` by species; empty: nobody spins. `pairs` [A * species + B]; `fraction`: of the particles, by species.
template <int D>
KineticTheory kinetic_theory(const std::vector<PairMoments>& pairs,
                             const std::vector<double>& fraction, double density, double mass,
                             const std::optional<ReferenceState>& reference = std::nullopt,
                             const std::vector<Spin>& spins = {});

}  // namespace odpd
