#include "triad.h"

#include <algorithm>
#include <cstdint>
#include <memory>

#include "odpd/core/timer.h"

namespace bench {

double triad_bandwidth(int threads) {
  constexpr std::int64_t n = std::int64_t{1} << 25;
  const auto storage = std::make_unique_for_overwrite<double[]>(3 * n);
  double* const a = storage.get();
  double* const b = a + n;
  double* const c = b + n;
#pragma omp parallel for num_threads(threads) schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {  // each thread's pages next to it
    a[i] = 0.0;
    b[i] = 1.0;
    c[i] = 2.0;
  }
  double best = 0.0;
  for (int sweep = 0; sweep < 5; ++sweep) {
    const double q = 1.0 + sweep;
    const odpd::Stopwatch watch;
#pragma omp parallel for num_threads(threads) schedule(static)
    for (std::int64_t i = 0; i < n; ++i) a[i] = b[i] + q * c[i];
    best = std::max(best, 24.0 * static_cast<double>(n) / watch.seconds());
  }
  return 1e-9 * best;
}

}  // namespace bench
