#pragma once
// The same work on one rank and on several that share the particles, each with all of them.
#include <vector>

#include "odpd/core/parallel.h"
#include "support/thread_team.h"

namespace contract {

/// What make(ranks) gives on each of so many ranks.
template <class Make>
auto on_ranks(int size, const Make& make) {
  odpd::set_threads(1, 0);
  std::vector<decltype(make(odpd::Communicator::alone()))> results(static_cast<std::size_t>(size));
  support::ThreadTeam::run(size, [&](const odpd::Communicator& ranks) {
    results[static_cast<std::size_t>(ranks.rank())] = make(ranks);
  });
  return results;
}

}  // namespace contract
