#pragma once
// Radial distribution function of the free particles, per pair of species A, B, or of the centres of bodies, per pair of [[body]]:
//
//   g_AB(r) = V <pairs AB with distance in the bin> / (pairs of particles AB in all * volume of the shell)
//
// with N(N-1)/2 pairs for A = B, so that an ideal gas has g = 1 at any N; undefined (NaN, and a note) where there is no such pair.
// Distances up to half the shortest periodic edge. Between walls V is the volume between their surfaces, and shells count in full
// also where a wall cuts them: an ideal gas between walls H apart has not 1 but 1 - r/(2 H) in 3D, 1 - 2 r/(pi H) in 2D (r < H).
// Where g has a value to be compared with (1 in an ideal gas), over the bins whose middle lies between two distances:
//
//   <name>.rms_deviation = sqrt(mean_k (g_k - value)^2),   <name>.largest_deviation = max_k |g_k - value|
//
// Both contain the noise of the bins; the second carries the standard error of the bin where it is.
#include <optional>

#include "odpd/analysis/observer.h"

namespace odpd {

struct RdfComparison {
  double value = 1.0;
  double from = 0.0, to = 0.0;  ///< distances (length)
};

struct RdfSettings {
  double r_max = 2.0;  ///< largest distance (length)
  std::int64_t bins = 100;
  std::optional<RdfComparison> comparison{};
  bool of_bodies = false;  ///< of centres of bodies in place of free particles
};

template <int D>
class Rdf : public Observer<D> {
 public:
  Rdf(ObserverSettings settings, RdfSettings rdf, const Scene<D>& scene);
  static std::unique_ptr<Observer<D>> make(const ObserverEntry<D>& entry);
  void measure(const Clock& clock, const Particles<D>& particles,
               const StepRecord<D>& record) override;
  void add_results(Results& results) const override;
  std::vector<std::string> series_columns() const override;

 private:
  struct Points {
    std::vector<Vec<D>> place;
    std::vector<std::int32_t> kind;                 // species or [[body]]; -1: does not count
    std::int64_t counted_from = 0, counted_to = 0;  // by this rank
  };
  Points points(const Particles<D>& particles, const Stage<D>& stage) const;
  std::size_t pair_index(std::int32_t a, std::int32_t b) const;
  /// Per column: turns pair counts of these points into g.
  std::vector<double> factors(const Points& points, const Communicator& ranks) const;
  double middle(std::size_t bin) const {
    return rdf_.r_max / static_cast<double>(bins_) * (static_cast<double>(bin) + 0.5);
  }
  void add_deviations(Results& results) const;

  RdfSettings rdf_;
  std::size_t bins_;
  const Scene<D>& scene_;
  std::vector<std::string> names_;  // of each kind of point
};

}  // namespace odpd
