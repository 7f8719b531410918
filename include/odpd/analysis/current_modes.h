#pragma once
// Viscosity at a wavelength 2 pi/k of particles with mass, from one run at rest: how their currents along transverse waves decay.
//
//   J(t) = sum_i phi_i . v_i,     C(k, t) = k^2 (2/N) <J(0) J(t)> = k^2 kT/m at t = 0,     c(t) = C(k, t)/(k^2 kT/m)
//
//   rho dc/dt = -k^2 int_0^t eta(k; t - t') c(t') dt',     eta(k) = rho/(k^2 int_0^inf c dt),     rho = N m/V
//
// with phi a wave of analysis/waves.h, c the mean over all modes of a wave number (transverse current autocorrelation, TCAF:
// Palmer 1994; per particle as in Nguyen 2021, eq. 4.8). A force h phi drives a flow of amplitude n h/(eta(k) k^2) in the
// end: the area is the viscosity at zero frequency. analysis/current_decay.h has the fits of an exponential and of Maxwell's
// fluid, of c(t)/c(0).
//
// v is the velocity that the scheme steps from. For velocity-verlet that is the half-way one: the mean of two of them, which
// it gives for a full step, decays from its value at t = 0 as if there were a memory of tau = dt/2.
//
// Steps. The area is a sum over steps by the trapezoidal rule. For a mode that falls by q = 1 - lam dt (half-way velocities)
// or (2 - lam dt)/(2 + lam dt) (trapezoidal) in each, and has kT/m at full steps, it is 1/lam for any lam dt: that by which
// the scheme answers a steady force. (Half-way velocities have more than kT/m then, c(0) = 1/(1 - lam dt/2).) With `every`
// above 1 it is that of the steps in between, as an exponential has it.
//
// Noise. The mean square of J at full steps is known, but what a run has in its place is not: dividing c by it takes a third
// of the error out, and what kT a scheme is off. With rigid bodies it is less than that of k^2 kT/m, as they do not follow a
// wave, and areas are those of C/(k^2 kT/m), as they are where a half-way velocity is seen in some steps only.
//
// Memory. White noise makes an instantaneous friction eta_inf(k) = 2 <phi R phi>/(V k^2). With one time tau_m for the rest,
//
//   eta*(omega) = eta_inf + (eta - eta_inf)/(1 + i omega tau_m),     (eta - eta_inf) tau_m = eta tau
//
// with tau of Maxwell's fit, as both have the moment int t G(t) dt. Particles give way to one another after m/zeta, so that
// eta < eta_inf at masses near 1 and G' = -omega Im eta* is negative: such a fluid stores nothing.
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "odpd/analysis/mode_results.h"
#include "odpd/analysis/observer.h"
#include "odpd/analysis/wave_correlator.h"
#include "odpd/analysis/waves.h"

namespace odpd {

struct CurrentModeSettings {
  std::vector<std::int64_t> numbers;  ///< waves in the edge of the box, ascending
  std::vector<int> axes;              ///< directions of k; the box has the same edge along all
  double window = 0.0;                ///< lags (time); 0: 5 decays by eta_inf(k) and 10 m/friction
  std::int64_t extrapolate = 4;       ///< smallest wave numbers that eta_0 + a k^2 is fitted to
  bool half_way = false;              ///< v is v_mid of the record
};

template <int D>
class CurrentModes : public Observer<D> {
 public:
  CurrentModes(ObserverSettings settings, const CurrentModeSettings& modes, const Scene<D>& scene,
               double dt);
  static std::unique_ptr<Observer<D>> make(const ObserverEntry<D>& entry);
  double moment() const override { return modes_.half_way ? 0.5 : 0.0; }
  void measure(const Clock& clock, const Particles<D>& particles,
               const StepRecord<D>& record) override;
  void add_results(Results& results) const override;
  /// J of each mode.
  std::vector<std::string> series_columns() const override { return waves_.names("j"); }
  std::vector<double> series_row() const override { return current_; }
  void save(StateWriter& out) const override;
  void load(const StateReader& in) override;

 private:
  // What follows from c(t) of a wave number.
  struct Estimate {
    double eta, exponential, maxwell, tau, mean_square;
  };
  double interval() const { return dt_ * static_cast<double>(this->settings().every); }
  double rho() const;
  double eta_inf(std::size_t wave) const;
  bool has_bodies() const { return !scene_.particles().bodies.empty(); }
  /// particle_time: m/friction of a particle.
  void choose_lags(double particle_time);
  /// Of J at full steps over its exact value, where c has it; else c(0).
  double mean_square(std::span<const double> c) const;
  /// joins: where fits take over from c(t), by wave.
  std::vector<Estimate> estimates(const std::vector<double>& means,
                                  const std::vector<std::size_t>& joins) const;
  std::vector<double> means() const;
  std::vector<std::size_t> joins(const std::vector<double>& means) const;
  double memory_time(std::size_t wave, const Estimate& estimate) const;
  void add_notes(Results& results, const std::vector<Scalar>& tau) const;
  void add_tables(Results& results) const;
  Table correlation_table() const;
  Chart correlation_chart(const Results& results) const;

  const Scene<D>& scene_;
  CurrentModeSettings modes_;
  double dt_;
  std::size_t extrapolate_;
  Waves<D> waves_;
  ModeResults named_;
  WaveCorrelator correlator_;
  BlockAverage friction_;  // phi R phi of each wave number
  std::int64_t samples_ = 0;
  std::vector<double> current_;
};

}  // namespace odpd
