#pragma once
// Mean-square displacement of the free particles, per species, and the self-diffusion coefficient (analysis/displacements.h).
// One full window gives a mean. `directions` leaves out those along a flow.
#include "odpd/analysis/displacements.h"
#include "odpd/analysis/observer.h"

namespace odpd {

struct MsdSettings {
  double window = 3.0;          ///< longest lag (time)
  double fit_from = 1.0;        ///< shortest lag of the slope (time)
  std::vector<int> directions;  ///< components that count
};

/// Reads window, fit_from and directions. Throws ConfigError.
template <int D>
MsdSettings read_msd(const ObserverEntry<D>& entry);
/// Steps between samples by default: fifty lags of up to 0.06 time units.
std::int64_t msd_interval(const Clock& clock);

template <int D>
class Msd : public Observer<D> {
 public:
  /// lags are multiples of every * dt.
  Msd(ObserverSettings settings, MsdSettings msd, const Scene<D>& scene, double dt);
  static std::unique_ptr<Observer<D>> make(const ObserverEntry<D>& entry);
  double moment() const override { return 1.0; }
  void measure(const Clock& clock, const Particles<D>& particles,
               const StepRecord<D>& record) override;
  void add_results(Results& results) const override;
  std::vector<std::string> series_columns() const override;
  std::vector<double> series_row() const override { return displacements_.newest(); }
  void save(StateWriter& out) const override;
  void load(const StateReader& in) override;

 private:
  /// Where the particles stood when the window began, unwrapped.
  std::string column() const { return "observer_" + this->named("origin"); }

  MsdSettings msd_;
  const Scene<D>& scene_;
  std::size_t species_;
  Displacements displacements_;
};

}  // namespace odpd
