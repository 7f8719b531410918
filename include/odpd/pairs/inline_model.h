#pragma once
// A pair model that is its inline pair function and nothing more: no kernel of its own.
//
//   template <int D>
//   class Spring : public InlineModel<D, Spring<D>> {
//    public:
//     PairTerms terms(double r, Site site_i, Site site_j) const { ... }
//     double cutoff() const override { ... }
//     ...
#include "odpd/pairs/edge_writer.h"

namespace odpd {

/// `Model` has PairTerms terms(double r, Site site_i, Site site_j) const, for any r >= 0.
template <int D, class Model>
class InlineModel : public PairModel<D> {
 public:
  PairTerms pair(double r, Site site_i, Site site_j) const final {
    return model().terms(r, site_i, site_j);
  }
  void write_edges(const PairList<D>& list, const Box<D>& box, std::span<const Vec<D>> positions,
                   const Particles<D>& particles, PairNetwork<D>& network) const final {
    write_pair_edges([this](double r, Site i, Site j) { return model().terms(r, i, j); },
                     this->cutoff(), list, box, positions, particles, network, this->reaches());
  }

 private:
  const Model& model() const { return static_cast<const Model&>(*this); }
};

}  // namespace odpd
