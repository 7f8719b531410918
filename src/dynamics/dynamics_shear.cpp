// The parts of Dynamics that know sliding images.
#include "odpd/core/parallel.h"
#include "odpd/dynamics/dynamics.h"

namespace odpd {

template <int D>
void Dynamics<D>::wrap_sheared(Stage<D>& stage) const {
  stage.crossed.assign(box_.shear ? stage.position.size() : 0, 0);
  if (!box_.shear) return;
  const auto gradient = static_cast<std::size_t>(box_.shear->gradient);
  parallel_for(static_cast<std::int64_t>(stage.position.size()), [&](std::int64_t particle) {
    const auto i = static_cast<std::size_t>(particle);
    std::array<std::int32_t, static_cast<std::size_t>(D)> image{};
    stage.box.wrap(stage.position[i], image);
    stage.crossed[i] = image[gradient];
  });
}

template <int D>
void Dynamics<D>::write_slips(Stage<D>& stage) const {
  PairNetwork<D>& network = stage.network;
  network.slip_0.resize(box_.shear ? network.i.size() : 0);
  if (!box_.shear) return;
  parallel_for(network.size(), [&](std::int64_t edge) {
    const auto k = static_cast<std::size_t>(edge);
    const auto i = static_cast<std::size_t>(network.i[k]),
               j = static_cast<std::size_t>(network.j[k]);
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

/// Relative to the flow at their places the nodes that translations move do not move in the mean: the same wherever the box
/// is cut.
template <int D>
void Dynamics<D>::add_mean_flow(const Stage<D>& stage, Unknowns& q) {
  Vec<D> mean{};
  const auto add = [&](std::int32_t particle, const Vec<D>& arm) {
    const auto i = static_cast<std::size_t>(particle);
    mean += stage.box.flow_velocity(stage.position[i] - arm);
    mean[box_.shear->flow] += stage.crossed[i] * stage.box.sliding;
  };
  for (const std::int32_t particle : dofs().free_particles()) add(particle, {});
  for (std::size_t b = 0; b < static_cast<std::size_t>(dofs().bodies()); ++b) {
    const std::int32_t first = dofs().constituents(b).front();
    add(first, stage.arms[static_cast<std::size_t>(first)]);
  }
  const auto nodes = static_cast<std::size_t>(dofs().translating_nodes());
  mean *= 1.0 / static_cast<double>(nodes);
  for (std::size_t k = q.size() - nodes * D; k < q.size(); ++k) q[k] += mean.x[k % D];
}

template <int D>
std::vector<std::int32_t> Dynamics<D>::moving_images() const {
  std::vector<std::int32_t> images(box_.shear ? particles_.position.size() : 0);
  parallel_for(static_cast<std::int64_t>(images.size()), [&](std::int64_t particle) {
    const auto i = static_cast<std::size_t>(particle);
    images[i] = particles_.moving_image(i)[static_cast<std::size_t>(box_.shear->gradient)];
  });
  return images;
}

/// After a move from moving images `before`: what velocities lose. `Particles::velocity` becomes that of what is in the box.
template <int D>
void Dynamics<D>::leave_images(const std::vector<std::int32_t>& before) {
  faces_crossed_.assign(before.size(), Vec<D>{});
  const std::vector<std::int32_t> after = moving_images();
  parallel_for(static_cast<std::int64_t>(before.size()), [&](std::int64_t particle) {
    const auto i = static_cast<std::size_t>(particle);
    const int flow = box_.shear->flow;
    const std::int32_t here = particles_.image[i][static_cast<std::size_t>(box_.shear->gradient)];
    faces_crossed_[i][flow] = (after[i] - before[i]) * moved_in_.sliding;
    particles_.velocity[i][flow] -= (here - before[i]) * moved_in_.sliding;
  });
}

template <int D>
void Dynamics<D>::cross_faces(Unknowns& q) {
  if (faces_crossed_.empty()) return;
  const auto cross = [&](std::size_t node, std::int32_t particle) {
    for (std::size_t c = 0; c < D; ++c)
      q[node * D + c] -= faces_crossed_[static_cast<std::size_t>(particle)].x[c];
  };
  const auto free = dofs().free_particles();
  for (std::size_t k = 0; k < free.size(); ++k) cross(dofs().free_node(k), free[k]);
  for (std::size_t b = 0; b < static_cast<std::size_t>(dofs().bodies()); ++b)
    cross(dofs().body_node(b), dofs().constituents(b).front());
}

#define ODPD_INSTANTIATE(D)                                                        \
  template void Dynamics<D>::wrap_sheared(Stage<D>&) const;                        \
  template void Dynamics<D>::write_slips(Stage<D>&) const;                         \
  template std::vector<double> Dynamics<D>::without_sliding_springs(               \
      const Stage<D>&, const StepWeights&, std::vector<double>);                   \
  template void Dynamics<D>::add_mean_flow(const Stage<D>&, std::vector<double>&); \
  template std::vector<std::int32_t> Dynamics<D>::moving_images() const;           \
  template void Dynamics<D>::leave_images(const std::vector<std::int32_t>&);       \
  template void Dynamics<D>::cross_faces(std::vector<double>&);
ODPD_INSTANTIATE(2)
ODPD_INSTANTIATE(3)
#undef ODPD_INSTANTIATE

}  // namespace odpd
