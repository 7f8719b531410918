#pragma once
// Rigid bodies: of D + 1 particles, 0.5 wide, without symmetry; and a rod.
#include <array>

#include "odpd/particles/rigid_body.h"

namespace support {

template <int D>
odpd::RigidBody<D> simplex_body() {
  odpd::RigidBody<D> body;
  for (int k = 0; k < D + 1; ++k) {
    odpd::Vec<D> b{};
    if (k > 0) b[k - 1] = k == 1 ? 0.5 : 0.4;
    body.frame.push_back(b);
  }
  odpd::Vec<D> mean{};
  for (const odpd::Vec<D>& b : body.frame) mean += (1.0 / (D + 1)) * b;
  for (odpd::Vec<D>& b : body.frame) b -= mean;
  return body;
}

constexpr std::array<double, 3> rod_places{-0.6, -0.1, 0.7};

/// Points on a line that is no axis, which in 3D turns about two axes only.
template <int D>
odpd::RigidBody<D> rod_body() {
  const std::array<double, 3> direction =
      D == 2 ? std::array{0.6, 0.8, 0.0} : std::array{1.0 / 3.0, 2.0 / 3.0, -2.0 / 3.0};
  odpd::RigidBody<D> body;
  for (const double place : rod_places) {
    odpd::Vec<D> b;
    for (std::size_t c = 0; c < D; ++c) b.x[c] = place * direction[c];
    body.frame.push_back(b);
  }
  return body;
}

}  // namespace support
