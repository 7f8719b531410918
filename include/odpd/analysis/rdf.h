#pragma once
// Radial distribution function of the free particles, per pair of species A, B:
//
//   g_AB(r) = V <pairs AB with distance in the bin> / (pairs of particles AB in all * volume of the shell)
//
// with N(N-1)/2 pairs for A = B, so that an ideal gas has g = 1 at any N. Distances up to half the shortest periodic
// edge. With walls, V is the volume between them and g falls off near them: read it as relative.
#include "odpd/analysis/block_average.h"
#include "odpd/analysis/observer.h"

namespace odpd {

template <int D>
class Rdf : public Observer<D> {
 public:
  Rdf(ObserverSettings settings, double r_max, std::int64_t bins, const Scene<D>& scene);
  void measure(const Clock& clock, const Particles<D>& particles,
               const StepRecord<D>& record) override;
  void add_results(Results& results) const override;
  std::vector<std::string> series_columns() const override;
  std::vector<double> series_row() const override { return newest_; }
  void save(StateWriter& out) const override { average_.save(out, "average"); }
  void load(const StateReader& in) override { average_.load(in, "average"); }

 private:
  std::size_t pair_index(std::int32_t a, std::int32_t b) const;
  /// Per column: turns pair counts of these particles into g.
  std::vector<double> factors(const Particles<D>& particles) const;

  double r_max_;
  std::size_t bins_;
  const Scene<D>& scene_;
  std::size_t species_;
  BlockAverage average_;
  std::vector<double> newest_;
};

}  // namespace odpd
