#pragma once
// model = "gaussian": a core without a point (Stillinger 1976; Likos 2001 for polymers by their centres), cut at r_c,
//
//   u = a w (exp(-r^2/(2 w^2)) - exp(-r_c^2/(2 w^2)))   f_c = a r/w exp(-r^2/(2 w^2))   k_c = a/w (r^2/w^2 - 1) exp(-r^2/(2 w^2))
//
// The largest force is a exp(-1/2), at r = w. At r_c the force jumps by a r_c/w exp(-r_c^2/(2 w^2)): nothing to speak of from r_c = 5 w on.
#include "odpd/pairs/force_model.h"

namespace odpd {

struct GaussianForce {
  static constexpr const char* name = "gaussian";
  double a = 18.5;              ///< force/length at r = 0 is a/w (force)
  double w = 0.3;               ///< width (length)
  FrictionParameters friction;  ///< its cutoff is that of the force too

  void read(const Config& keys, bool whole);
  void validate() const;
  bool acts() const { return a > 0.0; }
  void force(double r, PairTerms& t) const;
  std::vector<std::pair<std::string, double>> values() const { return {{"a", a}, {"w", w}}; }
  bool operator==(const GaussianForce&) const = default;
};

}  // namespace odpd
