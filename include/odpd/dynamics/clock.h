#pragma once
// Simulated time, counted in steps: t = step * dt. Decisions are made on counts, never on seconds.
#include <cstdint>

namespace odpd {

struct Clock {
  double dt = 0.005;                     ///< time step
  std::int64_t step = 0;                 ///< steps done
  std::int64_t equilibration_steps = 0;  ///< nothing is measured during these
  std::int64_t total_steps = 0;          ///< equilibration included
  /// Somebody looks at the coming step. Where not, what only observers read may be left out.
  bool sampled = true;

  double time() const { return static_cast<double>(step) * dt; }
  bool finished() const { return step >= total_steps; }
  /// The step just done belongs to the measured part.
  bool measuring() const { return step > equilibration_steps; }
  std::int64_t measured_steps() const { return step - equilibration_steps; }
  void advance() { ++step; }
};

}  // namespace odpd
