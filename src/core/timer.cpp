#include "odpd/core/timer.h"

namespace odpd {

std::string_view phase_name(Phase phase) {
  constexpr std::array<std::string_view, static_cast<std::size_t>(Phase::count)> names{
      "neighbours", "edges", "noise", "assembly", "solve", "sweep", "measure", "write"};
  return names[static_cast<std::size_t>(phase)];
}

}  // namespace odpd
