#include "odpd/analysis/heat.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "odpd/core/index.h"
#include "odpd/core/parallel.h"
#include "odpd/operator/edge_sums.h"

namespace odpd {

namespace {

// Power of forces and torques on bodies. The random torque on a body is that with the arms of the step's start, whatever the stage:
// `velocity` becomes that of the constituents if they stood there.
template <int D>
double body_power(const Scene<D>& scene, const Particles<D>& particles, const StepRecord<D>& record,
                  const Stage<D>& stage, std::vector<Vec<D>>& velocity) {
  if (particles.bodies.empty()) return 0.0;
  double power = 0.0;
  const std::vector<std::int32_t> index_of = particles.index_of_id();
  for (std::size_t b = 0; b < particles.bodies.size(); ++b) {
    if (particles.bodies[b].known) continue;
    std::vector<std::size_t> at;
    std::vector<Vec<D>> arms, of_body;
    for (const std::int64_t id : particles.bodies[b].members) {
      at.push_back(index(index_of[index(id)]));
      arms.push_back(stage.arms[at.back()]);
      of_body.push_back(stage.velocity[at.back()]);
    }
    const RigidMotion<D> motion = rigid_motion<D>(arms, of_body);
    for (const std::size_t i : at)
      velocity[i] += swing(motion.angular, record.start.arms[i] - stage.arms[i]);
    const RigidLoad<D> load = scene.body_load(b, stage.time);
    power += dot(load.force, motion.velocity) + dot(load.torque, motion.angular);
  }
  return power;
}

}  // namespace

template <int D>
std::unique_ptr<Observer<D>> Heat<D>::make(const ObserverEntry<D>& entry) {
  ObserverSettings settings = entry.settings();
  if (entry.scene.settings().mass > 0.0)
    entry.config.fail("kind",
                      "the balance of heat is that of a massless fluid: fluid.mass must be 0");
  if (entry.scene.settings().zeta_0 > 0.0)
    entry.config.fail("kind", "the balance of heat leaves out the drag: fluid.zeta_0 must be 0");
  return std::make_unique<Heat<D>>(std::move(settings), entry.scene);
}

template <int D>
void Heat<D>::add_stage(const Particles<D>& particles, const Stage<D>& stage,
                        const StepRecord<D>& record, double weight, std::vector<double>& sample) {
  const PairNetwork<D>& network = stage.network;
  std::vector<double> friction(network.i.size()), noise(record.edge_noise.size());
  parallel_for(network.size(), [&](std::int64_t edge) {
    const auto k = index(edge);
    if (!network.counts(k)) return;
    const Vec<D> slip = network.slip(k, stage.velocity, stage.spin);
    friction[k] = -dot(friction_of(network, k, slip), slip);
  });

  std::vector<Vec<D>> force(stage.position.size());
  if (!record.edge_noise.empty())
    add_edge_forces<D>(record.start.network, record.edge_noise, force);
  add_friction_forces<D>(network, stage.velocity, force, stage.spin);
  add_sliding_friction(network, force);
  std::vector<Vec<D>> torque;  // about the particles' centres
  if (!stage.spin.empty()) {
    torque.resize(force.size());
    if (!record.edge_noise.empty())
      add_edge_torques<D>(record.start.network, record.edge_noise, torque);
    add_friction_torques<D>(network, stage.velocity, stage.spin, torque);
    add_sliding_torques(network, torque);
  }
  double walls = 0.0, driven = 0.0, shear = 0.0, rate = 0.0;
  for (std::size_t k = 0; k < network.slip_0.size(); ++k) {
    if (!network.counts(k)) continue;
    const Vec<D> pair = network.push(k);
    const Vec<D> drag = friction_of(network, k, network.slip(k, stage.velocity, stage.spin));
    rate -= dot(pair, network.slip_0[k]);
    shear -= dot(pair + drag, network.slip_0[k]);
  }
  for (std::size_t k = 0; k < record.start.network.slip_0.size() && k < noise.size(); ++k)
    if (record.start.network.counts(k))
      shear -= dot(record.edge_noise[k], record.start.network.slip_0[k]);
  const Share own = particles.owned();
  for (std::size_t i = 0; i < force.size(); ++i) {
    if (!own.owns(i)) continue;
    const Vec<D>& v = stage.velocity[i];
    rate -= dot(v, stage.potential_force[i]);
    driven += dot(v, stage.driving_force[i]);
    if (!particles.is_known(i)) continue;
    walls -= dot(v, force[i] + stage.potential_force[i]);
    if (!torque.empty()) walls -= dot(stage.spin[i], torque[i]);
  }
  std::vector<Vec<D>> velocity = stage.velocity;
  const double on_bodies = body_power(scene_, particles, record, stage, velocity);
  if (own.ranks->rank() == 0) driven += on_bodies;  // every rank knows them
  for (std::size_t k = 0; k < noise.size(); ++k)
    if (record.start.network.counts(k))
      noise[k] = -dot(record.edge_noise[k], record.start.network.slip(k, velocity, stage.spin));
  std::array<double, 6> sums{walls, driven, shear, rate, fixed_sum(friction), fixed_sum(noise)};
  own.ranks->sum(std::span(sums));
  std::tie(walls, driven, shear, rate) = std::tie(sums[0], sums[1], sums[2], sums[3]);
  const double dissipated = sums[4], produced = dissipated + sums[5];
  if (dissipated > 0.0)
    worst_ = std::max(worst_, std::abs(walls + driven + shear - produced - rate) / dissipated);
  const std::array<double, 5> powers{produced, walls, driven, shear, rate};
  for (std::size_t k = 0; k < powers.size(); ++k)
    sample[k] += weight * powers[k] / scene_.fluid_volume();
}

template <int D>
void Heat<D>::measure(const Clock&, const Particles<D>& particles, const StepRecord<D>& record) {
  std::vector<double> sample(this->average().width(), 0.0);
  if (record.start_weight > 0.0)
    add_stage(particles, record.start, record, record.start_weight, sample);
  if (record.has_corrector())
    add_stage(particles, record.corrector, record, 1.0 - record.start_weight, sample);
  this->add(std::move(sample));
}

template <int D>
void Heat<D>::add_results(Results& results) const {
  Observer<D>::add_results(results);
  const bool any = this->average().samples() > 0;
  results.scalars.push_back(without_error(this->named("residual"), any ? worst_ : std::nan(""),
                                          any ? 0.0 : std::nan("")));
}

template <int D>
void Heat<D>::save(StateWriter& out) const {
  out.write("worst", std::vector<double>{worst_});
  Observer<D>::save(out);
}

template <int D>
void Heat<D>::load(const StateReader& in) {
  worst_ = in.read_doubles("worst").at(0);
  Observer<D>::load(in);
}

template class Heat<2>;
template class Heat<3>;

}  // namespace odpd
