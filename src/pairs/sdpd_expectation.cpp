#include "odpd/pairs/sdpd_expectation.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace odpd {

namespace {

struct MeasuredSdpd {
  int dimension;
  bool central;
  SmoothingKernel::Shape kernel;
  double support, kappa, Gamma;
  double ratio, standard_error;
};

using enum SmoothingKernel::Shape;

constexpr MeasuredSdpd measured_sdpd[] = {
    {2, true, wendland_c2, 2.5, 100.0, 50.0, 0.909, 0.010},
    {2, true, wendland_c2, 2.5, 100.0, 100.0, 0.988, 0.004},
    {2, true, wendland_c2, 3.0, 10.0, 10.0, 0.831, 0.010},
    {2, true, wendland_c2, 3.0, 30.0, 30.0, 0.910, 0.010},
    {2, true, wendland_c2, 3.0, 100.0, 0.0, 0.823, 0.005},
    {2, true, wendland_c2, 3.0, 100.0, 30.0, 0.921, 0.004},
    {2, true, wendland_c2, 3.0, 100.0, 100.0, 0.982, 0.002},
    {2, true, wendland_c2, 3.0, 300.0, 300.0, 1.115, 0.008},
    {2, true, wendland_c2, 3.0, 1000.0, 0.0, 0.972, 0.008},
    {2, true, wendland_c2, 3.0, 1000.0, 100.0, 1.006, 0.007},
    {2, true, wendland_c2, 3.0, 1000.0, 1000.0, 1.560, 0.020},
    {2, true, wendland_c2, 4.0, 100.0, 0.0, 0.916, 0.003},
    {2, true, wendland_c2, 4.0, 100.0, 30.0, 0.958, 0.003},
    {2, true, wendland_c2, 4.0, 100.0, 100.0, 0.992, 0.002},
    {2, true, wendland_c2, 4.0, 1000.0, 0.0, 0.994, 0.007},
    {2, true, wendland_c2, 4.0, 1000.0, 100.0, 1.004, 0.004},
    {2, true, wendland_c2, 4.0, 1000.0, 1000.0, 1.125, 0.009},
    {2, true, wendland_c2, 4.5, 100.0, 100.0, 0.994, 0.005},
    {2, true, wendland_c2, 5.0, 100.0, 100.0, 0.993, 0.002},
    {2, true, wendland_c4, 4.0, 100.0, 100.0, 0.994, 0.003},
    {2, true, lucy, 3.0, 100.0, 0.0, 0.904, 0.006},
    {2, true, lucy, 3.0, 100.0, 30.0, 0.989, 0.005},
    {2, true, lucy, 3.0, 100.0, 100.0, 1.107, 0.007},
    {2, true, lucy, 4.0, 100.0, 100.0, 1.053, 0.003},
    {2, true, quintic, 3.0, 100.0, 0.0, 0.774, 0.010},
    {2, true, quintic, 3.0, 100.0, 100.0, 1.010, 0.020},
    {2, false, wendland_c2, 3.0, 100.0, 100.0, 1.024, 0.003},
    {2, false, wendland_c2, 3.0, 1000.0, 100.0, 1.048, 0.008},
    {2, false, wendland_c2, 4.0, 100.0, 100.0, 1.009, 0.002},
    {2, false, wendland_c2, 4.0, 1000.0, 100.0, 1.016, 0.005},
    {2, false, lucy, 3.0, 100.0, 100.0, 1.117, 0.008},
    {3, true, wendland_c2, 2.5, 100.0, 0.0, 0.804, 0.006},
    {3, true, wendland_c2, 2.5, 100.0, 100.0, 0.963, 0.003},
    {3, true, wendland_c2, 2.5, 1000.0, 100.0, 1.004, 0.006},
    {3, true, wendland_c2, 3.0, 100.0, 0.0, 0.896, 0.005},
    {3, true, wendland_c2, 3.0, 100.0, 100.0, 0.982, 0.003},
    {3, true, wendland_c2, 3.0, 1000.0, 100.0, 0.997, 0.004},
    {3, true, lucy, 3.0, 100.0, 100.0, 1.096, 0.012},
    {3, true, quintic, 3.0, 100.0, 100.0, 1.028, 0.009},
    {3, false, wendland_c2, 2.5, 100.0, 100.0, 1.045, 0.006},
    {3, false, wendland_c2, 3.0, 100.0, 100.0, 1.025, 0.005},
};

// The distance of logarithms, in units of what is near enough.
double apart(double a, double b) {
  if (b == 0.0) return a / 3.0;
  return a > 0.0 ? std::abs(std::log(a / b)) / std::log(1.5)
                 : std::numeric_limits<double>::infinity();
}

}  // namespace

std::optional<ExpectedViscosity> expected_viscosity(const SdpdParameters& p,
                                                    const SdpdFriction& friction, int dimension) {
  const bool central = friction.A == 0.0,
             classical = std::abs(friction.A - friction.B) <= 1e-12 * friction.A;
  if (p.kT == 0.0 || p.state.background < 0.0 || friction.spin || !(central || classical))
    return std::nullopt;
  const double n = p.state.d_0, support = p.support * std::pow(n, 1.0 / dimension),
               kappa = p.state.modulus / (n * p.kT), Gamma = p.state.background / (n * p.kT);
  std::optional<ExpectedViscosity> nearest;
  double least = 1.0 + 1e-9;
  for (const MeasuredSdpd& m : measured_sdpd) {
    if (m.dimension != dimension || m.central != central || m.kernel != p.kernel) continue;
    const double distance = std::max(
        {std::abs(support - m.support) / 0.25, apart(kappa, m.kappa), apart(Gamma, m.Gamma)});
    if (distance > least) continue;
    least = distance;
    nearest = ExpectedViscosity{m.ratio, m.standard_error, m.support, m.kappa, m.Gamma};
  }
  return nearest;
}

}  // namespace odpd
