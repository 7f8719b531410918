#pragma once
// Pair models given by a function of the distance, the same for all species.
#include <cmath>
#include <functional>
#include <memory>

#include "odpd/pairs/friction.h"
#include "odpd/pairs/inline_model.h"

namespace support {

template <int D>
class FunctionModel : public odpd::InlineModel<D, FunctionModel<D>> {
 public:
  using Force = std::function<void(double r, odpd::PairTerms& t)>;  // sets u, f_c and k_c

  FunctionModel(Force force, const odpd::FrictionParameters& friction)
      : force_(std::move(force)), friction_(friction), p_(friction) {}
  odpd::PairTerms terms(double r, odpd::Site, odpd::Site) const {
    odpd::PairTerms t;
    friction_(r, t);
    if (r < p_.cutoff) force_(r, t);
    return t;
  }
  std::string name() const override { return "function"; }
  double cutoff() const override { return p_.reach(); }
  std::vector<double> kinks(odpd::Site, odpd::Site) const override { return p_.kinks(); }
  bool conservative() const override { return true; }
  bool thermal() const override { return p_.kT > 0.0; }

 private:
  Force force_;
  odpd::Friction friction_;
  odpd::FrictionParameters p_;
};

/// f_c = A (r/w) exp(-r^2/(2 w^2)), energy 0 at the cutoff 1.
template <int D>
std::shared_ptr<const odpd::PairModel<D>> gaussian(double A, double w, double kT) {
  const auto force = [A, w](double r, odpd::PairTerms& t) {
    const double e = std::exp(-0.5 * r * r / (w * w));
    t.u = A * w * (e - std::exp(-0.5 / (w * w)));
    t.f_c = A * r / w * e;
    t.k_c = A / w * (r * r / (w * w) - 1.0) * e;
  };
  return std::make_shared<FunctionModel<D>>(force, odpd::FrictionParameters{.kT = kT});
}

/// u = 4 epsilon ((l/r)^12 - (l/r)^6), l = 0.4, shifted to 0 at the cutoff 1.
template <int D>
std::shared_ptr<const odpd::PairModel<D>> lennard_jones(double epsilon, double kT) {
  const auto force = [epsilon](double r, odpd::PairTerms& t) {
    const auto sixth = [](double x) { return std::pow(0.4 / x, 6); };
    const double s = sixth(r);
    t.u = 4.0 * epsilon * (s * s - s - (sixth(1.0) * sixth(1.0) - sixth(1.0)));
    t.f_c = 4.0 * epsilon * (12.0 * s * s - 6.0 * s) / r;
    t.k_c = 4.0 * epsilon * (156.0 * s * s - 42.0 * s) / (r * r);
  };
  return std::make_shared<FunctionModel<D>>(force, odpd::FrictionParameters{.kT = kT});
}

}  // namespace support
