// The parts of Motion that know sliding images.
#include "odpd/core/index.h"
#include "odpd/core/parallel.h"
#include "odpd/dynamics/motion.h"

namespace odpd {

template <int D>
void Motion<D>::wrap_sheared(Stage<D>& stage) const {
  stage.crossed.assign(box_.shear ? stage.position.size() : 0, 0);
  if (!box_.shear) return;
  const auto gradient = index(box_.shear->gradient);
  parallel_for(static_cast<std::int64_t>(stage.position.size()), [&](std::int64_t particle) {
    const auto i = index(particle);
    std::array<std::int32_t, index(D)> image{};
    stage.box.wrap(stage.position[i], image);
    stage.crossed[i] = image[gradient];
  });
}

template <int D>
std::vector<std::int32_t> Motion<D>::moving_images() const {
  std::vector<std::int32_t> images(box_.shear ? particles_.position.size() : 0);
  parallel_for(static_cast<std::int64_t>(images.size()), [&](std::int64_t particle) {
    const auto i = index(particle);
    images[i] = particles_.moving_image(i)[index(box_.shear->gradient)];
  });
  return images;
}

/// After a move from moving images `before`: what velocities lose. `Particles::velocity` becomes that of what is in the
/// box.
template <int D>
void Motion<D>::leave_images(const std::vector<std::int32_t>& before) {
  faces_crossed_.assign(before.size(), Vec<D>{});
  const std::vector<std::int32_t> after = moving_images();
  parallel_for(static_cast<std::int64_t>(before.size()), [&](std::int64_t particle) {
    const auto i = index(particle);
    const int flow = box_.shear->flow;
    const std::int32_t here = particles_.image[i][index(box_.shear->gradient)];
    faces_crossed_[i][flow] = (after[i] - before[i]) * moved_in_.sliding;
    particles_.velocity[i][flow] -= (here - before[i]) * moved_in_.sliding;
  });
}

template <int D>
void Motion<D>::cross_faces(Unknowns& q) {
  if (faces_crossed_.empty()) return;
  const std::span<double> velocity = dofs().velocities(std::span(q));
  const auto cross = [&](std::size_t node, std::int32_t particle) {
    for (std::size_t c = 0; c < D; ++c)
      velocity[node * D + c] -= faces_crossed_[index(particle)].x[c];
  };
  const auto free = dofs().free_particles();
  for (std::size_t k = 0; k < free.size(); ++k) cross(dofs().free_node(k), free[k]);
  for (std::size_t b = 0; b < index(dofs().bodies()); ++b)
    cross(dofs().body_node(b), dofs().constituents(b).front());
}

#define ODPD_INSTANTIATE(D)                                                \
  template void Motion<D>::wrap_sheared(Stage<D>&) const;                  \
  template std::vector<std::int32_t> Motion<D>::moving_images() const;     \
  template void Motion<D>::leave_images(const std::vector<std::int32_t>&); \
  template void Motion<D>::cross_faces(std::vector<double>&);
ODPD_INSTANTIATE(2)
ODPD_INSTANTIATE(3)
#undef ODPD_INSTANTIATE

}  // namespace odpd
