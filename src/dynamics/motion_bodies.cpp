// The parts of Motion that know rigid bodies: their arms, known motion, and motion along velocities of constituents.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "odpd/core/index.h"
#include "odpd/core/parallel.h"
#include "odpd/dynamics/motion.h"

namespace odpd {

template <int D>
void Motion<D>::arms_at(const Box<D>& box, std::span<const Vec<D>> positions,
                        std::vector<Vec<D>>& arms) {
  arms.resize(positions.size());
  parallel_for(static_cast<std::int64_t>(arms.size()),
               [&](std::int64_t particle) { arms[index(particle)] = Vec<D>{}; });
  const DofMap<D>& map = dofs();
  for_each_body<D>(particles_.bodies.size(), [&](std::size_t b, BodyScratch<D>& scratch) {
    const auto constituents = map.constituents(b);
    scratch.values.clear();
    for (const std::int32_t p : constituents) scratch.values.push_back(positions[index(p)]);
    scratch.arms.resize(constituents.size());
    find_arms<D>(box, scratch.values, scratch.arms);
    for (std::size_t k = 0; k < constituents.size(); ++k)
      arms[index(constituents[k])] = scratch.arms[k];
  });
}

template <int D>
void Motion<D>::place_arms(Stage<D>& stage) {
  arms_at(stage.box, stage.position, stage.arms);
  for_each_body<D>(particles_.bodies.size(), [&](std::size_t b, auto&) {
    if (stage.box.shear) count_boxes(b, stage);
    if (!particles_.bodies[b].known) return;
    const RigidMotion<D> motion = surroundings_.known_motion(b, stage.time);
    for (const std::int32_t particle : dofs_->constituents(b)) {
      const auto p = index(particle);
      stage.velocity[p] = motion.velocity + swing(motion.angular, stage.arms[p]);
      if (!stage.spin.empty()) stage.spin[p] = motion.angular;
    }
  });
}

/// From the centre at the step's start, which lies within half a box of where it is now.
template <int D>
void Motion<D>::count_boxes(std::size_t body, Stage<D>& stage) const {
  const int up = box_.shear->gradient;
  for (const std::int32_t particle : dofs_->constituents(body)) {
    const auto p = index(particle);
    const double whole = particles_.bodies[body].pose.centre[up] + stage.arms[p][up];
    stage.crossed[p] =
        static_cast<std::int32_t>(std::lround((whole - stage.position[p][up]) / box_.size[up]));
  }
}

template <int D>
bool Motion<D>::advance(std::size_t body, const std::vector<Vec<D>>& velocity, double dt,
                        const Box<D>& box, BodyScratch<D>& scratch, RigidPose<D>& pose) const {
  const std::vector<Vec<D>>& frame = particles_.bodies[body].frame;
  const auto constituents = dofs_->constituents(body);
  const bool moves = std::any_of(constituents.begin(), constituents.end(),
                                 [&](std::int32_t p) { return velocity[index(p)] != Vec<D>{}; });
  if (moves) {
    scratch.arms.clear();
    scratch.values.clear();
    for (std::size_t k = 0; k < frame.size(); ++k) {
      scratch.arms.push_back(pose.orientation.turn(frame[k]));
      scratch.values.push_back(velocity[index(constituents[k])]);
    }
    pose.advance(rigid_motion<D>(scratch.arms, scratch.values), dt, box);
  }
  // Under shear what lies across the face slides even if the centre stays.
  return moves || box.shear.has_value();
}

template <int D>
void Motion<D>::place(std::size_t body, const RigidPose<D>& pose, const Box<D>& box,
                      std::vector<Vec<D>>& positions,
                      std::vector<typename Particles<D>::Image>* images) const {
  typename Particles<D>::Image unused;
  const auto constituents = dofs_->constituents(body);
  for (std::size_t k = 0; k < constituents.size(); ++k) {
    const auto p = index(constituents[k]);
    place_constituent(particles_.bodies[body], pose, k, box, positions[p],
                      images == nullptr ? unused : (*images)[p]);
  }
}

template <int D>
void Motion<D>::displace_bodies(const std::vector<Vec<D>>& velocity, double dt, const Box<D>& box,
                                std::vector<Vec<D>>& positions) {
  dofs();
  for_each_body<D>(particles_.bodies.size(), [&](std::size_t b, BodyScratch<D>& scratch) {
    RigidPose<D> pose = particles_.bodies[b].pose;
    if (advance(b, velocity, dt, box, scratch, pose)) place(b, pose, box, positions, nullptr);
  });
}

template <int D>
std::int64_t Motion<D>::move_bodies(const std::vector<Vec<D>>& velocity, double dt,
                                    const Box<D>& box) {
  dofs();
  const Share own = particles_.owned();
  std::vector<std::int64_t> caught(particles_.bodies.size(), 0);
  for_each_body<D>(caught.size(), [&](std::size_t b, BodyScratch<D>& scratch) {
    RigidPose<D>& pose = particles_.bodies[b].pose;
    if (!advance(b, velocity, dt, box, scratch, pose)) return;
    place(b, pose, box, particles_.position, &particles_.image);
    for (const std::int32_t p : dofs_->constituents(b)) {
      Vec<D> r = particles_.position[index(p)];
      if (surroundings_.confine(r) && own.owns(std::int64_t{p})) ++caught[b];
    }
  });
  return std::accumulate(caught.begin(), caught.end(), std::int64_t{0});
}

#define ODPD_INSTANTIATE(D)                                                                       \
  template void Motion<D>::arms_at(const Box<D>&, std::span<const Vec<D>>, std::vector<Vec<D>>&); \
  template void Motion<D>::place_arms(Stage<D>&);                                                 \
  template void Motion<D>::displace_bodies(const std::vector<Vec<D>>&, double, const Box<D>&,     \
                                           std::vector<Vec<D>>&);                                 \
  template std::int64_t Motion<D>::move_bodies(const std::vector<Vec<D>>&, double, const Box<D>&);
ODPD_INSTANTIATE(2)
ODPD_INSTANTIATE(3)
#undef ODPD_INSTANTIATE

}  // namespace odpd
