#pragma once
// Friction and noise of DPD, for every model that brings only a conservative force of its own:
//
//   zeta_par = gamma w + gamma_far w_far,  zeta_perp = gamma_perp w,  w = x^s,  w_far = (1 - r/r_far)^s
//   x = 1 - (r - core)/(r_c - core) for core <= r < r_c,   1 nearer than the core
//
// Without a core x is 1 - r/r_c. One particle with a core is a colloid: a layer of the width r_c - core around it takes the
// fluid along. The noise follows from the friction and kT.
#include <algorithm>
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
  double core = 0.0;

  /// Where w falls from 1 to 0 (length).
  double width() const { return cutoff - core; }
  /// Where it ends: the larger of r_c and, with gamma_far, r_far.
  double reach() const { return gamma_far > 0.0 ? cutoff_far : cutoff; }
  /// Distances at which it is not smooth.
  std::vector<double> kinks() const {
    std::vector<double> r{cutoff};
    if (core > 0.0) r.insert(r.begin(), core);
    if (gamma_far > 0.0) r.push_back(cutoff_far);
    return r;
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
/// are required and rattler_friction is read too. A [[pair]] keeps both kT and it, and may have a core.
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
    const double x = 1.0 - (r - p_.core) / p_.width();
    if (x > 0.0) {
      const double w = w_(std::min(x, 1.0));
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
