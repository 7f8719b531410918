#pragma once
// Dissipative particle dynamics (Hoogerbrugge & Koelman 1992; Espanol & Warren 1995; Phan-Thien et al. 2016, eq. 3-7):
//
//   f_c = a w_C,  w_C = (1 - r/r_c)^s_bar        u = a r_c/(s_bar + 1) (1 - r/r_c)^(s_bar + 1)
//   zeta_par = gamma w_D,  w_D = (1 - r/r_c)^s    sigma^2 = 2 gamma kT
//
// A pair with a core of radius c has x = 1 - (r - c)/(r_c - c) in place of 1 - r/r_c beyond it. Nearer than that w_C = w_D = 1,
//
//   u = a (r_c - c)/(s_bar + 1) + a (c - r),   f_c = a,   k_c = 0
//
// Optional: friction across the line of centres, zeta_perp = gamma_perp w_D, and a weak pairwise friction of longer
// range, gamma_far (1 - r/r_far)^s added to zeta_par, which keeps R regular where particles lose their neighbours.
// Both carry their own noise, since the noise of an edge follows from its friction.
#include <memory>
#include <optional>
#include <vector>

#include "odpd/core/index.h"
#include "odpd/pairs/calibration.h"
#include "odpd/pairs/pair_model.h"
#include "odpd/pairs/physical_inputs.h"
#include "odpd/pairs/weight.h"

namespace odpd {

/// What [fluid] says of a DPD fluid, before any [[pair]].
struct DpdFluid {
  DpdParameters p;
  PhysicalInputs asked{};                    ///< in place of parameters; may be none
  std::optional<Calibration> calibration{};  ///< where gamma comes from it
};

template <int D>
class DpdModel : public PairModel<D> {
 public:
  /// `parameters[A * species + B]`, symmetric in A and B; `fluid` is for reports. Throws ConfigError for values out of range
  /// and for another table.
  DpdModel(int species, std::vector<DpdParameters> parameters, DpdFluid fluid);
  /// The fluid is that of the first species.
  DpdModel(int species, std::vector<DpdParameters> parameters);

  std::string name() const override { return "dpd"; }
  int species() const override { return species_; }
  double cutoff() const override { return cutoff_; }
  std::span<const double> reaches() const override { return reaches_; }
  PairTerms pair(double r, Site site_i, Site site_j) const override {
    return terms(r, site_i, site_j);
  }
  std::vector<double> kinks(Site site_i, Site site_j) const override {
    return parameters(site_i, site_j).friction().kinks();
  }
  void write_edges(const PairList<D>& list, const Box<D>& box, std::span<const Vec<D>> positions,
                   const Particles<D>& particles, PairNetwork<D>& network) const override;
  bool conservative() const override { return conservative_; }
  bool thermal() const override { return thermal_; }
  ModelParameters parameters() const override;

  const DpdParameters& parameters(Site site_i, Site site_j) const {
    return entry(site_i, site_j).p;
  }
  const DpdFluid& fluid() const { return fluid_; }

 private:
  struct Entry {
    DpdParameters p;
    PowerWeight w_c, energy;
    Friction friction;
  };
  const Entry& entry(Site site_i, Site site_j) const {
    return table_[index(site_i.species * species_ + site_j.species)];
  }
  PairTerms terms(double r, Site site_i, Site site_j) const;

  int species_;
  std::vector<Entry> table_;
  std::vector<double> reaches_;
  DpdFluid fluid_;
  double cutoff_ = 0.0;
  bool conservative_ = false;
  bool thermal_ = false;
};

/// The same parameters for all pairs of species, as scenes hold it.
template <int D>
std::shared_ptr<const DpdModel<D>> make_dpd(const DpdParameters& p, int species = 1) {
  const auto n = index(species);
  return std::make_shared<const DpdModel<D>>(species, std::vector<DpdParameters>(n * n, p));
}

/// What [fluid] says, of a DPD model; nullptr for another.
template <int D>
const DpdFluid* dpd_fluid(const PairModel<D>& model) {
  const auto* dpd = dynamic_cast<const DpdModel<D>*>(&model);
  return dpd == nullptr ? nullptr : &dpd->fluid();
}

}  // namespace odpd
