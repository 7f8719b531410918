#pragma once
// Viscosity at equilibrium from the growth of the integrated stress (Helfand 1960), with the random force in it as an impulse:
//
//   G(t) = V int S_ab dt,     eta = d/dt <(G(t + s) - G(s))^2> / (2 V kT)
//
// S dt is summed over all steps, as a step's stress is the mean of its stages and its noise acts throughout the step. At mass 0 the
// noise alone gives the viscosity of particles that follow the mean flow; what answers it in the same step, and later, corrects
// that. (The integral of the correlation of S without the noise has the wrong sign for the friction.) Components: S_ab of all
// pairs a < b, symmetrised, and (S_aa - S_bb)/2, which isotropy makes equivalent. The slope is that of least squares between the
// lags `fit_from` and `window`; every lag time is an origin.
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "odpd/analysis/block_average.h"
#include "odpd/analysis/results.h"
#include "odpd/core/archive.h"

namespace odpd {

class Helfand {
 public:
  /// Lags are multiples of steps_per_lag * dt.
  struct Settings {
    double window = 0.5, fit_from = 0.2;  ///< time
    double dt = 0.0;
    std::int64_t steps_per_lag = 1;
    double volume = 1.0, kT = 1.0;
  };
  Helfand(const Settings& settings, std::size_t components);

  /// The step's stress, one number per component.
  void add(std::span<const double> stress);
  std::int64_t samples() const { return average_.samples(); }
  Scalar viscosity(std::string name) const;
  /// <(dG)^2>/(2 V kT) by lag.
  Table table() const;
  Chart chart() const;
  /// The components of G.
  const std::vector<double>& integral() const { return integral_; }

  void save(StateWriter& out) const;
  /// Throws IoError for a state of another width.
  void load(const StateReader& in);

 private:
  double lag_time(std::size_t lag) const;

  Settings settings_;
  std::size_t lags_;
  std::vector<double> integral_;
  std::vector<double> history_;  // integrals at the last lags + 1 lag times, newest last
  std::int64_t steps_ = 0;       // since the newest of them
  std::vector<double> weight_;   // of each lag in the slope
  BlockAverage average_;         // by lag, then the slope
};

}  // namespace odpd
