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

namespace {

template <int D>
using Rows = std::array<Vec<D>, index(D)>;

// sum_k X(e_k)^T X(a_k).
template <int D>
Rows<D> moments(std::span<const Vec<D>> arms, std::span<const Vec<D>> ends) {
  Rows<D> m{};
  for (std::size_t k = 0; k < arms.size(); ++k)
    for (int c = 0; c < rotation_components<D>; ++c) {
      Vec<D> unit{};
      unit[c] = 1.0;
      m[index(c)] += torque(ends[k], swing(unit, arms[k]));
    }
  return m;
}

// m^-1 l by elimination, none where a pivot is no moment beside `size`.
template <int D>
std::optional<Vec<D>> solve_moments(Rows<D> m, double size, const Vec<D>& l) {
  constexpr std::size_t n = rotation_components<D>;
  Vec<D> w = l;
  for (std::size_t p = 0; p < n; ++p) {
    if (!(m[p].x[p] > least_moment * size)) return std::nullopt;
    for (std::size_t row = p + 1; row < n; ++row) {
      const double factor = m[row].x[p] / m[p].x[p];
      m[row] -= factor * m[p];
      w.x[row] -= factor * w.x[p];
    }
  }
  for (std::size_t p = n; p-- > 0;) {
    for (std::size_t col = p + 1; col < n; ++col) w.x[p] -= m[p].x[col] * w.x[col];
    w.x[p] /= m[p].x[p];
  }
  return w;
}

// The moment about any axis across a rod's line; otherwise a size of all.
double moment_across(const Rows<2>& inertia) { return inertia[0][0]; }
double moment_across(const Rows<3>& inertia) {
  return 0.5 * (inertia[0][0] + inertia[1][1] + inertia[2][2]);
}

// No moment exceeds the sum of the other two, so where the least one is small the others are about alike, and the product of
// all three tells how small. Unlike the pivots of an elimination it keeps its precision whichever way the line points.
int rotations_of(const Rows<2>& inertia, double) { return moment_across(inertia) > 0.0 ? 1 : 0; }
int rotations_of(const Rows<3>& inertia, double least) {
  const double across = moment_across(inertia);
  if (!(across > 0.0)) return 0;
  const double product = dot(inertia[0], swing(inertia[1], inertia[2]));
  return product > least * across * across * across ? 3 : 2;
}

}  // namespace

template <int D>
std::array<Vec<D>, index(D)> moment_of_inertia(std::span<const Vec<D>> arms) {
  return moments<D>(arms, arms);
}

template <int D>
int rotations(std::span<const Vec<D>> arms, double least) {
  return rotations_of(moment_of_inertia<D>(arms), least);
}

template <int D>
Vec<D> angular_velocity(std::span<const Vec<D>> arms, const Vec<D>& l) {
  const Rows<D> inertia = moment_of_inertia<D>(arms);
  const double across = moment_across(inertia);
  const int turns = rotations_of(inertia, least_moment);
  if (turns == 0)
    throw ConfigError(
        "a rigid body has its constituents in one point: it has no moment of inertia");
  if (turns == rotation_components<D>)
    if (const auto w = solve_moments<D>(inertia, across, l)) return *w;
  // On a line along u, I = across (1 - u u^T), and its pseudo-inverse is I/across^2.
  Vec<D> w{};
  for (std::size_t c = 0; c < D; ++c) w.x[c] = dot(inertia[c], l) / (across * across);
  return w;
}

template <int D>
std::optional<Vec<D>> turn_under(std::span<const Vec<D>> arms, std::span<const Vec<D>> ends,
                                 const Vec<D>& l) {
  double arms_squared = 0.0, ends_squared = 0.0;
  for (std::size_t k = 0; k < arms.size(); ++k) {
    arms_squared += dot(arms[k], arms[k]);
    ends_squared += dot(ends[k], ends[k]);
  }
  return solve_moments<D>(moments<D>(arms, ends), std::sqrt(arms_squared * ends_squared), l);
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
  template std::array<Vec<D>, index(D)> moment_of_inertia<D>(std::span<const Vec<D>>);           \
  template int rotations<D>(std::span<const Vec<D>>, double);                                    \
  template Vec<D> angular_velocity<D>(std::span<const Vec<D>>, const Vec<D>&);                   \
  template std::optional<Vec<D>> turn_under<D>(std::span<const Vec<D>>, std::span<const Vec<D>>, \
                                               const Vec<D>&);                                   \
  template RigidMotion<D> rigid_motion<D>(std::span<const Vec<D>>, std::span<const Vec<D>>);
ODPD_INSTANTIATE(2)
ODPD_INSTANTIATE(3)
#undef ODPD_INSTANTIATE

}  // namespace odpd
