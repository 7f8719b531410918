#include "odpd/app/calibrated_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "odpd/core/index.h"
#include "odpd/pairs/dpd.h"
#include "odpd/pairs/kinetic_theory.h"
#include "odpd/pairs/pair_moments.h"

namespace odpd {

namespace {

class CalibratedDpd : public CalibratedModel {
 public:
  CalibratedDpd(const DpdParameters& p, int dimension, double density)
      : p_(p), dimension_(dimension), density_(density) {}

  std::string key() const override { return "gamma"; }
  double friction() const override { return p_.gamma; }
  double kT() const override { return p_.kT; }
  double cutoff() const override { return p_.cutoff; }
  std::vector<std::pair<std::string, double>> inputs() const override {
    return {{"kT", p_.kT},
            {"cutoff", p_.cutoff},
            {"a", p_.a},
            {"s_bar", p_.s_bar},
            {"s", p_.s},
            {"rattler_gamma", p_.gamma_far},
            {"rattler_cutoff", p_.gamma_far > 0.0 ? p_.cutoff_far : 0.0}};
  }
  std::string keys() const override {
    std::string lines = fmt::format("kT = {}\ncutoff = {}\na = {}\ns_bar = {}\ns = {}\n", p_.kT,
                                    p_.cutoff, p_.a, p_.s_bar, p_.s);
    if (p_.gamma_far > 0.0)
      lines += fmt::format("rattler_friction = {{ gamma = {}, cutoff = {} }}\n", p_.gamma_far,
                           p_.cutoff_far);
    return lines;
  }
  double guess(double eta) const override {
    return p_.gamma * eta / (dimension_ == 2 ? affine<2>() : affine<3>());
  }
  double diffusion_time(double friction) const override {
    return friction * p_.cutoff * p_.cutoff / p_.kT;
  }
  // Well within the limit of explicit repulsion; docs/rheology.md has viscosities at larger and smaller steps.
  double accurate_step(double friction, double mass) const override {
    DpdParameters p = p_;
    p.gamma = friction;
    return 0.6 * *explicit_step_limit(pair_moments(*make_dpd<2>(p), 1), mass);
  }
  bool scales() const override { return p_.gamma_far == 0.0; }

 private:
  template <int D>
  double affine() const {
    return kinetic_theory<D>(pair_moments(*make_dpd<D>(p_), 1), {1.0}, density_, 0.0).eta_friction;
  }

  DpdParameters p_;
  int dimension_;
  double density_;
};

class CalibratedSdpd : public CalibratedModel {
 public:
  CalibratedSdpd(const SdpdParameters& p, const SdpdFriction& friction, int dimension)
      : p_(p), friction_(friction), dimension_(dimension) {}

  std::string key() const override { return "eta"; }
  double friction() const override { return friction_.eta(dimension_); }
  double kT() const override { return p_.kT; }
  double cutoff() const override { return p_.support; }
  std::vector<std::pair<std::string, double>> inputs() const override { return {}; }
  std::string text() const override {
    std::string line = keys();
    std::replace(line.begin(), line.end(), '\n', ';');
    return line;
  }
  std::string keys() const override {
    const double n = p_.state.d_0;
    std::string lines = fmt::format(
        "model = \"sdpd\"\nkT = {}\nform = \"{}\"\nkernel = \"{}\"\nsupport = {}\n"
        "bulk_modulus = {}\nbackground_pressure = {}\n",
        p_.kT, friction_.A == 0.0 ? "central" : "classical",
        smoothing_kernel_names()[index(static_cast<int>(p_.kernel))],
        p_.support * std::pow(n, 1.0 / dimension_), p_.state.modulus, p_.state.background);
    if (p_.state.exponent > 0.0)
      lines += fmt::format("equation_of_state = \"tait\"\ntait_exponent = {}\n", p_.state.exponent);
    return friction_.spin ? lines + "spin = true\n" : lines;
  }
  double guess(double eta) const override { return eta; }
  // Sheared at the default rate, 9 over this, the Peclet number eta rate/(n kT) is 1.
  double diffusion_time(double friction) const override {
    return 9.0 * friction / (p_.state.d_0 * p_.kT);
  }
  double accurate_step(double friction, double mass) const override {
    const double n = p_.state.d_0;
    const double diffusing = 0.004 * friction / (n * p_.kT),
                 free = 0.03 * std::pow(n, -1.0 / dimension_) * std::sqrt(mass / p_.kT);
    const double compressed =
        0.75 * (dimension_ == 2 ? state_step<2>(friction, mass) : state_step<3>(friction, mass));
    return std::min(compressed, std::max(diffusing, free));
  }
  bool scales() const override { return true; }

 private:
  template <int D>
  double state_step(double friction, double mass) const {
    const double ratio = friction / friction_.eta(D);
    SdpdFriction scaled = friction_;
    scaled.A *= ratio;
    scaled.B *= ratio;
    return SdpdModel<D>(p_, 1, {scaled}).reference_state(mass)->accurate_step;
  }

  SdpdParameters p_;
  SdpdFriction friction_;
  int dimension_;
};

}  // namespace

std::shared_ptr<const CalibratedModel> calibrated_dpd(const DpdParameters& p, int dimension,
                                                      double density) {
  return std::make_shared<CalibratedDpd>(p, dimension, density);
}

std::shared_ptr<const CalibratedModel> calibrated_sdpd(const SdpdParameters& p,
                                                       const SdpdFriction& friction,
                                                       int dimension) {
  return std::make_shared<CalibratedSdpd>(p, friction, dimension);
}

}  // namespace odpd
