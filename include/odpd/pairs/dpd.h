#pragma once
// Dissipative particle dynamics (Hoogerbrugge & Koelman 1992; Espanol & Warren 1995; Phan-Thien et al. 2016, eq. 3-7):
//
//   f_c = a w_C,  w_C = (1 - r/r_c)^s_bar        u = a r_c/(s_bar + 1) (1 - r/r_c)^(s_bar + 1)
//   zeta_par = gamma w_D,  w_D = (1 - r/r_c)^s    sigma^2 = 2 gamma kT
//
// Optional: friction across the line of centres, zeta_perp = gamma_perp w_D, and a weak pairwise friction of longer
// range, gamma_far (1 - r/r_far)^s added to zeta_par, which keeps R regular where particles lose their neighbours.
// Both carry their own noise, since the noise of an edge follows from its friction.
#include <memory>
#include <vector>

#include "odpd/pairs/pair_model.h"
#include "odpd/pairs/weight.h"

namespace odpd {

/// Parameters of one pair of species.
struct DpdParameters {
  double a = 18.5;          ///< repulsion (force)
  double s_bar = 1.0;       ///< exponent of w_C
  double gamma = 4.5;       ///< friction along the line of centres (mass/time)
  double gamma_perp = 0.0;  ///< friction across it (mass/time)
  double s = 0.5;           ///< exponent of w_D
  double cutoff = 1.0;      ///< r_c (length)
  double kT = 1.0;          ///< temperature (energy)
  double gamma_far = 0.0;   ///< weak friction of longer range (mass/time)
  double cutoff_far = 0.0;  ///< its range r_far (length)

  friend bool operator==(const DpdParameters&, const DpdParameters&) = default;
};

template <int D>
class DpdModel : public PairModel<D> {
 public:
  /// `parameters[A * species + B]`, symmetric in A and B. Throws ConfigError for values out of range and for
  /// another table.
  DpdModel(int species, std::vector<DpdParameters> parameters);

  double cutoff() const override { return cutoff_; }
  PairTerms pair(double r, Site site_i, Site site_j) const override {
    return terms(r, site_i, site_j);
  }
  void write_edges(const PairList<D>& list, const Box<D>& box, std::span<const Vec<D>> positions,
                   const Particles<D>& particles, PairNetwork<D>& network) const override;
  bool conservative() const override { return conservative_; }
  bool thermal() const override { return thermal_; }

 private:
  struct Entry {
    DpdParameters p;
    PowerWeight w_c, w_d, energy;
  };
  PairTerms terms(double r, Site site_i, Site site_j) const;

  int species_;
  std::vector<Entry> table_;
  double cutoff_ = 0.0;
  bool conservative_ = false;
  bool thermal_ = false;
};

}  // namespace odpd
