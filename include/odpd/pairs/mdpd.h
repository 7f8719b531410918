#pragma once
// model = "mdpd": many-body DPD, a liquid with its vapour (Warren 2003). With w_c = 1 - r/r_c, w_d = 1 - r/r_d,
//
//   f_c = A w_c + B (rho_i + rho_j) w_d,   rho_i = sum_{j != i} b_ij N w_d^2
//   E = sum_pairs A r_c/2 w_c^2 + sum_i c rho_i^2,   c = B r_d/(4 N)
//
// where N = 15/(2 pi r_d^3) in 3D and 6/(pi r_d^2) in 2D makes the integral of N w_d^2 over space 1. A < 0 attracts. B, r_d and so c are of
// the fluid: with a B of each pair of species the force would have no energy. What unlike particles do to each other's densities is b_ij instead,
// which then also weights the second part of their force. Friction and noise are DPD's (pairs/friction.h).
#include <memory>
#include <vector>

#include "odpd/pairs/fluid_keys.h"
#include "odpd/pairs/friction.h"
#include "odpd/pairs/pair_model.h"

namespace odpd {

/// Of one pair of species.
struct MdpdPair {
  double A = -40.0;             ///< force
  double b = 1.0;               ///< in the density sum
  FrictionParameters friction;  ///< its cutoff is r_c
  bool operator==(const MdpdPair&) const = default;
};

struct MdpdFluid {
  double B = 25.0;    ///< force length^d
  double r_d = 0.75;  ///< length
  /// It fills the box and has no free surface.
  bool filled = false;
};

class MdpdDensities final : public Densities {
 public:
  MdpdDensities(const MdpdFluid& fluid, int dimension, int species, std::vector<double> b);
  double self(Site) const override { return 0.0; }
  Derivatives weight(double r, Site i, Site j) const override {
    const double x = 1.0 - r / r_d_;
    if (!(x > 0.0)) return {};
    const double scale = b_[index(i.species * species_ + j.species)] * norm_;
    return {scale * x * x, -2.0 * scale * x / r_d_, 2.0 * scale / (r_d_ * r_d_)};
  }
  Derivatives energy(Site site) const override {
    const double rho = site.density;
    return {c_ * rho * rho, 2.0 * c_ * rho, 2.0 * c_};
  }

 private:
  double r_d_, norm_, c_;
  int species_;
  std::vector<double> b_;
};

template <int D>
class MdpdModel : public PairModel<D> {
 public:
  /// `pairs[A * species + B]`, symmetric. `density` (1/length^d): of the fluid, for its reference state; 0: not known. Throws ConfigError for
  /// values out of range.
  MdpdModel(const MdpdFluid& fluid, int species, const std::vector<MdpdPair>& pairs,
            double density);

  std::string name() const override { return "mdpd"; }
  int species() const override { return species_; }
  double cutoff() const override { return cutoff_; }
  PairTerms pair(double r, Site site_i, Site site_j) const override {
    return terms(r, site_i, site_j);
  }
  std::vector<double> kinks(Site site_i, Site site_j) const override;
  void write_edges(const PairList<D>& list, const Box<D>& box, std::span<const Vec<D>> positions,
                   const Particles<D>& particles, PairNetwork<D>& network) const override;
  const Densities* densities() const override { return &densities_; }
  std::optional<ReferenceState> reference_state(double mass) const override;
  /// 0.03 r_c of the fluid: where a particle leaves the liquid friction does not slow it, and larger steps let drops evaporate.
  double thermal_path() const override;
  bool conservative() const override { return true; }
  bool thermal() const override { return thermal_; }
  ModelParameters parameters() const override;

 private:
  struct Entry {
    MdpdPair of;
    Friction friction;
  };
  const Entry& entry(Site i, Site j) const {
    return table_[index(i.species * species_ + j.species)];
  }
  PairTerms terms(double r, Site i, Site j) const {
    const Entry& e = entry(i, j);
    const double r_c = e.of.friction.cutoff, x = 1.0 - r / r_c;
    PairTerms t;
    e.friction(r, t);
    if (!(x > 0.0)) return t;
    t.u = 0.5 * e.of.A * r_c * x * x;
    t.f_c = e.of.A * x;
    t.k_c = e.of.A / r_c;
    return t;
  }

  MdpdFluid fluid_;
  double density_;
  int species_;
  std::vector<Entry> table_;
  MdpdDensities densities_;
  double cutoff_;
  bool thermal_ = false;
};

/// Throws ConfigError for values out of range and contradictions.
template <int D>
std::shared_ptr<const PairModel<D>> read_mdpd(const FluidKeys& keys);

}  // namespace odpd
