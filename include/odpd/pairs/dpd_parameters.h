#pragma once
// The numbers of a DPD fluid; their formulas: pairs/dpd.h.
#include "odpd/pairs/friction.h"

namespace odpd {

/// Parameters of one pair of species.
struct DpdParameters {
  double a = 18.5;          ///< repulsion (force)
  double s_bar = 1.0;       ///< exponent of w_C
  double gamma = 4.5;       ///< friction along the line of centres (mass/time)
  double gamma_perp = 0.0;  ///< friction across it (mass/time)
  double s = 0.5;           ///< exponent of w_D
  double cutoff = 1.0;      ///< r_c (length)
  double kT = 1.0;          ///< temperature (energy)
  double gamma_far = 0.0;   ///< weak friction of longer range (mass/time)
  double cutoff_far = 0.0;  ///< its range r_far (length)
  double core = 0.0;        ///< distance from which on both weights fall from 1 (length)

  FrictionParameters friction() const {
    return {gamma, gamma_perp, s, cutoff, kT, gamma_far, cutoff_far, core};
  }
  friend bool operator==(const DpdParameters&, const DpdParameters&) = default;
};

}  // namespace odpd
