#include "odpd/analysis/wave_amplitude.h"

#include <cmath>

#include "odpd/core/error.h"
#include "odpd/core/index.h"

namespace odpd {

template <int D>
WaveAmplitude<D>::WaveAmplitude(ObserverSettings settings, const Scene<D>& scene, double dt)
    : Observer<D>(std::move(settings), {"amplitude"}),
      scene_(scene),
      interval_(dt * static_cast<double>(this->settings().every)) {}

template <int D>
std::unique_ptr<Observer<D>> WaveAmplitude<D>::make(const ObserverEntry<D>& entry) {
  ObserverSettings settings = entry.settings();
  const SceneSettings<D>& s = entry.scene.settings();
  if (s.force_wave.number == 0 && s.start_wave.number == 0)
    entry.config.fail("kind",
                      "'wave' needs a wave to look for: give body_force.wave, or, with mass, "
                      "start.velocity and start.wave");
  return std::make_unique<WaveAmplitude<D>>(std::move(settings), entry.scene, entry.clock.dt);
}

template <int D>
Vec<D> WaveAmplitude<D>::wave_at(const Vec<D>& r) const {
  const SceneSettings<D>& s = scene_.settings();
  const Vec<D>& amplitude = driven() ? s.body_force : s.start_velocity;
  return (driven() ? s.force_wave : s.start_wave).at(r, s.box, 1.0 / norm(amplitude) * amplitude);
}

template <int D>
void WaveAmplitude<D>::measure(const Clock&, const Particles<D>& particles,
                               const StepRecord<D>& record) {
  const Share own = particles.owned();
  std::array<double, 2> sums{};
  for (std::size_t i = 0; i < record.v_mid.size(); ++i) {
    if (!particles.is_free(i) || !own.owns(i)) continue;
    const Vec<D> wave = wave_at(record.start.position[i] + (0.5 * record.dt) * record.v_mid[i]);
    sums[0] += dot(record.v_mid[i], wave);
    sums[1] += dot(wave, wave);
  }
  own.ranks->sum(std::span(sums));
  const double a = sums[0] / sums[1];
  if (this->average().samples() == 0) {
    first_ = a;
  } else {
    const double difference = a - last_, mean = 0.5 * (a + last_);
    area_ += mean;
    difference_square_ += difference * difference;
    mean_square_ += mean * mean;
    mixed_ += difference * mean;
  }
  last_ = a;
  this->add({a});
}

template <int D>
Scalar WaveAmplitude<D>::decay_rate() const {
  Scalar rate{this->named("decay_rate")};
  if (this->average().samples() < 2) return rate;
  // In units of one over the interval: x_i = -(difference) = rate mean + noise.
  const double per_interval = (first_ - last_) / area_;
  const double misses =
      difference_square_ + 2.0 * per_interval * mixed_ + per_interval * per_interval * mean_square_;
  rate.mean = per_interval / interval_;
  rate.standard_error = std::sqrt(std::max(misses, 0.0)) / (std::abs(area_) * interval_);
  return rate;
}

template <int D>
void WaveAmplitude<D>::add_results(Results& results) const {
  const SceneSettings<D>& s = scene_.settings();
  const double n = static_cast<double>(scene_.particles().free_count()) / scene_.fluid_volume();
  const Scalar amplitude = this->mean_of(0, this->named("amplitude"));
  results.scalars.push_back(amplitude);
  Scalar viscosity{this->named("viscosity")};
  if (driven()) {
    const double k2 = s.force_wave.wave_number_squared(s.box, s.body_force);
    viscosity.mean = n * norm(s.body_force) / (k2 * amplitude.mean);
    viscosity.standard_error = std::abs(viscosity.mean / amplitude.mean) * amplitude.standard_error;
  } else {
    const Scalar rate = decay_rate();
    results.scalars.push_back(rate);
    const double scale = n * s.mass / s.start_wave.wave_number_squared(s.box, s.start_velocity);
    viscosity.mean = scale * rate.mean;
    viscosity.standard_error = scale * rate.standard_error;
  }
  results.scalars.push_back(viscosity);
}

template <int D>
void WaveAmplitude<D>::save(StateWriter& out) const {
  Observer<D>::save(out);
  out.write("decay",
            std::vector<double>{first_, last_, area_, difference_square_, mean_square_, mixed_});
}

template <int D>
void WaveAmplitude<D>::load(const StateReader& in) {
  Observer<D>::load(in);
  const std::vector<double> decay = in.read_doubles("decay");
  if (decay.size() != 6)
    throw IoError("what the checkpoint has of a decaying wave does not fit: it is damaged");
  first_ = decay[0];
  last_ = decay[1];
  area_ = decay[2];
  difference_square_ = decay[3];
  mean_square_ = decay[4];
  mixed_ = decay[5];
}

template class WaveAmplitude<2>;
template class WaveAmplitude<3>;

}  // namespace odpd
