#pragma once
// A small frame with a value of its own in every place.
#include <cstdint>

#include "odpd/io/frame.h"

namespace odpd::test {

inline Frame sample_frame(int dimension, int particles, std::int64_t step) {
  Frame frame;
  frame.dimension = dimension;
  frame.step = step;
  frame.time = 0.005 * static_cast<double>(step);
  for (int c = 0; c < dimension; ++c) {
    frame.box_size.push_back(10.0 + c);
    frame.periodic.push_back(c != 1);
  }
  for (int p = 0; p < particles; ++p) {
    frame.id.push_back(10 + 3 * p);
    frame.species.push_back(p % 2);
    frame.group.push_back(p % 3);
    for (int c = 0; c < dimension; ++c) {
      frame.position.push_back((p + 0.1 * c) / particles * 9.0 + 1e-9 * static_cast<double>(step));
      frame.image.push_back(p - c);
      frame.velocity.push_back(0.5 * p - 0.1 * c);
    }
  }
  frame.species_names = {"water", "oil \xC3\xA4"};
  return frame;
}

}  // namespace odpd::test
