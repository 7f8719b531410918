#include "odpd/pairs/physical_inputs.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace odpd {

template <>
double diffusion_time<2>(double, double, double) {
  return std::nan("");
}
template <>
double diffusion_time<3>(double kT, double diffusion, double eta) {
  if (diffusion == 0.0) return std::numeric_limits<double>::infinity();
  const double radius = kT / (6.0 * std::numbers::pi * diffusion * eta);
  return radius * radius / diffusion;
}

namespace {

// (x + 1)(x + 2)...(x + last)
double rising_product(double x, int last) {
  double product = 1.0;
  for (int k = 1; k <= last; ++k) product *= x + k;
  return product;
}

// s_bar of (s_bar + 1)...(s_bar + d + 1) = c: a cubic in 2D (3.7), a quadratic of (s_bar + 5/2)^2 in 3D (3.6).
template <int D>
double repulsion_exponent(double c);
template <>
double repulsion_exponent<2>(double c) {
  const double b = std::cbrt(0.5 * c + std::sqrt(0.25 * c * c - 1.0 / 27.0));
  return 1.0 / (3.0 * b) + b - 2.0;
}
template <>
double repulsion_exponent<3>(double c) {
  return 0.5 * (std::sqrt(5.0 + 4.0 * std::sqrt(c + 1.0)) - 5.0);
}

void require(bool ok, const char* key, const std::string& message) {
  if (!ok) throw PhysicalInputError(key, message);
}

void require_positive(const std::optional<double>& value, const char* key) {
  require(!value || (*value > 0.0 && std::isfinite(*value)), key, "must be positive");
}

void validate(const PhysicalInputs& in, double kT, double mass) {
  require_positive(in.eta, "eta");
  require_positive(in.Sc, "Sc");
  require_positive(in.tau_P, "tau_P");
  require_positive(in.alpha, "alpha");
  require_positive(in.kappa_inverse, "kappa_inverse");
  require(in.eta || !in.any(), "eta",
          "physical inputs begin with the viscosity: give eta with Sc or tau_P, alpha and "
          "kappa_inverse, or "
          "give gamma, s, a and s_bar instead of them");
  require(!in.Sc || mass > 0.0, "Sc",
          "the Schmidt number eta/(rho D) is infinite at mass = 0: leave it out and give s "
          "(default 0.5), or give a mass");
  require(!in.alpha || mass > 0.0, "alpha",
          "a = gamma^2 r_c/(alpha m) (thesis 3.5) diverges at mass = 0: give a, or kappa_inverse "
          "with s_bar, or give a mass");
  require(!in.Sc || kT > 0.0, "Sc", "nothing diffuses at kT = 0: leave it out and give s");
  require(!in.tau_P || kT > 0.0, "tau_P", "nothing diffuses at kT = 0: leave it out and give s");
  require(!in.tau_P || !in.Sc, "tau_P", "both it and Sc set s: give one of the two");
  if (!in.kappa_inverse) return;
  require(kT > 0.0, "kappa_inverse", "it is dp/dn over kT, and kT is 0: give a and s_bar");
  require(*in.kappa_inverse > 1.0, "kappa_inverse",
          fmt::format("{} must be larger than 1, that of an ideal gas; water has 15.98",
                      *in.kappa_inverse));
}

// (s + d + 1)(s + d + 2) = c, (3.13), (3.17) and (4.48), where kT n r_c^2/(eta D) = x.
template <int D>
double exponent_of(double x) {
  const double c = x * D * (D + 1) / (2.0 * (D + 2));
  return 0.5 * (std::sqrt(1.0 + 4.0 * c) - (2 * D + 3));
}

// x at s = 0.
template <int D>
constexpr double smallest_x = 2.0 * (D + 2) * (D + 2) / D;

template <int D>
double friction_exponent(const PhysicalInputs& in, const DpdParameters& p, double n, double mass) {
  const double unit = mass * p.kT * n * n * p.cutoff * p.cutoff / (*in.eta * *in.eta);
  const double smallest = smallest_x<D> / unit;
  require(*in.Sc > smallest, "Sc",
          fmt::format("{} is too small for eta = {}, s would not be positive: it must be above "
                      "{:.6g} (thesis 3.16, 3.20); or lower eta, or raise mass, density or cutoff",
                      *in.Sc, *in.eta, smallest));
  return exponent_of<D>(*in.Sc * unit);
}

template <int D>
double friction_exponent_by_time(const PhysicalInputs& in, const DpdParameters& p, double n) {
  const double reach = n * p.cutoff * p.cutoff * p.kT / *in.eta;  // x D
  const double shortest = diffusion_time<D>(p.kT, reach / smallest_x<D>, *in.eta);
  require(!std::isnan(shortest), "tau_P",
          "it needs the radius kT/(6 pi D eta), which there is in 3D only: give Sc or s");
  require(*in.tau_P > shortest, "tau_P",
          fmt::format("{} is too short for eta = {}, s would not be positive: it must be above "
                      "{:.6g} (thesis 4.50); or lower eta, or raise density or cutoff",
                      *in.tau_P, *in.eta, shortest));
  // tau_P goes with 1/D^3.
  return exponent_of<D>(smallest_x<D> * std::cbrt(*in.tau_P / shortest));
}

template <int D>
void set_compressibility(const PhysicalInputs& in, double n, DpdParameters& p) {
  const double excess = (*in.kappa_inverse - 1.0) * p.kT;  // n a [R w_C]/d
  if (in.keep_s_bar) {
    p.a = excess * D / (n * weight_moment<D>(1, p.s_bar, p.cutoff));
    return;
  }
  // weight_moment(0) holds the product at s_bar = 0, (d + 1)!.
  const double least = rising_product(0.0, D + 1);
  const double at_zero = n * p.a * weight_moment<D>(1, 0.0, p.cutoff) / D;
  const double c = least * at_zero / excess;
  require(
      c > least, "kappa_inverse",
      fmt::format("{} is too stiff for a = {:.6g}, s_bar would not be positive: C = {:.6g} must "
                  "be above {} (thesis 3.6, 3.7), so kappa_inverse below {:.6g}; or raise a (a "
                  "smaller alpha), density or cutoff",
                  *in.kappa_inverse, p.a, c, least, 1.0 + at_zero / p.kT));
  p.s_bar = repulsion_exponent<D>(c);
}

}  // namespace

