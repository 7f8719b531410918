#include "odpd/app/live_line.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace odpd {

namespace {
std::int64_t tenths_done(const Clock& clock) {
  return 10 * clock.step / std::max<std::int64_t>(clock.total_steps, 1);
}
}  // namespace

template <int D>
LiveLine<D>::LiveLine(const Simulation<D>& simulation)
    : simulation_(simulation),
      terminal_(isatty(STDERR_FILENO) == 1),
      first_step_(simulation.clock().step),
      first_iterations_(simulation.dynamics().statistics().iterations),
      first_solves_(simulation.dynamics().statistics().solves),
      tenths_(tenths_done(simulation.clock())) {}

template <int D>
LiveLine<D>::~LiveLine() {
  if (terminal_ && drawn_) std::fputc('\n', stderr);
}

template <int D>
void LiveLine<D>::update() {
  const Clock& clock = simulation_.clock();
  const double seconds = watch_.seconds();
  if (terminal_ ? seconds < next_ && !clock.finished() : tenths_done(clock) == tenths_) return;
  next_ = seconds + 0.2;
  tenths_ = tenths_done(clock);
  drawn_ = true;
  const SolverStatistics& s = simulation_.dynamics().statistics();
  const double speed = static_cast<double>(clock.step - first_step_) / std::max(seconds, 1e-9);
  const std::int64_t solves = s.solves - first_solves_;
  const std::string iterations =
      solves == 0 ? ""
                  : fmt::format("  {:.1f} iterations/solve",
                                static_cast<double>(s.iterations - first_iterations_) /
                                    static_cast<double>(solves));
  fmt::print(stderr, "{}step {}/{}  t = {:.4g}{}  {:.0f} steps/s  {:.0f} s to go{}{}",
             terminal_ ? "\r" : "", clock.step, clock.total_steps, clock.time(),
             clock.measuring() ? "" : " (equilibrating)", speed,
             static_cast<double>(clock.total_steps - clock.step) / speed, iterations,
             terminal_ ? "   " : "\n");
  std::fflush(stderr);
}

template class LiveLine<2>;
template class LiveLine<3>;

}  // namespace odpd
