#pragma once
// Where the time goes: seconds per phase of a step. Times are reported, never decided upon.
#include <array>
#include <chrono>
#include <string_view>

#include "odpd/core/index.h"

namespace odpd {

enum class Phase { neighbours, edges, noise, assembly, solve, sweep, measure, write, count };

/// Name of a phase in reports and files.
std::string_view phase_name(Phase phase);

/// Seconds spent per phase.
struct PhaseSeconds {
  std::array<double, index(Phase::count)> seconds{};
  double& operator[](Phase p) { return seconds[index(p)]; }
  double operator[](Phase p) const { return seconds[index(p)]; }
};

/// Wall seconds since construction.
class Stopwatch {
 public:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  }

 private:
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

/// Adds the life time of this object to a phase.
class PhaseTimer {
 public:
  PhaseTimer(PhaseSeconds& sums, Phase phase) : sums_(sums), phase_(phase) {}
  ~PhaseTimer() { sums_[phase_] += watch_.seconds(); }
  PhaseTimer(const PhaseTimer&) = delete;
  PhaseTimer& operator=(const PhaseTimer&) = delete;

 private:
  PhaseSeconds& sums_;
  Phase phase_;
  Stopwatch watch_;
};

}  // namespace odpd
