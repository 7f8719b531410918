#pragma once
// Mean-square angular displacement of the free particles that spin, per species, and their rotational diffusion coefficient,
//
//   phi(t) = integral of w dt,   D_r = (1/(2 n)) d/dt <|phi(t) - phi(0)|^2>,   n = 1 component in 2D, 3 in 3D
//
// (analysis/displacements.h). A sphere keeps no orientation, so w is summed up step by step: it looks at every step. One full window
// gives a mean. For short windows D_r is kT times the mobility by a torque (analysis/mobility.h).
#include "odpd/analysis/displacements.h"
#include "odpd/analysis/observer.h"
#include "odpd/analysis/observer_keys.h"

namespace odpd {

template <int D>
class AngularDisplacement : public Observer<D> {
 public:
  /// Displacements takes a sample every `steps` steps of dt.
  AngularDisplacement(ObserverSettings settings, const LagRange& lags, std::int64_t steps,
                      const Scene<D>& scene, double dt);
  /// Reads window and fit_from. Throws ConfigError, also where nobody spins.
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
  /// phi since the window began.
  std::string column() const { return "observer_" + this->named("angle"); }

  double window_, dt_;
  std::int64_t steps_, taken_ = 0;  // between samples, and since the last one
  const Scene<D>& scene_;
  std::vector<std::size_t> species_;  // those that spin
  Displacements displacements_;
};

}  // namespace odpd
