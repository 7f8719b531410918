#pragma once
// Bonds, a second source of edges: springs between given particles at any distance, without friction and noise of their own,
//
//   harmonic  u = H/2 (r - r_0)^2                          f_c = -H (r - r_0)
//   fene      u = -H/2 r_m^2 ln(1 - ((r - r_0)/r_m)^2)     f_c = -H (r - r_0)/(1 - ((r - r_0)/r_m)^2)
//
// (harmonic: Phan-Thien et al. 2016, eq. 50, 51), or all pairs of particles that are tied to the sites of one rigid frame, with
// the terms of pairs/site_frame.h (law sites; their r_0 is the distance of the sites). They stand behind the edges of the pairs in the network, so a bonded pair
// closer than the cutoff has two edges.
#include <cstdint>
#include <memory>
#include <vector>

#include "odpd/core/error.h"
#include "odpd/pairs/pair_model.h"
#include "odpd/pairs/site_frame.h"

namespace odpd {

enum class BondLaw { harmonic, fene, sites };
/// What a bonded pair keeps of its interaction as a pair: all, friction and noise without the conservative force, nothing. In a
/// model with densities this is about the pair's own terms. A bonded neighbour takes up room like any other: it counts in the
/// densities, and the force that these exert on the pair stays, without which it would not be the gradient of the energy.
enum class BondExclusion { none, repulsion, all };

struct BondParameters {
  BondLaw law = BondLaw::harmonic;
  double H = 0.0;      ///< stiffness (force/length)
  double r_0 = 0.0;    ///< length without force
  double r_max = 0.0;  ///< of fene: largest |r - r_0|
  BondExclusion exclude = BondExclusion::none;
};

struct Bond {
  std::int64_t i = 0, j = 0;  ///< identities
  BondParameters p{};
};

/// Half the shortest periodic edge, which every bond must be shorter than; infinite where there is none.
template <int D>
double longest_bond(const Box<D>& box);

/// u, f_c and k_c of a bond of length r >= 0; u is infinite (f_c and k_c are zero) where fene does not reach. Zero for one of
/// a frame, which only all its particles together have an energy with.
PairTerms bond_terms(const BondParameters& p, double r);

/// A pair model and the bonds of a scene.
template <int D>
class BondedModel : public PairModel<D> {
 public:
  /// kT of a bond's edge is that of its pair. Throws ConfigError: parameters out of range, a bond of a particle with itself,
  /// or two of one pair.
  /// Each of the frames has its bonds among them.
  BondedModel(std::shared_ptr<const PairModel<D>> pairs, std::vector<Bond> bonds,
              std::vector<SiteFrame<D>> frames = {});

  std::string name() const override { return pairs_->name(); }
  int species() const override { return pairs_->species(); }
  double cutoff() const override { return pairs_->cutoff(); }
  std::span<const double> reaches() const override { return pairs_->reaches(); }
  std::vector<double> kinks(Site site_i, Site site_j) const override {
    return pairs_->kinks(site_i, site_j);
  }
  PairTerms pair(double r, Site site_i, Site site_j) const override {
    return pairs_->pair(r, site_i, site_j);
  }
  /// Pair edges, then an edge per bond in the order of `bonds`. Throws BlowUpError for a bond out of reach, and where a
  /// frame may turn freely, BondTooLongError for one as long as half the box.
  void write_edges(const PairList<D>& list, const Box<D>& box, std::span<const Vec<D>> positions,
                   const Particles<D>& particles, PairNetwork<D>& network) const override;
  void refuse_unknown(const PairNetwork<D>& network, const Particles<D>& particles) const override {
    pairs_->refuse_unknown(network, particles);
  }
  const Densities* densities() const override { return pairs_->densities(); }
  std::optional<ReferenceState> reference_state(double mass) const override {
    return pairs_->reference_state(mass);
  }
  double thermal_path() const override { return pairs_->thermal_path(); }
  double lever_radius() const override { return pairs_->lever_radius(); }
  bool conservative() const override { return pairs_->conservative() || !bonds_.empty(); }
  bool thermal() const override { return pairs_->thermal(); }
  double bonded_energy(std::size_t i, const Vec<D>& r, const Box<D>& box,
                       const Particles<D>& particles) const override;
  bool excludes(std::size_t i, std::size_t j, const Particles<D>& particles) const override;

  const std::vector<Bond>& bonds() const { return bonds_; }

 private:
  std::size_t place_of(std::int64_t id, const Particles<D>& particles) const;
  PairTerms of_densities(const Particles<D>& particles, const PairNetwork<D>& network,
                         std::size_t k) const;
  void exclude(const Particles<D>& particles, PairNetwork<D>& network) const;
  void write_bond(const Bond& bond, double half_box, const Box<D>& box,
                  std::span<const Vec<D>> positions, const Particles<D>& particles, std::size_t k,
                  PairNetwork<D>& network) const;

  std::vector<Vec<D>> points_of(const SiteFrame<D>& frame, const Box<D>& box,
                                std::span<const Vec<D>> positions,
                                const Particles<D>& particles) const;
  double frame_energy(std::int64_t id, const Vec<D>& r, const Box<D>& box,
                      const Particles<D>& particles) const;

  std::shared_ptr<const PairModel<D>> pairs_;
  std::vector<Bond> bonds_;
  std::vector<SiteFrame<D>> frames_;  // by their first identities
  bool excludes_ = false;
  // Of each identity: bond_of_[start_[id]] .. are its bonds.
  std::vector<std::size_t> start_, bond_of_;
  mutable std::vector<std::int32_t> index_;  // memory index of each identity, when last looked at
};

}  // namespace odpd
