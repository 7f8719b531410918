#pragma once
// Mean-square displacement of the free particles, per species, and the self-diffusion coefficient
//
//   D = (1/(2 d)) d/dt <|r(t) - r(0)|^2>          (Phan-Thien et al. 2016, eq. 52)
//
// as the least-squares slope between the lags `fit_from` and `window`, one value per time origin (origins every quarter
// window), averaged over origins. `directions` leaves out those along a flow.
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
  struct Origin {
    std::int64_t sample = 0;       // index of the sample it was taken at
    std::vector<double> position;  // unwrapped, by identity
    std::vector<double> msd;       // [lag * species + A], filled as lags come
  };
  void finish(const Origin& origin);

  MsdSettings msd_;
  const Scene<D>& scene_;
  double lag_time_;
  std::int64_t lags_, spacing_;
  std::size_t species_;
  std::vector<double> population_;
  std::int64_t samples_ = 0;
  std::vector<Origin> origins_;
  BlockAverage curve_;      // msd by lag and species, a sample per finished origin
  BlockAverage diffusion_;  // D per species, then D over all, a sample per finished origin
  std::vector<double> newest_;
};

}  // namespace odpd
