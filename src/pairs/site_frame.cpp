#include "odpd/pairs/site_frame.h"

#include <fmt/format.h>

#include "odpd/core/error.h"
#include "odpd/core/index.h"
#include "odpd/particles/rigid_body.h"

namespace odpd {

namespace {

// The particles fit their sites in more than one way: they lie on a line, or inside out.
template <int D>
[[noreturn]] void refuse_free_turn(const SiteFrame<D>& frame, const BalancedFrame<D>& balanced) {
  const bool mirrored = turn_under<D>(balanced.arms, balanced.arms, Vec<D>{}).has_value();
  throw BlowUpError(
      fmt::format("the particles {} to {}, tied to sites of one frame, lie {}, where the frame may "
                  "turn freely: use a smaller integrator.dt or a larger H",
                  frame.first, frame.first + static_cast<std::int64_t>(frame.sites.size()) - 1,
                  mirrored ? "as the mirror image of their sites" : "on a line or in one point"),
      frame.first);
}

// L_i/H of each particle.
template <int D>
std::vector<double> laplacians(const SiteFrame<D>& frame, const BalancedFrame<D>& balanced) {
  std::array<Vec<D>, D> response{};  // columns of M^-1
  for (int c = 0; c < rotation_components<D>; ++c) {
    Vec<D> unit{};
    unit[c] = 1.0;
    const auto column = turn_under<D>(balanced.sites, balanced.arms, unit);
    if (!column) refuse_free_turn(frame, balanced);
    response[index(c)] = *column;
  }
  const double share = 1.0 / static_cast<double>(frame.sites.size());
  std::vector<double> laplacian;
  for (const Vec<D>& site : balanced.sites) {
    laplacian.push_back(D * (1.0 - share));
    for (int axis = 0; axis < D; ++axis) {
      Vec<D> unit{}, turned{};
      unit[axis] = 1.0;
      const Vec<D> t = torque(site, unit);
      for (std::size_t c = 0; c < D; ++c) turned += t.x[c] * response[c];
      laplacian.back() -= dot(t, turned);
    }
  }
  return laplacian;
}

}  // namespace

template <int D>
BalancedFrame<D>::BalancedFrame(const SiteFrame<D>& frame, std::span<const Vec<D>> points)
    : arms(points.begin(), points.end()) {
  Vec<D> centre{};
  for (const Vec<D>& r : arms) centre += r;
  centre *= 1.0 / static_cast<double>(arms.size());
  for (Vec<D>& r : arms) r -= centre;
  const Rotation<D> turned = best_rotation(frame.sites, arms);
  for (const Vec<D>& site : frame.sites) sites.push_back(turned.turn(site));
}

template <int D>
double BalancedFrame<D>::distance_squared() const {
  double sum = 0.0;
  for (std::size_t k = 0; k < arms.size(); ++k) sum += dot(arms[k] - sites[k], arms[k] - sites[k]);
  return sum;
}

template <int D>
void write_frame(const SiteFrame<D>& frame, std::span<const Vec<D>> points, std::size_t edge,
                 PairNetwork<D>& network) {
  const BalancedFrame<D> balanced(frame, points);
  const std::vector<double> laplacian = laplacians(frame, balanced);
  const auto n = static_cast<double>(frame.sites.size());
  const double spring = frame.H / n;
  double all = 0.0;
  for (const double value : laplacian) all += value;
  std::size_t k = edge;
  for (std::size_t i = 0; i < frame.sites.size(); ++i)
    for (std::size_t j = i + 1; j < frame.sites.size(); ++j, ++k) {
      const Vec<D> d =
          balanced.arms[i] - balanced.arms[j] - (balanced.sites[i] - balanced.sites[j]);
      const Vec<D> force = -spring * d;
      network.u.set(k, 0.5 * spring * dot(d, d));
      network.f_c[k] = dot(force, network.e[k]);
      network.k_c.set(k, spring);
      auto& beyond = network.beyond[k - index(network.pairs())];
      beyond.force = force - network.f_c[k] * network.e[k];
      // These shares add up to L_i over the edges of i.
      const double share =
          n > 2.0 ? (laplacian[i] + laplacian[j] - all / (n - 1.0)) / (n - 2.0) : laplacian[i];
      beyond.curvature = frame.H * share;
      if (network.r[k] > 0.0) beyond.curvature -= spring - (D - 1) * network.f_c[k] / network.r[k];
    }
}

#define ODPD_INSTANTIATE(D)                                                               \
  template struct BalancedFrame<D>;                                                       \
  template void write_frame<D>(const SiteFrame<D>&, std::span<const Vec<D>>, std::size_t, \
                               PairNetwork<D>&);
ODPD_INSTANTIATE(2)
ODPD_INSTANTIATE(3)
#undef ODPD_INSTANTIATE

}  // namespace odpd
