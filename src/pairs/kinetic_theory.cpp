#include "odpd/pairs/kinetic_theory.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "odpd/pairs/physical_inputs.h"

namespace odpd {

namespace {

// Over the pairs of species at random; not a number where it is undefined for a pair that is there.
struct Mixture {
  double energy = 0.0, virial = 0.0, drag = 0.0;
  double shear = 0.0;     // 2 d (d + 2) eta/n^2
  double rotation = 0.0;  // 4 d eta_r/n^2
  double moment = 0.0;    // of inertia
  double kT = 0.0, alpha_mass = std::numeric_limits<double>::infinity();

  Mixture(const std::vector<PairMoments>& pairs, const std::vector<double>& fraction,
          const std::vector<Spin>& spins, int d) {
    const auto add = [](double& sum, double share, const std::optional<double>& value) {
      sum += share * value.value_or(std::nan(""));
    };
    const auto spin = [&](std::size_t a) { return spins.empty() ? Spin{} : spins[a]; };
    for (std::size_t a = 0; a < fraction.size(); ++a) {
      moment += fraction[a] * spin(a).moment;
      for (std::size_t b = 0; b < fraction.size(); ++b) {
        const double share = fraction[a] * fraction[b];
        if (share == 0.0) continue;
        const PairMoments& p = pairs[a * fraction.size() + b];
        add(energy, share, p.energy);
        add(virial, share, p.virial);
        add(drag, share, p.drag);
        add(shear, share, p.shear_par);
        const bool turns = spin(a).lever_radius + spin(b).lever_radius > 0.0;
        add(shear, turns ? 0.5 * d * share : (d + 1) * share, p.shear_perp);
        if (turns) add(rotation, share, p.shear_perp);
        kT = std::max(kT, p.kT);
        if (p.force > 0.0)
          alpha_mass = std::min(alpha_mass, p.zeta_par * p.zeta_par * p.force_range / p.force);
      }
    }
  }
};

}  // namespace

template <int D>
KineticTheory kinetic_theory(const std::vector<PairMoments>& pairs,
                             const std::vector<double>& fraction, double density, double mass,
                             const std::optional<ReferenceState>& reference,
                             const std::vector<Spin>& spins) {
  const Mixture mean(pairs, fraction, spins, D);
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const double n = density, kT = mean.kT;
  const double repulsion = mean.virial / D;  // 2 (p - n kT)/n^2
  const double compression =
      kT + (reference ? reference->bulk_modulus / n : n * repulsion);  // dp/dn
  KineticTheory k;
  k.rho = n * mass;
  k.eta_friction = n * n * mean.shear / (2.0 * D * (D + 2));
  k.eta_rotational = n * n * mean.rotation / (4.0 * D);
  if (k.eta_rotational > 0.0) k.spin_relaxation = n * mean.moment / (4.0 * k.eta_rotational);
  k.diffusion = kT > 0.0 ? D * kT / (n * mean.drag) : 0.0;
  k.eta_kinetic = mass > 0.0 ? 0.5 * k.rho * k.diffusion : 0.0;
  const double inertia = k.rho * k.diffusion;
  k.w_0 = mass > 0.0 ? n * mean.drag / (D * mass) : infinity;
  k.l_0 = mass > 0.0 ? std::sqrt(kT / mass) / k.w_0 : 0.0;
  k.tau_P = diffusion_time<D>(kT, k.diffusion, k.eta_friction);
  k.Sc = inertia > 0.0 ? k.eta() / inertia : infinity;
  k.alpha = mass > 0.0 ? mean.alpha_mass / mass : infinity;
  k.energy = reference ? std::nan("") : 0.5 * n * mean.energy;
  k.pressure = n * kT + (reference ? reference->pressure : 0.5 * n * n * repulsion);
  k.bulk_modulus = n * compression;
  k.kappa_inverse = kT > 0.0 ? compression / kT : infinity;
  k.speed_of_sound = mass > 0.0 ? std::sqrt(compression / mass) : infinity;
  return k;
}

template KineticTheory kinetic_theory<2>(const std::vector<PairMoments>&,
                                         const std::vector<double>&, double, double,
                                         const std::optional<ReferenceState>&,
                                         const std::vector<Spin>&);
template KineticTheory kinetic_theory<3>(const std::vector<PairMoments>&,
                                         const std::vector<double>&, double, double,
                                         const std::optional<ReferenceState>&,
                                         const std::vector<Spin>&);

}  // namespace odpd