template <int D>
double weight_moment(int power, double exponent, double cutoff) {
  const double surface = 2.0 * std::pow(std::numbers::pi, 0.5 * D) / std::tgamma(0.5 * D);
  const int m = power + D;
  return surface * std::pow(cutoff, m) * std::tgamma(m) / rising_product(exponent, m);
}

template <int D>
DpdParameters dpd_parameters(const PhysicalInputs& in, const DpdParameters& base, double n,
                             double mass) {
  DpdParameters p = base;
  validate(in, p.kT, mass);
  if (in.Sc) p.s = friction_exponent<D>(in, p, n, mass);
  if (in.tau_P) p.s = friction_exponent_by_time<D>(in, p, n);
  if (in.eta) p.gamma = *in.eta * 2.0 * D * (D + 2) / (n * n * weight_moment<D>(2, p.s, p.cutoff));
  if (in.alpha) p.a = p.gamma * p.gamma * p.cutoff / (*in.alpha * mass);
  if (in.kappa_inverse) set_compressibility<D>(in, n, p);
  return p;
}

template double weight_moment<2>(int, double, double);
template double weight_moment<3>(int, double, double);
template DpdParameters dpd_parameters<2>(const PhysicalInputs&, const DpdParameters&, double,
                                         double);
template DpdParameters dpd_parameters<3>(const PhysicalInputs&, const DpdParameters&, double,
                                         double);

}  // namespace odpd
