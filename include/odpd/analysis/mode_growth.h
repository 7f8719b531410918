#pragma once
// The response chi of modes from how their displacements Phi grow at equilibrium, one chi for each wave number from all its
// modes:
//
//   <Phi(t)^2>/(2 kT) -> chi t   for t beyond the memory
//
// (integrated fluctuation-dissipation: h Phi is the work of forces h phi, to which the particles answer by d<Phi>/dt = h
// chi). The random force makes most of Phi, and what it makes is known where one solves for w = R^-1 phi at the step's start
// (`control`):
//
//   chi_0 = <phi.w>,     D = S - dt w.xi,     chi(t) t = chi_0 t - [<(sum D)^2> - <sum D^2>]/(2 kT)
//
// with S what Phi grows by in a step. For a w that is only nearly right chi_0 is 2 phi.w - w.R w, off by the square of its
// error. Time reversal makes Phi uncorrelated with the integral of the drift, which gives the sign; the noise of D itself,
// of order dt per step, is no memory, so that the diagonal is left out. Where only every c-th step is controlled, each
// stands for c of them, and pairs within these c for what <D D_c> and <D D_2c> extrapolate to.
//
// A stress of the whole box, integrated (analysis/helfand.h), is such a Phi too, but its noise moves nothing: it is
// uncorrelated with what the configuration does later, and the drift adds to chi (`drift_adds`).
//
// chi is the slope of chi(t) t by least squares between the lags `fit_from` and `window`; every lag time is an origin. With
// one time tau of the memory the line meets t = 0 at (chi_0 - chi) tau.
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "odpd/analysis/block_average.h"
#include "odpd/core/archive.h"

namespace odpd {

class ModeGrowth {
 public:
  struct Settings {
    double window = 0.5, fit_from = 0.2;  ///< time
    double dt = 0.0, kT = 1.0;
    std::size_t waves = 1, modes_per_wave = 1;
    std::int64_t control_every = 0;  ///< steps between controlled ones; 0: none
    bool drift_adds = false;         ///< to chi
  };
  struct Estimate {
    double mean = std::numeric_limits<double>::quiet_NaN();
    double error = std::numeric_limits<double>::quiet_NaN();
  };
  explicit ModeGrowth(const Settings& settings);

  bool controlled() const { return settings_.control_every > 0; }
  /// Per step, in the mean.
  double solves() const {
    return controlled() ? static_cast<double>(integral_.size()) /
                              static_cast<double>(settings_.control_every)
                        : 0.0;
  }
  /// The next step is to be added with what its control tells.
  bool control_is_due() const {
    return controlled() && (steps_ + 1) % settings_.control_every == 0;
  }
  /// The next step; by wave, then mode: S, and of controlled steps dt w.xi and phi.w.
  void add(std::span<const double> growth, std::span<const double> made = {},
           std::span<const double> response = {});

  std::int64_t samples() const { return average_.samples(); }
  std::size_t lags() const { return lags_; }
  double lag_time(std::size_t lag) const;
  /// The slope, with control where there is one.
  Estimate chi(std::size_t wave) const { return estimate(best(wave), 1.0); }
  /// The slope without it.
  Estimate plain(std::size_t wave) const { return estimate(wave * width() + lags_, 1.0); }
  /// chi_0, with control.
  Estimate frozen(std::size_t wave) const { return estimate(best(wave) + 1, 1.0); }
  /// tau, with control; of a memory within the errors of chi it has no meaning.
  Estimate memory_time(std::size_t wave) const;
  /// chi(t) of a lag from 1 to lags().
  Estimate at_lag(std::size_t wave, std::size_t lag) const;
  /// Standard error of a function of the chi of all waves.
  double error_of(const std::function<double(const std::vector<double>&)>& function) const;
  /// Phi of each mode.
  const std::vector<double>& integral() const { return integral_; }

  /// `prefix`: of the names, where an observer keeps several.
  void save(StateWriter& out, const std::string& prefix = "") const;
  /// Throws IoError for a state of other wave numbers or another window.
  void load(const StateReader& in, const std::string& prefix = "");

 private:
  // A sample has of each wave <Phi^2>/(2 kT) by lag and its slope; with control also chi(t) by lag, the slope of chi(t) t,
  // chi_0, and where the line of that slope meets t = 0.
  std::size_t width() const { return controlled() ? 2 * lags_ + 4 : lags_ + 1; }
  std::size_t best(std::size_t wave) const {
    return wave * width() + (controlled() ? 2 * lags_ + 1 : lags_);
  }
  Estimate estimate(std::size_t column, double scale) const;
  void control(std::span<const double> growth, std::span<const double> made,
               std::span<const double> response);
  void add_sample();
  void finish_control(std::span<double> of_wave, double response, double near) const;

  Settings settings_;
  std::int64_t steps_per_lag_;                  // a multiple of control_every
  std::size_t lags_;                            // in the window
  std::vector<double> weight_, offset_weight_;  // of each lag in the slope and in the line at t = 0
  std::int64_t steps_ = 0;
  std::vector<double> integral_;
  std::vector<double> history_;  // Phi at the last lags + 1 lag times, newest last
  // With control, of each mode: sums of D and of D^2 over controlled steps; the last two D, newest first.
  std::vector<double> drift_, square_, last_, before_;
  std::vector<double> drift_history_, square_history_;  // as history_
  // Of each wave, summed since the newest lag time: chi_0, and what D D_c and D D_2c extrapolate to.
  std::vector<double> response_, near_;
  BlockAverage average_;
};

}  // namespace odpd
