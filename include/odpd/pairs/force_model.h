#pragma once
// A pair model that is a conservative force for each pair of species; friction and noise are DPD's (pairs/friction.h). It takes a struct
// of what one pair of species has,
//
//   struct GaussianForce {
//     static constexpr const char* name = "gaussian";  // as fluid.model has it
//     double a, w;
//     FrictionParameters friction;                     // its cutoff is that of the force too
//     void read(const Config& keys, bool whole);       // [fluid] (`whole`), or a [[pair]], where an absent key changes nothing
//     void validate() const;                           // throws ConfigError for values out of range
//     bool acts() const;                               // some force is not zero
//     void force(double r, PairTerms& t) const;        // sets u, f_c and k_c, for 0 <= r < r_c
//     std::vector<std::pair<std::string, double>> values() const;  // for reports
//     bool operator==(const GaussianForce&) const = default;
//   };
//
// and read_force_model<D, GaussianForce> is the reader that the table of models needs (docs/add-a-pair-model.md).
#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "odpd/pairs/fluid_keys.h"
#include "odpd/pairs/friction.h"
#include "odpd/pairs/inline_model.h"

namespace odpd {

template <int D, class Force>
class ForceModel : public InlineModel<D, ForceModel<D, Force>> {
 public:
  /// `forces[A * species + B]`, symmetric in A and B. Throws ConfigError for values out of range and for another table.
  ForceModel(int species, const std::vector<Force>& forces) : species_(species) {
    require_pair_table(species, forces);
    for (const Force& f : forces) {
      validate(f.friction);
      f.validate();
      table_.push_back({f, Friction(f.friction)});
      cutoff_ = std::max(cutoff_, f.friction.reach());
      conservative_ = conservative_ || f.acts();
      thermal_ = thermal_ || f.friction.kT > 0.0;
      reaches_.push_back(f.friction.reach());
    }
  }

  PairTerms terms(double r, Site site_i, Site site_j) const {
    const Entry& of = entry(site_i, site_j);
    PairTerms t;
    of.friction(r, t);
    if (r < of.force.friction.cutoff) of.force.force(r, t);
    return t;
  }

  std::string name() const override { return Force::name; }
  int species() const override { return species_; }
  double cutoff() const override { return cutoff_; }
  std::span<const double> reaches() const override { return reaches_; }
  std::vector<double> kinks(Site site_i, Site site_j) const override {
    return entry(site_i, site_j).force.friction.kinks();
  }
  bool conservative() const override { return conservative_; }
  bool thermal() const override { return thermal_; }
  ModelParameters parameters() const override {
    const Force& f = table_[0].force;
    ModelParameters p{"parameters", f.values()};
    p.values.insert(p.values.end(), {{"gamma", f.friction.gamma},
                                     {"sigma", std::sqrt(2.0 * f.friction.gamma * f.friction.kT)},
                                     {"s", f.friction.s}});
    return p;
  }

 private:
  struct Entry {
    Force force;
    Friction friction;
  };
  const Entry& entry(Site site_i, Site site_j) const {
    return table_[index(site_i.species * species_ + site_j.species)];
  }

  int species_;
  std::vector<Entry> table_;
  std::vector<double> reaches_;
  double cutoff_ = 0.0;
  bool conservative_ = false, thermal_ = false;
};

/// The model of a case: keys of `Force` and of friction. Throws ConfigError for values out of range.
template <int D, class Force>
std::shared_ptr<const PairModel<D>> read_force_model(const FluidKeys& keys) {
  const auto read = [](const Config& from, Force f, bool whole) {
    f.friction = read_friction(from, f.friction, whole);
    f.read(from, whole);
    return f;
  };
  const auto table =
      pair_table(keys, read(keys.fluid, Force{}, true),
                 [&](const Config& pair, const Force& base) { return read(pair, base, false); });
  return std::make_shared<const ForceModel<D, Force>>(static_cast<int>(keys.species), table);
}

}  // namespace odpd
