#pragma once
// Loops over all edges, in which each thread writes to particles of its own. Edges are read as they lie in memory, and every
// particle meets its own in ascending order: the same bits on any number of threads.
#include "odpd/core/index.h"
#include "odpd/core/parallel.h"
#include "odpd/pairs/network.h"

namespace odpd {

/// For each particle p in ascending order: incoming(p, k) for its edges with p = j, then row(p, begin, end) once, for its
/// edges begin <= k < end with p = i. Needs the network's i, j and `first`. Bonds are left out.
template <int D, class Incoming, class Row>
void for_each_owned_edge(const PairNetwork<D>& network, const Incoming& incoming, const Row& row) {
  const std::int64_t n = network.particles;
  const std::int64_t parts = n > 512 ? threads() : 1;
  const std::int64_t* const first = network.first.data();
  const std::int32_t* const j = network.j.data();
  const auto part = [&](std::int64_t k) {
    const std::int64_t begin = k * n / parts, end = (k + 1) * n / parts;
    // Rows are ascending: one of an earlier particle matters if its last partner is at least `begin`.
    for (std::int64_t p = 0; p < begin; ++p) {
      for (std::int64_t e = first[p + 1] - 1; e >= first[p] && j[e] >= begin; --e)
        if (j[e] < end) incoming(index(j[e]), index(e));
    }
    for (std::int64_t p = begin; p < end; ++p) {
      for (std::int64_t e = first[p]; e < first[p + 1] && j[e] < end; ++e)
        incoming(index(j[e]), index(e));
      row(index(p), index(first[p]), index(first[p + 1]));
    }
  };
#ifdef _OPENMP
  if (parts > 1) {
#pragma omp parallel for schedule(static, 1)
    for (std::int64_t k = 0; k < parts; ++k) part(k);
    return;
  }
#endif
  for (std::int64_t k = 0; k < parts; ++k) part(k);
}

}  // namespace odpd
