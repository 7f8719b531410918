#pragma once
// Weight functions w(r) = (1 - r/r_c)^p for r < r_c, 0 beyond (Phan-Thien et al. 2016, after eq. 7; w_D with p = s,
// w_C with p = s_bar). The common powers 1/2, 1 and 2 avoid std::pow.
#include <cmath>

namespace odpd {

class PowerWeight {
 public:
  explicit PowerWeight(double exponent = 1.0)
      : exponent_(exponent),
        kind_(exponent == 0.5   ? Kind::half
              : exponent == 1.0 ? Kind::one
              : exponent == 2.0 ? Kind::two
                                : Kind::any) {}

  double exponent() const { return exponent_; }

  /// x^p for x = 1 - r/r_c in (0, 1].
  double operator()(double x) const {
    switch (kind_) {
      case Kind::half:
        return std::sqrt(x);
      case Kind::one:
        return x;
      case Kind::two:
        return x * x;
      case Kind::any:
        break;
    }
    return std::pow(x, exponent_);
  }

 private:
  enum class Kind { half, one, two, any };
  double exponent_;
  Kind kind_;
};

}  // namespace odpd
