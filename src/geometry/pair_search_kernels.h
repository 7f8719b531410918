#pragma once
// Kernels of PairList::rebuild, one table per instruction path.
#include <cstdint>

namespace odpd::kernels {

/// Particles in the order of their cells: x[c][k] is component c, index[k] the index in memory. Both have 8 entries more than
/// there are particles, of any value.
struct SortedParticles {
  const double* x[3];
  const std::int32_t* index;
};

/// Candidates begin <= k < end, seen at x[c][k] + shift[c].
struct CandidateRun {
  std::int32_t begin, end;
  double shift[3];
};

/// Rows up to this length come out sorted, if asked for; in a sorted row no index may come twice.
constexpr int longest_sorted_row = 64;

struct PairSearchKernels {
  /// For each particle first <= k < last: the candidates of the runs closer than the root of reach2 with a larger index;
  /// row after row in `out`, lengths in `length`. `out` has room for all candidates of every particle, plus 64.
  using Search = void(const SortedParticles&, std::int32_t first, std::int32_t last,
                      const CandidateRun* runs, int n_runs, double reach2, bool sort,
                      std::int32_t* out, std::int32_t* length);
  Search* plane;  ///< D = 2
  Search* space;  ///< D = 3
};

extern const PairSearchKernels pair_search_portable, pair_search_avx2, pair_search_avx512;

}  // namespace odpd::kernels
