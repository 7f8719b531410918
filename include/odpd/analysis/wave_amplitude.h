#pragma once
// How strong the flow is along the wave (scene/flow_wave.h) that drives it or that it started with: u = a W(r), W of amplitude 1,
//
//   a = sum_i v_i . W(r_i) / sum_i |W(r_i)|^2       v_mid at the middle of the step's path
//
// Under a force of amplitude F on each particle that is n F/(eta k^2), so that the mean of a gives the viscosity at this wavelength. A flow
// that was given at the start decays by da/dt = -rate a, rate = eta k^2/(n m), and what is lost over what there was,
//
//   rate = [a(0) - a(T)] / int_0^T a dt
//
// knows no model for the noise of a and loses little to it: at rate T = 2 its error is 2.3 s rate/a(0), with s^2 = <a^2> at rest, where 2
// would be the least (and it is 3 (s/a(0))^2 too large, a tenth of that error at most where a(0) > 13 s). The standard error is that of a
// regression, of the misses of this balance from sample to sample.
#include "odpd/analysis/observer.h"

namespace odpd {

template <int D>
class WaveAmplitude : public Observer<D> {
 public:
  WaveAmplitude(ObserverSettings settings, const Scene<D>& scene, double dt);
  static std::unique_ptr<Observer<D>> make(const ObserverEntry<D>& entry);
  double moment() const override { return 0.5; }
  void measure(const Clock& clock, const Particles<D>& particles,
               const StepRecord<D>& record) override;
  void add_results(Results& results) const override;
  void save(StateWriter& out) const override;
  void load(const StateReader& in) override;

 private:
  bool driven() const { return scene_.settings().force_wave.number > 0; }
  Vec<D> wave_at(const Vec<D>& r) const;
  Scalar decay_rate() const;

  const Scene<D>& scene_;
  double interval_;  // time between samples
  // Of a decay: first and last amplitude; over all pairs of samples one after the other sums of the means, and of the squares of
  // differences, of means, and of one times the other.
  double first_ = 0.0, last_ = 0.0, area_ = 0.0;
  double difference_square_ = 0.0, mean_square_ = 0.0, mixed_ = 0.0;
};

}  // namespace odpd
