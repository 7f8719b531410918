#include "odpd/core/timer.h"

#include "odpd/core/index.h"

namespace odpd {

std::string_view phase_name(Phase phase) {
  constexpr std::array<std::string_view, index(Phase::count)> names{
      "neighbours", "edges", "noise", "assembly", "solve", "sweep", "measure", "write"};
  return names[index(phase)];
}

}  // namespace odpd
