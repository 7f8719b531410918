#include "odpd/analysis/heat.h"

#include <algorithm>
#include <cmath>

#include "odpd/core/parallel.h"
#include "odpd/operator/edge_sums.h"

namespace odpd {

template <int D>
void Heat<D>::add_stage(const Particles<D>& particles, const Stage<D>& stage,
                        const StepRecord<D>& record, double weight) {
  const PairNetwork<D>& network = stage.network;
  const auto slip = [&](const PairNetwork<D>& edges, std::size_t k) {
    return edges.slip(k, stage.velocity);
  };
  std::vector<double> friction(network.i.size()), noise(record.edge_noise.size());
  parallel_for(network.size(), [&](std::int64_t edge) {
    const auto k = static_cast<std::size_t>(edge);
    friction[k] = -dot(friction_of<D>(network, k, slip(network, k)), slip(network, k));
  });
  for (std::size_t k = 0; k < noise.size(); ++k)
    noise[k] = -dot(record.edge_noise[k], slip(record.start.network, k));

  std::vector<Vec<D>> force(stage.position.size());
  if (!record.edge_noise.empty())
    add_edge_forces<D>(record.start.network, record.edge_noise, force);
  add_friction_forces<D>(network, stage.velocity, force);
  add_sliding_friction(network, force);
  double walls = 0.0, driven = 0.0, rate = 0.0;
  for (std::size_t i = 0; i < force.size(); ++i) {
    const Vec<D>& v = stage.velocity[i];
    rate -= dot(v, stage.potential_force[i]);
    driven += dot(v, stage.driving_force[i]);
    if (!particles.is_free(i)) walls -= dot(v, force[i] + stage.potential_force[i]);
  }
  // The images that slide do work on what they meet, as a driving force does.
  for (std::size_t k = 0; k < network.slip_0.size(); ++k) {
    const double energy = -network.f_c[k] * dot(network.e[k], network.slip_0[k]);
    rate += energy;
    driven += energy - dot(friction_of<D>(network, k, slip(network, k)), network.slip_0[k]);
  }
  for (std::size_t k = 0; k < noise.size() && !network.slip_0.empty(); ++k)
    driven -= dot(record.edge_noise[k], record.start.network.slip_0[k]);
  const double dissipated = fixed_sum(friction), produced = dissipated + fixed_sum(noise);
  if (dissipated > 0.0)
    worst_ = std::max(worst_, std::abs(walls + driven - produced - rate) / dissipated);
  const std::array<double, 4> powers{produced, walls, driven, rate};
  for (std::size_t k = 0; k < powers.size(); ++k)
    newest_[k] += weight * powers[k] / scene_.fluid_volume();
}

template <int D>
void Heat<D>::measure(const Clock&, const Particles<D>& particles, const StepRecord<D>& record) {
  newest_.assign(average_.width(), 0.0);
  if (record.start_weight > 0.0) add_stage(particles, record.start, record, record.start_weight);
  if (record.has_corrector())
    add_stage(particles, record.corrector, record, 1.0 - record.start_weight);
  average_.add(newest_);
}

template <int D>
void Heat<D>::add_results(Results& results) const {
  if (average_.samples() == 0) return;
  const std::vector<std::string> names = series_columns();
  for (std::size_t k = 0; k < names.size(); ++k)
    results.scalars.push_back(
        {this->settings().name + "." + names[k], average_.mean(k), average_.standard_error(k)});
  results.scalars.push_back({this->settings().name + ".residual", worst_, 0.0});
}

template <int D>
void Heat<D>::save(StateWriter& out) const {
  out.write("worst", std::vector<double>{worst_});
  average_.save(out, "average");
}

template <int D>
void Heat<D>::load(const StateReader& in) {
  worst_ = in.read_doubles("worst").at(0);
  average_.load(in, "average");
}

template class Heat<2>;
template class Heat<3>;

}  // namespace odpd
