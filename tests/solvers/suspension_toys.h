#pragma once
// Resistance operators of suspensions: rigid bodies on a shaken lattice in a random fluid of number density 8.
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "odpd/operator/rigid_resistance.h"
#include "solvers/resistance_toys.h"

namespace toys {

/// Points of a square or cubic lattice inside a ball.
template <int D>
std::vector<odpd::Vec<D>> ball(double radius, double spacing) {
  const int most = static_cast<int>(radius / spacing);
  const int side = 2 * most + 1;
  std::vector<odpd::Vec<D>> points;
  for (int n = 0; n < (D == 2 ? side * side : side * side * side); ++n) {
    odpd::Vec<D> r;
    for (int c = 0, rest = n; c < D; ++c, rest /= side) r[c] = spacing * (rest % side - most);
    if (norm(r) <= radius) points.push_back(r);
  }
  return points;
}

/// Points on a line.
template <int D>
std::vector<odpd::Vec<D>> rod(double length, double spacing) {
  std::vector<odpd::Vec<D>> points;
  const int steps = static_cast<int>(length / spacing);
  for (int n = 0; n <= steps; ++n) {
    points.emplace_back();
    points.back()[0] = spacing * (n - 0.5 * steps);
  }
  return points;
}

template <int D>
struct Suspension {
  /// side^D bodies, `apart` from centre to centre, turned at random; fluid up to `gap` from their points. `slid`: images along the last
  /// direction lie so much of the box aside.
  Suspension(const std::vector<odpd::Vec<D>>& shape, int side, double apart, double shift = 0.0,
             std::uint64_t seed = 3, bool hold = false, double slid = 0.0, double gap = 0.3)
      : fluid(apart * side, true), resistance(fluid.box, hold) {
    if (slid > 0.0) {
      fluid.box.shear =
          odpd::Shear{.flow = 0, .gradient = D - 1, .rate = 1.0, .start = slid * fluid.box.size[0]};
      fluid.box = fluid.box.at(0.0);
      resistance.slide(fluid.box);
    }
    const int bodies = D == 2 ? side * side : side * side * side;
    const auto shake = support::random_vectors<D>(static_cast<std::size_t>(bodies), seed);
    for (int b = 0; b < bodies; ++b) {
      odpd::RigidBody<D> body;
      body.frame = shape;
      odpd::Vec<D> angle{};
      for (int c = 0; c < odpd::rotation_components<D>; ++c)
        angle[c] = 3.0 * shake[static_cast<std::size_t>(b)][c];
      body.pose.orientation.advance(angle);
      for (int c = 0, rest = b; c < D; ++c, rest /= side)
        body.pose.centre[c] =
            apart * (rest % side + 0.5) + 0.1 * shake[static_cast<std::size_t>(b)][c];
      fluid.particles.add_body(body, fluid.box, 0);
    }
    const std::vector<odpd::Vec<D>> points = fluid.particles.position;
    const auto wanted = static_cast<std::size_t>(8.0 * std::pow(apart * side, D));
    for (const auto& r : support::random_points<D>({}, fluid.box.size, wanted, seed + 1))
      if (std::none_of(points.begin(), points.end(), [&](const odpd::Vec<D>& point) {
            return norm(fluid.box.separation(r, point)) < gap;
          }))
        fluid.particles.add(r, 0);
    fluid.connect(odpd::DpdModel<D>(1, {odpd::DpdParameters{}}));
    dofs.emplace(fluid.particles);
    arms.resize(fluid.particles.position.size());
    for (const auto& body : fluid.particles.bodies)
      for (std::size_t k = 0; k < body.frame.size(); ++k)
        arms[static_cast<std::size_t>(body.members[k])] = body.pose.orientation.turn(body.frame[k]);
    rebuild(shift);
  }
  Suspension(const Suspension&) = delete;
  void rebuild(double shift) {
    resistance.rebuild(fluid.network, *dofs, fluid.particles, fluid.particles.position, arms,
                       shift);
  }

  support::Fluid<D> fluid;
  std::optional<odpd::DofMap<D>> dofs;
  std::vector<odpd::Vec<D>> arms;
  odpd::RigidResistance<D> resistance;
};

}  // namespace toys
