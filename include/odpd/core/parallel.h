#pragma once
// Loops over particles and edges on threads, and sums whose bits do not depend on the thread count.
#include <algorithm>
#include <atomic>
#include <cstdint>
#include <span>

#ifdef _OPENMP
#include <omp.h>
#endif

namespace odpd {

/// Threads used from now on; 0 chooses one per 4000 particles, at most the machine's.
void set_threads(int threads, std::int64_t particles);
int threads();

/// body(i) for 0 <= i < n, each i once, in any order: bodies must write to places of their own. On one thread below
/// `fewest`, where starting the others costs more.
template <class Body>
void parallel_for(std::int64_t n, const Body& body, [[maybe_unused]] std::int64_t fewest = 513) {
#ifdef _OPENMP
  if (threads() > 1 && n >= fewest) {
#pragma omp parallel for schedule(static)
    for (std::int64_t i = 0; i < n; ++i) body(i);
    return;
  }
#endif
  for (std::int64_t i = 0; i < n; ++i) body(i);
}

/// As parallel_for, for a few long bodies.
template <class Body>
void parallel_blocks(std::int64_t n, const Body& body) {
  parallel_for(n, body, 2);
}

/// body(begin, end) for ranges of `length` that cover 0 <= i < n (the last may be shorter), in any order.
template <class Body>
void parallel_ranges(std::int64_t n, std::int64_t length, const Body& body) {
  parallel_blocks((n + length - 1) / length,
                  [&](std::int64_t k) { body(k * length, std::min(n, (k + 1) * length)); });
}

/// least = min(least, value), from any thread.
inline void lower(std::atomic<std::int64_t>& least, std::int64_t value) {
  std::int64_t seen = least.load();
  while (value < seen && !least.compare_exchange_weak(seen, value)) {
  }
}

// Sums in fixed blocks: each block is added up in order, then the blocks are, whatever the threads.
double fixed_dot(std::span<const double> a, std::span<const double> b);
double fixed_sum(std::span<const double> a);
double fixed_norm(std::span<const double> a);

}  // namespace odpd
