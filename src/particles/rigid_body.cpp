#include "odpd/particles/rigid_body.h"

#include <cmath>

#include "odpd/core/error.h"
#include "odpd/core/index.h"

namespace odpd {

template <int D>
void find_arms(const Box<D>& box, std::span<const Vec<D>> positions, std::span<Vec<D>> arms) {
  Vec<D> mean{};
  for (std::size_t k = 0; k < positions.size(); ++k) {
    arms[k] = box.separation(positions[k], positions[0]);
    mean += arms[k];
  }
  mean *= 1.0 / static_cast<double>(positions.size());
  for (Vec<D>& a : arms) a -= mean;
}

template <int D>
std::optional<Vec<D>> turn_under(std::span<const Vec<D>> arms, std::span<const Vec<D>> ends,
                                 const Vec<D>& l) {
  constexpr int n = rotation_components<D>;
  std::array<Vec<D>, D> m{};  // rows of sum X^T X
  double arms_squared = 0.0, ends_squared = 0.0;
  for (std::size_t k = 0; k < arms.size(); ++k) {
    arms_squared += dot(arms[k], arms[k]);
    ends_squared += dot(ends[k], ends[k]);
    for (int c = 0; c < n; ++c) {
      Vec<D> unit{};
      unit[c] = 1.0;
      m[index(c)] += torque(ends[k], swing(unit, arms[k]));
    }
  }
  const double size = std::sqrt(arms_squared * ends_squared);
  Vec<D> w = l;
  for (std::size_t p = 0; p < index(n); ++p) {
    if (!(m[p].x[p] > 1e-12 * size)) return std::nullopt;
    for (std::size_t row = p + 1; row < index(n); ++row) {
      const double factor = m[row].x[p] / m[p].x[p];
      m[row] -= factor * m[p];
      w.x[row] -= factor * w.x[p];
    }
  }
  for (std::size_t p = index(n); p-- > 0;) {
    for (std::size_t col = p + 1; col < index(n); ++col) w.x[p] -= m[p].x[col] * w.x[col];
    w.x[p] /= m[p].x[p];
  }
  return w;
}

template <int D>
Vec<D> angular_velocity(std::span<const Vec<D>> arms, const Vec<D>& l) {
  if (const auto w = turn_under(arms, arms, l)) return *w;
  throw ConfigError(
      "a rigid body has its constituents on a line or in one point: it has no moment of "
      "inertia about some axis");
}

template <int D>
RigidMotion<D> rigid_motion(std::span<const Vec<D>> arms, std::span<const Vec<D>> velocities) {
  RigidMotion<D> motion;
  Vec<D> l{};
  for (std::size_t k = 0; k < arms.size(); ++k) {
    motion.velocity += velocities[k];
    l += torque(arms[k], velocities[k]);
  }
  motion.velocity *= 1.0 / static_cast<double>(arms.size());
  motion.angular = angular_velocity<D>(arms, l);
  return motion;
}

#define ODPD_INSTANTIATE(D)                                                                      \
  template void find_arms<D>(const Box<D>&, std::span<const Vec<D>>, std::span<Vec<D>>);         \
  template Vec<D> angular_velocity<D>(std::span<const Vec<D>>, const Vec<D>&);                   \
  template std::optional<Vec<D>> turn_under<D>(std::span<const Vec<D>>, std::span<const Vec<D>>, \
                                               const Vec<D>&);                                   \
  template RigidMotion<D> rigid_motion<D>(std::span<const Vec<D>>, std::span<const Vec<D>>);
ODPD_INSTANTIATE(2)
ODPD_INSTANTIATE(3)
#undef ODPD_INSTANTIATE

}  // namespace odpd
