#pragma once
// The line on stderr that follows a run: step, simulated time, speed, time to go, iterations per solve.
#include "odpd/app/simulation.h"

namespace odpd {

template <int D>
class LiveLine {
 public:
  explicit LiveLine(const Simulation<D>& simulation);
  ~LiveLine();
  LiveLine(const LiveLine&) = delete;
  LiveLine& operator=(const LiveLine&) = delete;
  /// Call after every step; redraws at most five times a second on a terminal, otherwise a line per tenth of the run.
  void update();

 private:
  const Simulation<D>& simulation_;
  bool terminal_;
  bool drawn_ = false;
  std::int64_t first_step_;
  std::int64_t first_iterations_, first_solves_;
  double next_ = 0.2;
  std::int64_t tenths_;
  Stopwatch watch_;
};

}  // namespace odpd
