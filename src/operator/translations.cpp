#include "odpd/operator/translations.h"

#include <algorithm>

#include "odpd/core/index.h"
#include "odpd/core/parallel.h"

namespace odpd {

namespace {

constexpr std::int64_t nodes_per_sum = 1024;

}  // namespace

std::vector<double> Translations::sums(std::span<const double> x) const {
  const std::span<const double> part = x.subspan(in_front(x.size()));
  std::vector<double> sum(index(components), 0.0);
  for (std::int64_t n = 0; n < nodes; ++n)
    for (std::size_t c = 0; c < sum.size(); ++c) sum[c] += part[first(n) + c];
  return sum;
}

void Translations::add(std::span<const double> a, std::span<double> x) const {
  const std::span<double> part = x.subspan(in_front(x.size()));
  parallel_for(nodes, [&](std::int64_t n) {
    for (std::size_t c = 0; c < a.size(); ++c) part[first(n) + c] += a[c];
  });
}

void Translations::remove_mean(std::span<double> x) const {
  if (nodes == 0) return;
  const std::span<double> part = x.subspan(in_front(x.size()));
  const auto count = index(components);
  // Sums in fixed blocks of nodes, whatever the threads, as fixed_sum does.
  const std::int64_t blocks = (nodes + nodes_per_sum - 1) / nodes_per_sum;
  std::vector<double> partial(index(blocks) * count, 0.0);
  parallel_for(blocks, [&](std::int64_t s) {
    double* const sum = &partial[index(s) * count];
    const std::int64_t end = std::min(nodes, (s + 1) * nodes_per_sum);
    for (std::int64_t n = s * nodes_per_sum; n < end; ++n)
      for (std::size_t c = 0; c < count; ++c) sum[c] += part[first(n) + c];
  });
  std::vector<double> mean(count, 0.0);
  for (std::size_t k = 0; k < partial.size(); ++k) mean[k % count] += partial[k];
  for (double& m : mean) m /= static_cast<double>(nodes);
  parallel_for(nodes, [&](std::int64_t n) {
    for (std::size_t c = 0; c < count; ++c) part[first(n) + c] -= mean[c];
  });
}

}  // namespace odpd
