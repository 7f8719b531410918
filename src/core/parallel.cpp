#include "odpd/core/parallel.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "odpd/core/index.h"

namespace odpd {

namespace {

int thread_count = 1;
constexpr std::int64_t block_length = 1024;

template <class Term>
double blocked_sum(std::int64_t n, const Term& term) {
  const auto block_sum = [&](std::int64_t block) {
    const std::int64_t end = std::min(n, (block + 1) * block_length);
    double s = 0.0;
    for (std::int64_t i = block * block_length; i < end; ++i) s += term(i);
    return s;
  };
  const std::int64_t blocks = (n + block_length - 1) / block_length;
  double total = 0.0;
  if (threads() == 1 || blocks < 8) {
    for (std::int64_t k = 0; k < blocks; ++k) total += block_sum(k);
    return total;
  }
  std::vector<double> partial(index(blocks));
#pragma omp parallel for schedule(static)
  for (std::int64_t k = 0; k < blocks; ++k) partial[index(k)] = block_sum(k);
  for (double s : partial) total += s;
  return total;
}

}  // namespace

void set_threads(int threads, std::int64_t particles) {
#ifdef _OPENMP
  const int most = omp_get_num_procs();
  thread_count =
      threads > 0 ? threads : static_cast<int>(std::clamp<std::int64_t>(particles / 4000, 1, most));
  omp_set_num_threads(thread_count);
#else
  (void)threads;
  (void)particles;
#endif
}

int threads() { return thread_count; }

double fixed_dot(std::span<const double> a, std::span<const double> b) {
  return blocked_sum(static_cast<std::int64_t>(a.size()),
                     [&](std::int64_t i) { return a[index(i)] * b[index(i)]; });
}

double fixed_sum(std::span<const double> a) {
  return blocked_sum(static_cast<std::int64_t>(a.size()),
                     [&](std::int64_t i) { return a[index(i)]; });
}

double fixed_norm(std::span<const double> a) { return std::sqrt(fixed_dot(a, a)); }

}  // namespace odpd
