#pragma once
// A DPD fluid by its physical properties (Nguyen 2021, eq. 3.1-3.20), from kinetic theory without structure (g = 1,
// particles that follow the mean flow; Marsh 1998). With [f] the integral of f over d-dimensional space:
//
//   pressure       p = n kT + n^2 [R f_C]/(2 d)                         (3.1), (3.2)
//   compressibility  kappa^-1 = (dp/dn)/kT                              (3.4)  ->  s_bar (3.6), (3.7), or a
//   time scales    alpha = gamma^2 r_c/(m a)                            (3.3)  ->  a (3.5)
//   viscosity      eta = gamma n^2 [R^2 w_D]/(2 d (d+2))                (3.8)  ->  gamma (3.14), (3.18); s = 1/2: (3.9), (3.10)
//   dynamics       Sc = eta/(rho D),  D = d kT/(n gamma [w_D]),  rho = n m  (3.12)  ->  s (3.13), (3.17)
//                  or, in 3D, tau_P = R^2/D,  R = kT/(6 pi D eta)           (4.43), (4.44)  ->  s (4.48), (4.49)
//
// tau_P is the time in which a particle of the Stokes-Einstein radius R diffuses by R: (kT)^2/(36 pi^2 D^3 eta^2) (4.45). No
// mass is in it, so it sets s of a massless fluid too, for which Sc is infinite. In 2D there is no such radius: eta D/kT is
// a pure number.
//
// The reverse, what kinetic theory says of a fluid: pairs/kinetic_theory.h. Of the friction the formulas count gamma alone,
// not gamma_perp and gamma_far. These are estimates: the viscosity of friction alone is at most eta, and much less at small
// mass and density.
#include <optional>
#include <string>

#include "odpd/core/error.h"
#include "odpd/pairs/dpd_parameters.h"

namespace odpd {

/// [R^power (1 - R/r_c)^exponent] = S r_c^m B(m, exponent + 1), m = power + d, S the surface of the unit sphere.
template <int D>
double weight_moment(int power, double exponent, double cutoff);

/// tau_P (4.45) of a fluid of this viscosity and self-diffusion; not a number in 2D.
template <int D>
double diffusion_time(double kT, double diffusion, double eta);

/// What is asked of a fluid; what is absent stays as its DPD parameters say.
struct PhysicalInputs {
  std::optional<double> eta;    ///< viscosity of friction (energy time/length^d), sets gamma
  std::optional<double> Sc;     ///< Schmidt number, sets s
  std::optional<double> tau_P;  ///< diffusion time of a particle (time), sets s in place of Sc; 3D
  std::optional<double> alpha;  ///< ratio of relaxation to inertia time, sets a
  std::optional<double> kappa_inverse;  ///< dp/dn over kT, sets s_bar, or a where `keep_s_bar`
  bool keep_s_bar = false;              ///< a follows from kappa_inverse and s_bar; not with alpha

  bool any() const { return eta || Sc || tau_P || alpha || kappa_inverse; }
};

/// A condition of the formulas is not met; `key` is the input to blame.
class PhysicalInputError : public ConfigError {
 public:
  PhysicalInputError(std::string key, const std::string& message)
      : ConfigError(key + ": " + message), key_(std::move(key)), message_(message) {}
  const std::string& key() const { return key_; }
  const std::string& message() const { return message_; }  ///< without the key

 private:
  std::string key_, message_;
};

/// The DPD parameters of a fluid with these properties at number density n (1/length^d) and particle mass: gamma, s, a
/// and s_bar where `inputs` set them, everything else that of `base`. Throws PhysicalInputError: inputs out of range,
/// other inputs without eta, alpha or Sc at mass = 0, Sc, tau_P or kappa_inverse at kT = 0, tau_P in 2D or with Sc,
/// kappa_inverse <= 1, and conditions for s > 0 (3.16, 3.20, 4.50) and s_bar > 0 (C > 24 in 3D, 6 in 2D).
template <int D>
DpdParameters dpd_parameters(const PhysicalInputs& inputs, const DpdParameters& base,
                             double density, double mass);

}  // namespace odpd
