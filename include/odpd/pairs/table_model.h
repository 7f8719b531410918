#pragma once
// model = "table": the conservative force of each pair of species from a file; friction and noise as DPD's (pairs/friction.h). With S the
// monotone spline through the table (core/monotone_spline.h),
//
//   table of r and f:   f_c = S(r)     u = int_r^{r_c} S dr   k_c = -S'
//   table of r and u:   f_c = -S'(r)   u = S(r) - S(r_c)      k_c = S''
//
// f_c = -u' and k_c = -f_c' thus hold exactly. S' is less accurate than S, and S'' jumps at the points: better a table of f.
//
// Nearer than r_1, where the table begins, either f_c = f_c(r_1), or no pair may be: u is infinite there, trial moves do not go there, and
// a stage with such a pair ends the run (f_c(r_1) only drives it apart while a start is relaxed).
#include <memory>
#include <string>
#include <vector>

#include "odpd/core/index.h"
#include "odpd/core/monotone_spline.h"
#include "odpd/core/text_table.h"
#include "odpd/pairs/fluid_keys.h"
#include "odpd/pairs/friction.h"
#include "odpd/pairs/inline_model.h"

namespace odpd {

/// One table, of r (length) and f (force) or u (energy).
class ForceTable {
 public:
  enum class Values { force, energy };

  /// `file` is for messages. Throws ConfigError as MonotoneSpline, and for r < 0.
  ForceTable(std::string file, Values values, std::vector<double> r,
             const std::vector<double>& value);
  /// Columns r and f, or r and u; others are ignored. Throws ConfigError naming file and line for rows that are not in order, not finite,
  /// too few, or lack some between them.
  explicit ForceTable(const TextTable& csv);

  /// Sets u (0 at the last point), f_c and k_c; the cubics at the ends go on outside of the points.
  void operator()(double r, PairTerms& t) const;
  const std::string& file() const { return file_; }
  /// Where the table ends, for messages: the file, and the line where it is known.
  const std::string& end() const { return end_; }
  const std::vector<double>& points() const { return spline_.points(); }

 private:
  std::string file_, end_;
  Values values_;
  MonotoneSpline spline_;
};

/// Of one pair of species.
struct TableParameters {
  std::shared_ptr<const ForceTable> force;
  bool constant_below = false;  ///< nearer than the first r f_c is constant; else no pair may be
  FrictionParameters friction;  ///< its cutoff is that of the force too
  friend bool operator==(const TableParameters&, const TableParameters&) = default;
};

template <int D>
class TableModel : public InlineModel<D, TableModel<D>> {
 public:
  /// `parameters[A * species + B]`, symmetric in A and B. Throws ConfigError for values out of range and for tables that begin beyond or
  /// end before their cutoff.
  TableModel(int species, const std::vector<TableParameters>& parameters);

  PairTerms terms(double r, Site site_i, Site site_j) const;

  std::string name() const override { return "table"; }
  int species() const override { return species_; }
  double cutoff() const override { return cutoff_; }
  std::vector<double> kinks(Site site_i, Site site_j) const override;
  bool conservative() const override { return conservative_; }
  bool thermal() const override { return thermal_; }
  void refuse_unknown(const PairNetwork<D>& network, const Particles<D>& particles) const override;
  ModelParameters parameters() const override;

 private:
  struct Entry {
    TableParameters p;
    Friction friction;
    double begin;           // the first r
    PairTerms first, last;  // there and at the cutoff
  };
  const Entry& entry(Site site_i, Site site_j) const {
    return table_[index(site_i.species * species_ + site_j.species)];
  }

  int species_;
  std::vector<Entry> table_;
  double cutoff_ = 0.0;
  bool conservative_ = false, thermal_ = false, may_refuse_ = false;
};

/// Keys force_file and force_below, and those of friction. Throws ConfigError for values out of range.
template <int D>
std::shared_ptr<const PairModel<D>> read_table_model(const FluidKeys& keys);

}  // namespace odpd
