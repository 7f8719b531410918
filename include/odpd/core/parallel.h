#pragma once
// Loops over particles and edges on threads, and sums whose bits do not depend on the thread count.
#include <cstdint>
#include <span>

#ifdef _OPENMP
#include <omp.h>
#endif

namespace odpd {

/// Threads used from now on; 0 chooses one per 4000 particles, at most the machine's.
void set_threads(int threads, std::int64_t particles);
int threads();

/// body(i) for 0 <= i < n, each i once, in any order: bodies must write to places of their own.
template <class Body>
void parallel_for(std::int64_t n, const Body& body) {
#ifdef _OPENMP
  if (threads() > 1 && n > 512) {
#pragma omp parallel for schedule(static)
    for (std::int64_t i = 0; i < n; ++i) body(i);
    return;
  }
#endif
  for (std::int64_t i = 0; i < n; ++i) body(i);
}

// Sums in fixed blocks: each block is added up in order, then the blocks are, whatever the threads.
double fixed_dot(std::span<const double> a, std::span<const double> b);
double fixed_sum(std::span<const double> a);
double fixed_norm(std::span<const double> a);

}  // namespace odpd
