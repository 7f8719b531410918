#pragma once
// Friction and noise of DPD, for every model that brings only a conservative force of its own:
//
//   zeta_par = gamma w + gamma_far w_far,  zeta_perp = gamma_perp w,  w = (1 - r/r_c)^s,  w_far = (1 - r/r_far)^s
//
// The noise follows from the friction and kT.
#include <string>
#include <vector>

#include "odpd/core/config.h"
#include "odpd/pairs/network.h"
#include "odpd/pairs/weight.h"

namespace odpd {

/// Of one pair of species; units as in DpdParameters.
struct FrictionParameters {
  double gamma = 4.5;
  double gamma_perp = 0.0;
  double s = 0.5;
  double cutoff = 1.0;
  double kT = 1.0;
  double gamma_far = 0.0;
  double cutoff_far = 0.0;

  /// Where it ends: the larger of r_c and, with gamma_far, r_far.
  double reach() const { return gamma_far > 0.0 ? cutoff_far : cutoff; }
  /// Distances at which it is not smooth.
  std::vector<double> kinks() const {
    return gamma_far > 0.0 ? std::vector{cutoff, cutoff_far} : std::vector{cutoff};
  }
  friend bool operator==(const FrictionParameters&, const FrictionParameters&) = default;
};

/// How messages name the friction that resists a group of particles that turns as one: that of particles that spin does not.
inline constexpr const char* transverse_cure =
    "friction across lines of centres without spin (fluid.gamma_perp, with "
    "fluid.antisymmetric_stress = true)";

/// Throws ConfigError "parameter NAME = VALUE of a pair model must be RANGE" unless `ok`.
void require_parameter(bool ok, const char* name, double value, const char* range);
/// Throws ConfigError for values out of range.
void validate(const FrictionParameters& p);

/// kT, cutoff, s, gamma_perp and gamma or sigma, those of `base` where they are absent; of [fluid] (`whole`) kT and a friction
/// are required and rattler_friction is read too, a [[pair]] keeps both kT and it.
FrictionParameters read_friction(const Config& keys, const FrictionParameters& base, bool whole);

/// rattler_friction of [fluid], where it is: gamma_far and cutoff_far.
void read_far_friction(const Config& fluid, FrictionParameters& p);

/// Keys of [fluid] that set friction alone: the equilibrium distribution does not depend on them.
const std::vector<std::string>& friction_keys();

class Friction {
 public:
  explicit Friction(const FrictionParameters& p) : p_(p), w_(p.s) {}
  /// Sets kT, zeta_par and zeta_perp.
  void operator()(double r, PairTerms& t) const {
    t.kT = p_.kT;
    const double x = 1.0 - r / p_.cutoff;
    if (x > 0.0) {
      const double w = w_(x);
      t.zeta_par = p_.gamma * w;
      t.zeta_perp = p_.gamma_perp * w;
    }
    if (p_.gamma_far > 0.0 && r < p_.cutoff_far)
      t.zeta_par += p_.gamma_far * w_(1.0 - r / p_.cutoff_far);
  }

 private:
  FrictionParameters p_;
  PowerWeight w_;
};

}  // namespace odpd
