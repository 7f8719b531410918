#pragma once
// A rigid body of D + 1 particles, 0.5 wide, without symmetry.
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

}  // namespace support
