#pragma once
// model = "sdpd": smoothed dissipative particle dynamics, isothermal (Espanol & Revenga 2003; Ellero & Espanol 2018, sections 2 and 6). With
// W a smoothing kernel of support h and F = -W'/r,
//
//   d_i = W(0) + sum_{j != i} W(r_ij)      E = sum_i psi(d_i),  psi' = P(d)/d^2
//   zeta_par = (A + B) F/(d_i d_j)         zeta_perp = A F/(d_i d_j)
//
// so that f_c = (P_i/d_i^2 + P_j/d_j^2) F r. The equation of state is linear or Tait's (exponent g), with the modulus K = d_0 dP/dd and the
// background pressure p_b = P(d_0) at d_0, the number density of the fluid:
//
//   linear   P = K (d/d_0 - 1) + p_b        Tait   P = (K/g) [(d/d_0)^g - 1] + p_b
//
// A and B follow from the shear viscosity eta and the bulk viscosity zeta_b that are asked for. Many neighbours without structure have
//
//   eta = A/2 + B/(2 (d + 2)),   zeta_b = B/(d + 2) - eta (1 - 2/d)
//
//   form = "central"     A = 0, B = 2 (d + 2) eta:        zeta_b = 2 eta (2D), 5/3 eta (3D); no torque on a pair
//   form = "classical"   A = B = 2 (d + 2)/(d + 3) eta:   zeta_b = 2/5 eta (2D), 0 (3D)
//
// Where particles spin (`spin`) friction across lines of centres meets the symmetric part of the velocity gradient alone:
//
//   eta = A/4 + B/(2 (d + 2)),   zeta_b = (A + B)/(2 d)
//
//   form = "classical"   A = B = 4 (d + 2)/(d + 4) eta:   8/3 (2D), 20/7 eta (3D); zeta_b = 4/3 eta (2D), 20/21 eta (3D)
//
// A fluid of finitely many neighbours has some per cent less or more of either: docs/density-fluids.md.
#include <memory>
#include <vector>

#include "odpd/pairs/fluid_keys.h"
#include "odpd/pairs/pair_model.h"
#include "odpd/pairs/smoothing_kernel.h"

namespace odpd {

/// psi(d) of an equation of state (energy; d: 1/length^d).
struct EquationOfState {
  double d_0 = 1.0;         ///< reference density (1/length^d)
  double modulus = 1.0;     ///< K (energy/length^d)
  double background = 0.0;  ///< p_b (energy/length^d)
  double exponent = 0.0;    ///< g of Tait's; 0: linear

  double pressure(double d) const;
  Derivatives energy(double d) const;
  bool operator==(const EquationOfState&) const = default;
};

/// A and B for these viscosities (energy time/length^d), in `dimension` dimensions.
struct SdpdFriction {
  double A = 0.0, B = 0.0;
  bool spin = false;  ///< between particles that spin

  static SdpdFriction of(double eta, double zeta_b, int dimension, bool spin = false);
  static SdpdFriction central(double eta, int dimension);
  static SdpdFriction classical(double eta, int dimension, bool spin = false);
  double eta(int dimension) const;
  double zeta_b(int dimension) const;
  bool operator==(const SdpdFriction&) const = default;
};

struct SdpdParameters {
  EquationOfState state;  ///< its d_0 is the number density of the fluid
  SmoothingKernel::Shape kernel = SmoothingKernel::Shape::wendland_c2;
  double support = 3.0;  ///< h (length)
  double kT = 1.0;
};

class SdpdDensities final : public Densities {
 public:
  SdpdDensities(const SmoothingKernel& kernel, const EquationOfState& state)
      : kernel_(kernel), state_(state), self_(kernel(0.0).value) {}
  double self(Site) const override { return self_; }
  Derivatives weight(double r, Site, Site) const override { return kernel_(r); }
  Derivatives energy(Site site) const override { return state_.energy(site.density); }

 private:
  SmoothingKernel kernel_;
  EquationOfState state_;
  double self_;
};

template <int D>
class SdpdModel : public PairModel<D> {
 public:
  /// `friction[A * species + B]`, symmetric. Throws ConfigError for values out of range: A and A + B must not be negative.
  SdpdModel(const SdpdParameters& p, int species, std::vector<SdpdFriction> friction);

  std::string name() const override { return "sdpd"; }
  int species() const override { return species_; }
  double cutoff() const override { return kernel_.support(); }
  PairTerms pair(double r, Site site_i, Site site_j) const override {
    return terms(r, site_i, site_j);
  }
  std::vector<double> kinks(Site, Site) const override;
  void write_edges(const PairList<D>& list, const Box<D>& box, std::span<const Vec<D>> positions,
                   const Particles<D>& particles, PairNetwork<D>& network) const override;
  const Densities* densities() const override { return &densities_; }
  std::optional<ReferenceState> reference_state(double mass) const override;
  /// Half a spacing, where particles spin.
  double lever_radius() const override;
  bool conservative() const override { return true; }
  bool thermal() const override { return p_.kT > 0.0; }
  const SdpdParameters& fluid() const { return p_; }
  /// Between particles of the first species.
  const SdpdFriction& friction() const { return friction_[0]; }
  ModelParameters parameters() const override;

 private:
  // Before densities are known, at that of the reference.
  PairTerms terms(double r, Site i, Site j) const {
    const double d_i = i.density > 0.0 ? i.density : p_.state.d_0,
                 d_j = j.density > 0.0 ? j.density : p_.state.d_0;
    const SdpdFriction& of = friction_[index(i.species * species_ + j.species)];
    const double slope = kernel_.slope(r) / (d_i * d_j);
    PairTerms t;
    t.zeta_par = (of.A + of.B) * slope;
    t.zeta_perp = of.A * slope;
    t.kT = p_.kT;
    return t;
  }

  SdpdParameters p_;
  int species_;
  std::vector<SdpdFriction> friction_;
  SmoothingKernel kernel_;
  SdpdDensities densities_;
};

/// Throws ConfigError for values out of range, contradictions, and a start file that tells no density.
template <int D>
std::shared_ptr<const PairModel<D>> read_sdpd(const FluidKeys& keys);

}  // namespace odpd
