// The parts of Motion that know rigid bodies: their arms, known motion, and motion along velocities of constituents.
#include <cmath>

#include "odpd/core/index.h"
#include "odpd/dynamics/motion.h"

namespace odpd {

template <int D>
std::vector<Vec<D>> Motion<D>::arms_at(const Box<D>& box, std::span<const Vec<D>> positions) {
  std::vector<Vec<D>> arms(positions.size()), own, points;
  for (std::size_t b = 0; b < particles_.bodies.size(); ++b) {
    const auto constituents = dofs().constituents(b);
    points.clear();
    for (const std::int32_t p : constituents) points.push_back(positions[index(p)]);
    own.resize(points.size());
    find_arms<D>(box, points, own);
    for (std::size_t k = 0; k < own.size(); ++k) arms[index(constituents[k])] = own[k];
  }
  return arms;
}

template <int D>
void Motion<D>::place_arms(Stage<D>& stage) {
  stage.arms = arms_at(stage.box, stage.position);
  for (std::size_t b = 0; b < particles_.bodies.size(); ++b) {
    if (stage.box.shear) count_boxes(b, stage);
    if (!particles_.bodies[b].known) continue;
    const RigidMotion<D> motion = surroundings_.known_motion(b, stage.time);
    for (const std::int32_t particle : dofs().constituents(b)) {
      const auto p = index(particle);
      stage.velocity[p] = motion.velocity + swing(motion.angular, stage.arms[p]);
    }
  }
}

/// From the centre at the step's start, which lies within half a box of where it is now.
template <int D>
void Motion<D>::count_boxes(std::size_t body, Stage<D>& stage) {
  const int up = box_.shear->gradient;
  for (const std::int32_t particle : dofs().constituents(body)) {
    const auto p = index(particle);
    const double whole = particles_.bodies[body].pose.centre[up] + stage.arms[p][up];
    stage.crossed[p] =
        static_cast<std::int32_t>(std::lround((whole - stage.position[p][up]) / box_.size[up]));
  }
}

template <int D>
bool Motion<D>::advance(std::size_t body, const std::vector<Vec<D>>& velocity, double dt,
                        const Box<D>& box, RigidPose<D>& pose) {
  const std::vector<Vec<D>>& frame = particles_.bodies[body].frame;
  std::vector<Vec<D>> arms, velocities;
  bool moves = false;
  for (std::size_t k = 0; k < frame.size(); ++k) {
    arms.push_back(pose.orientation.turn(frame[k]));
    velocities.push_back(velocity[index(dofs().constituents(body)[k])]);
    moves = moves || velocities.back() != Vec<D>{};
  }
  if (moves) pose.advance(rigid_motion<D>(arms, velocities), dt, box);
  // Under shear what lies across the face slides even if the centre stays.
  return moves || box.shear.has_value();
}

template <int D>
void Motion<D>::place(std::size_t body, const RigidPose<D>& pose, const Box<D>& box,
                      std::vector<Vec<D>>& positions,
                      std::vector<typename Particles<D>::Image>* images) {
  typename Particles<D>::Image unused;
  const auto constituents = dofs().constituents(body);
  for (std::size_t k = 0; k < constituents.size(); ++k) {
    const auto p = index(constituents[k]);
    place_constituent(particles_.bodies[body], pose, k, box, positions[p],
                      images == nullptr ? unused : (*images)[p]);
  }
}

#define ODPD_INSTANTIATE(D)                                                                        \
  template std::vector<Vec<D>> Motion<D>::arms_at(const Box<D>&, std::span<const Vec<D>>);         \
  template void Motion<D>::place_arms(Stage<D>&);                                                  \
  template void Motion<D>::count_boxes(std::size_t, Stage<D>&);                                    \
  template bool Motion<D>::advance(std::size_t, const std::vector<Vec<D>>&, double, const Box<D>&, \
                                   RigidPose<D>&);                                                 \
  template void Motion<D>::place(std::size_t, const RigidPose<D>&, const Box<D>&,                  \
                                 std::vector<Vec<D>>&,                                             \
                                 std::vector<typename Particles<D>::Image>*);
ODPD_INSTANTIATE(2)
ODPD_INSTANTIATE(3)
#undef ODPD_INSTANTIATE

}  // namespace odpd
