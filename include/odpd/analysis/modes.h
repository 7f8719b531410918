#pragma once
// Viscosity at a wavelength 2 pi/k of particles without mass, from one run at rest: how far particles spread along
// transverse waves.
//
//   Phi(t) = int_0^t sum_i phi_i o dr_i (Stratonovich),    eta(k) = N^2/(2 V k^2 chi),    <Phi(t)^2>/(2 kT) -> chi t
//
// with phi a wave of analysis/waves.h: forces h phi drive a flow of amplitude N h/(V eta k^2), which is all that d<Phi>/dt =
// h chi says. In a step Phi grows by
//
//   S = dt [b sum phi(r).v1 + (1 - b) sum phi(r*).v2]
//
// as the step's displacement is the mean over its stages; phi(r) alone (Ito) would add a drift kT div(R^-1 phi) that grows
// with k. analysis/mode_growth.h has how chi follows, with the noise taken out where one asks for it (`control`), and eta(t;
// k) by lag t, which rises from the viscosity of frozen configurations to eta(k). Constituents of bodies and beads of
// molecules are particles as all others: eta(k) is that of the suspension, seen by a force on all of it.
//
// With one time of the memory, chi*(omega) = chi_0 - (chi_0 - chi)/(1 + i omega tau), so that eta* = N^2/(2 V k^2 chi*) is
// that of a Jeffreys fluid, from eta(k) at omega = 0 to that of frozen configurations, and the storage modulus is G' = -
// omega Im eta*.
//
// eta_inf(k) = 2 <phi R phi>/(V k^2) is the friction of particles that all follow the wave. Frozen configurations resist less, as
// particles in them give way.
#include <complex>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "odpd/analysis/mode_growth.h"
#include "odpd/analysis/mode_results.h"
#include "odpd/analysis/observer.h"
#include "odpd/analysis/observer_keys.h"
#include "odpd/analysis/waves.h"

namespace odpd {

struct ModeSettings {
  std::vector<std::int64_t> numbers;    ///< waves in the edge of the box, ascending
  std::vector<int> axes;                ///< directions of k; the box has the same edge along all
  double window = 0.5, fit_from = 0.2;  ///< lags between which chi is fitted (time)
  ControlKeys control = {};
  std::int64_t extrapolate = 4;  ///< smallest wave numbers that eta_0 + a k^2 is fitted to
};

template <int D>
class Modes : public Observer<D> {
 public:
  Modes(ObserverSettings settings, const ModeSettings& modes, const Scene<D>& scene, double dt);
  /// With mass: CurrentModes.
  static std::unique_ptr<Observer<D>> make(const ObserverEntry<D>& entry);
  /// Phi is that up to the step's end.
  double moment() const override { return 1.0; }
  double solves() const override { return growth_.solves(); }
  void measure(const Clock& clock, const Particles<D>& particles,
               const StepRecord<D>& record) override;
  void add_results(Results& results) const override;
  /// Phi of each mode.
  std::vector<std::string> series_columns() const override { return waves_.names("phi"); }
  std::vector<double> series_row() const override { return growth_.integral(); }
  void save(StateWriter& out) const override;
  void load(const StateReader& in) override;

 private:
  /// dt w.xi of every mode, and phi.w to second order in the error of w.
  void solve_modes(const Particles<D>& particles, const StepRecord<D>& record,
                   std::vector<double>& made, std::vector<double>& response) const;
  double viscosity(std::size_t wave, double chi) const;
  Scalar viscosity(const std::string& what, std::size_t wave,
                   const ModeGrowth::Estimate& chi) const;
  ModeResults as_results() const;
  std::complex<double> jeffreys(std::size_t wave, double tau, double omega) const;
  Table lag_table() const;
  Chart lag_chart(const Table& by_lag) const;

  const Scene<D>& scene_;
  double dt_, window_, control_tolerance_;
  std::size_t extrapolate_;
  Waves<D> waves_;
  ModeGrowth growth_;
  BlockAverage friction_;  // phi R phi of each wave number
  std::int64_t steps_ = 0, steps_per_window_;
};

}  // namespace odpd
