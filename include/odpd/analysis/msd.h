#pragma once
// Mean-square displacement of the free particles, per species, and the self-diffusion coefficient
//
//   D = (1/(2 d)) d/dt <|r(t) - r(0)|^2>          (Phan-Thien et al. 2016, eq. 52)
//
// as the least-squares slope between the lags `fit_from` and `window`. One window begins where the last one ended, so
// that each gives an independent sample; one full window gives a mean. `directions` leaves out those along a flow.
#include "odpd/analysis/block_average.h"
#include "odpd/analysis/observer.h"

namespace odpd {

struct MsdSettings {
  double window = 3.0;          ///< longest lag (time)
  double fit_from = 1.0;        ///< shortest lag of the slope (time)
  std::vector<int> directions;  ///< components that count
};

template <int D>
class Msd : public Observer<D> {
 public:
  /// lags are multiples of every * dt.
  Msd(ObserverSettings settings, MsdSettings msd, const Scene<D>& scene, double dt);
  void measure(const Clock& clock, const Particles<D>& particles,
               const StepRecord<D>& record) override;
  void add_results(Results& results) const override;
  std::vector<std::string> series_columns() const override;
  std::vector<double> series_row() const override { return newest_; }
  void save(StateWriter& out) const override;
  void load(const StateReader& in) override;

 private:
  void finish_window(const std::vector<double>& population);

  MsdSettings msd_;
  const Scene<D>& scene_;
  double lag_time_;
  std::int64_t lags_;
  std::size_t species_;
  std::int64_t lag_ = 0;        // samples since the window began
  std::vector<double> origin_;  // unwrapped positions there, by identity; empty before the first
  std::vector<double> window_;  // [lag * species + A], filled as lags come
  BlockAverage curve_;          // msd by lag and species, a sample per window
  BlockAverage diffusion_;      // D per species, then D over all, a sample per window
  std::vector<double> newest_;
};

}  // namespace odpd
