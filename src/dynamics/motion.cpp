#include "odpd/dynamics/motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "odpd/core/error.h"
#include "odpd/core/index.h"
#include "odpd/core/parallel.h"

namespace odpd {

namespace {

// Particles that one thread takes at a time.
constexpr std::int64_t range = 1024;
std::size_t ranges(std::int64_t n) { return index((n + range - 1) / range); }

}  // namespace

template <int D>
const DofMap<D>& Motion<D>::dofs() {
  if (!dofs_) dofs_ = std::make_unique<DofMap<D>>(particles_, mass_);
  return *dofs_;
}

template <int D>
void Motion<D>::locate(std::span<const Vec<D>> positions, double time, Stage<D>& stage) {
  const auto n = static_cast<std::int64_t>(positions.size());
  stage.time = time;
  stage.box = box_.at(time);
  stage.position.resize(positions.size());
  stage.velocity.resize(positions.size());
  stage.spin.assign(dofs().any_spin() ? positions.size() : 0, Vec<D>{});
  const Share own = particles_.owned();
  std::vector<char> lost(ranges(n), 0);
  parallel_ranges(n, range, [&](std::int64_t begin, std::int64_t end) {
    for (auto i = index(begin); i < index(end); ++i) {
      stage.position[i] = positions[i];
      stage.velocity[i] = particles_.is_known(i) && particles_.body_of(i) < 0
                              ? surroundings_.known_velocity(particles_.group[i], time)
                              : Vec<D>{};
      if (!finite(positions[i]) && own.owns(i)) lost[index(begin / range)] = 1;
    }
  });
  own.ranks->together([&] {
    if (std::count(lost.begin(), lost.end(), 1) == 0) return;
    for (auto i = index(own.first); i < index(own.last); ++i)
      if (!finite(positions[i]))
        throw BlowUpError(fmt::format("the position of particle {} at t = {:.6g} is not finite",
                                      particles_.id[i], time),
                          particles_.id[i]);
  });
  wrap_sheared(stage);
  if (!particles_.bodies.empty()) place_arms(stage);
}

template <int D>
std::vector<Vec<D>> Motion<D>::velocities(const Stage<D>& stage, const Unknowns& q) {
  std::vector<Vec<D>> velocity;
  dofs().scatter(stage.arms, q, stage.velocity, velocity);
  return velocity;
}

template <int D>
std::vector<Vec<D>> Motion<D>::spins(const Stage<D>& stage, const Unknowns& q) {
  std::vector<Vec<D>> spin;
  dofs().scatter_spins(q, stage.spin, spin);
  return spin;
}

template <int D>
void Motion<D>::check_paths(const std::vector<Vec<D>>& velocity, double dt) const {
  const auto n = static_cast<std::int64_t>(velocity.size());
  const auto too_far = [&](std::size_t i, int c) {
    return !(std::abs(dt * velocity[i][c]) < 0.5 * box_.size[c]);
  };
  const Share own = particles_.owned();
  std::vector<char> found(ranges(n), 0);
  parallel_ranges(n, range, [&](std::int64_t begin, std::int64_t end) {
    bool any = false;
    for (auto i = index(begin); i < index(end); ++i)
      for (int c = 0; c < D; ++c) any = any || too_far(i, c);
    found[index(begin / range)] = any ? 1 : 0;
  });
  own.ranks->together([&] {
    if (std::count(found.begin(), found.end(), 1) == 0) return;
    for (auto i = index(own.first); i < index(own.last); ++i)
      for (int c = 0; c < D; ++c)
        if (too_far(i, c))
          throw BlowUpError(
              fmt::format("particle {} would move {:.3g} in direction {}, more than half the "
                          "box ({:.3g})",
                          particles_.id[i], dt * velocity[i][c], "xyz"[c], box_.size[c]),
              particles_.id[i]);
  });
}

template <int D>
std::vector<Vec<D>> Motion<D>::displaced(const std::vector<Vec<D>>& velocity, double dt, double t,
                                         std::int64_t& crossings) {
  check_paths(velocity, dt);
  const auto n = static_cast<std::int64_t>(velocity.size());
  const Share own = particles_.owned();
  std::vector<Vec<D>> r = particles_.position;
  std::vector<std::int64_t> caught(ranges(n), 0);
  parallel_ranges(n, range, [&](std::int64_t begin, std::int64_t end) {
    for (auto i = index(begin); i < index(end); ++i) {
      r[i] += dt * velocity[i];
      if (!box_.shear) box_.wrap(r[i]);
      if (particles_.is_free(i) && surroundings_.confine(r[i]) && own.owns(i))
        ++caught[index(begin / range)];
    }
  });
  crossings += own.ranks->sum(std::accumulate(caught.begin(), caught.end(), std::int64_t{0}));
  if (!particles_.bodies.empty()) displace_bodies(velocity, dt, box_.at(t + dt), r);
  return r;
}

template <int D>
std::int64_t Motion<D>::move(const std::vector<Vec<D>>& velocity, double dt, double t) {
  check_paths(velocity, dt);
  const Share own = particles_.owned();
  const Box<D> box = moved_in_ = box_.at(t + dt);
  const std::vector<std::int32_t> images_before = moving_images();
  const auto n = static_cast<std::int64_t>(velocity.size());
  std::vector<std::int64_t> caught(ranges(n), 0);
  parallel_ranges(n, range, [&](std::int64_t begin, std::int64_t end) {
    for (auto i = index(begin); i < index(end); ++i) {
      particles_.position[i] += dt * velocity[i];
      particles_.velocity[i] = velocity[i];
      box.wrap(particles_.position[i], particles_.image[i]);
      if (particles_.is_free(i) && surroundings_.confine(particles_.position[i]) && own.owns(i))
        ++caught[index(begin / range)];
    }
  });
  if (!particles_.bodies.empty()) caught.front() += move_bodies(velocity, dt, box);
  leave_images(images_before);
  return own.ranks->sum(std::accumulate(caught.begin(), caught.end(), std::int64_t{0}));
}

template <int D>
auto Motion<D>::times_inertia(const Stage<D>& stage, const Unknowns& q, double inertia)
    -> Unknowns {
  if (inertia == 0.0) return Unknowns(q.size(), 0.0);
  Unknowns l = q;
  dofs().times_inertia(stage.arms, l);
  for (double& value : l) value *= inertia;
  return l;
}

template <int D>
auto Motion<D>::end_velocity(const Stage<D>& stage) -> Unknowns {
  if (particles_.end_velocity.empty()) return Unknowns(index(dofs().unknowns()), 0.0);
  Unknowns q;
  dofs().gather(stage.arms, particles_.end_velocity, q);
  dofs().divide_by_inertia(stage.arms, q);
  const auto spinning = dofs().spin_particles();
  for (std::size_t s = 0; s < spinning.size(); ++s)
    for (std::size_t c = 0; c < D; ++c) q[s * D + c] = particles_.end_spin[index(spinning[s])].x[c];
  return q;
}

template <int D>
void Motion<D>::set_end_momentum(const Unknowns& p) {
  const std::vector<Vec<D>> known = particles_.end_velocity;
  Unknowns q = p;
  std::vector<Vec<D>> arms;
  if (dofs().bodies() > 0) arms_at(moved_in_, particles_.position, arms);
  dofs().divide_by_inertia(arms, q);
  cross_faces(q);
  dofs().scatter(arms, q, known, particles_.end_velocity);
  const std::vector<Vec<D>> known_spin = particles_.end_spin;
  dofs().scatter_spins(q, known_spin, particles_.end_spin);
}

template class Motion<2>;
template class Motion<3>;

}  // namespace odpd
