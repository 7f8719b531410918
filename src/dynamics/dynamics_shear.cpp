// The parts of Dynamics that know sliding images.
#include "odpd/core/index.h"
#include "odpd/core/parallel.h"
#include "odpd/dynamics/dynamics.h"

namespace odpd {

template <int D>
void Dynamics<D>::write_slips(Stage<D>& stage) const {
  PairNetwork<D>& network = stage.network;
  network.slip_0.resize(box_.shear ? network.i.size() : 0);
  if (!box_.shear) return;
  parallel_for(network.size(), [&](std::int64_t edge) {
    const auto k = index(edge);
    const auto i = index(network.i[k]), j = index(network.j[k]);
    const int up = stage.box.images_up(stage.position[i] - stage.position[j]) + stage.crossed[i] -
                   stage.crossed[j];
    network.slip_0[k] = Vec<D>{};
    network.slip_0[k][box_.shear->flow] = -up * stage.box.sliding;
  });
}

/// Implicit stiffness acts on the whole slip; what slip_0 gives is known.
template <int D>
auto Dynamics<D>::without_sliding_springs(const Stage<D>& stage, const StepWeights& weights,
                                          Unknowns load) -> Unknowns {
  const Unknowns rest(load.size(), 0.0);
  const auto subtract = [&](double time, const Unknowns& springs) {
    for (std::size_t k = 0; k < load.size(); ++k) load[k] -= time * springs[k];
  };
  const double more = weights.bond_time - weights.stiffness_time;
  if (weights.stiffness_time > 0.0) subtract(weights.stiffness_time, spring(stage, rest));
  if (more != 0.0 && stage.network.bonds > 0) subtract(more, bond_spring(stage, rest));
  return load;
}

/// Relative to the flow at their places particles do not move in the mean: the same wherever the box is cut.
template <int D>
void Dynamics<D>::add_mean_flow(const Stage<D>& stage, Unknowns& q) {
  const Share own = particles_.owned();
  Vec<D> mean{};
  for (std::int64_t row = 0; row < motion_.dofs().mobile(); ++row) {
    const auto i = index(motion_.dofs().particle_of(index(row)));
    if (!own.owns(i)) continue;
    mean += stage.box.flow_velocity(stage.position[i]);
    mean[box_.shear->flow] += stage.crossed[i] * stage.box.sliding;
  }
  own.ranks->sum(std::span(mean.x));
  const DofMap<D>& dofs = motion_.dofs();
  mean *= 1.0 / static_cast<double>(dofs.mobile_share().count(dofs.mobile()));
  motion_.dofs().translations().add(mean.x, q);
}

#define ODPD_INSTANTIATE(D)                                          \
  template void Dynamics<D>::write_slips(Stage<D>&) const;           \
  template std::vector<double> Dynamics<D>::without_sliding_springs( \
      const Stage<D>&, const StepWeights&, std::vector<double>);     \
  template void Dynamics<D>::add_mean_flow(const Stage<D>&, std::vector<double>&);
ODPD_INSTANTIATE(2)
ODPD_INSTANTIATE(3)
#undef ODPD_INSTANTIATE

}  // namespace odpd
