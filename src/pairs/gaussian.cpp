#include "odpd/pairs/gaussian.h"

#include <cmath>

namespace odpd {

void GaussianForce::read(const Config& keys, bool whole) {
  a = whole ? keys.non_negative("a") : keys.non_negative("a", a);
  w = whole ? keys.positive("w") : keys.positive("w", w);
}

void GaussianForce::validate() const {
  require_parameter(a >= 0.0, "a", a, "zero or positive");
  require_parameter(w > 0.0, "w", w, "positive");
}

void GaussianForce::force(double r, PairTerms& t) const {
  const auto bell = [this](double x) { return std::exp(-0.5 * x * x / (w * w)); };
  t.u = a * w * (bell(r) - bell(friction.cutoff));
  t.f_c = a * r / w * bell(r);
  t.k_c = a / w * (r * r / (w * w) - 1.0) * bell(r);
}

}  // namespace odpd
