#include "odpd/operator/translations.h"

#include <algorithm>

#include "odpd/core/index.h"
#include "odpd/core/parallel.h"

namespace odpd {

namespace {

constexpr std::int64_t nodes_per_sum = 1024;

}  // namespace

auto Translations::own(std::size_t size, const Share& share) const -> Range {
  const auto front = static_cast<std::int64_t>(in_front(size)) / block;
  const std::int64_t begin = std::clamp<std::int64_t>(share.first - front, 0, nodes);
  return {begin, std::clamp<std::int64_t>(share.end(front + nodes) - front, begin, nodes)};
}

double Translations::squares(const Range& range) const {
  const std::int64_t weighted = std::clamp(nodes - std::ssize(weights), range.first, range.last);
  auto sum = static_cast<double>(weighted - range.first);
  for (std::int64_t n = weighted; n < range.last; ++n) sum += weight(n) * weight(n);
  return sum;
}

double Translations::squares(std::size_t size, const Share& share) const {
  return share.ranks->sum(squares(own(size, share)));
}

std::vector<double> Translations::sums(std::span<const double> x, const Share& share) const {
  const std::span<const double> part = x.subspan(in_front(x.size()));
  const Range range = own(x.size(), share);
  std::vector<double> sum(index(components), 0.0);
  for (std::int64_t n = range.first; n < range.last; ++n)
    for (std::size_t c = 0; c < sum.size(); ++c) sum[c] += weight(n) * part[first(n) + c];
  share.ranks->sum(std::span(sum));
  return sum;
}

void Translations::add(std::span<const double> a, std::span<double> x) const {
  const std::span<double> part = x.subspan(in_front(x.size()));
  parallel_for(nodes, [&](std::int64_t n) {
    for (std::size_t c = 0; c < a.size(); ++c) part[first(n) + c] += weight(n) * a[c];
  });
}

void Translations::remove_mean(std::span<double> x, const Share& share) const {
  if (nodes == 0) return;
  const std::span<double> part = x.subspan(in_front(x.size()));
  const auto count = index(components);
  // Sums in fixed blocks of nodes, whatever the threads, as fixed_sum does.
  const Range range = own(x.size(), share);
  const std::int64_t blocks = (range.last - range.first + nodes_per_sum - 1) / nodes_per_sum;
  std::vector<double> partial(index(blocks) * count, 0.0);
  parallel_for(blocks, [&](std::int64_t s) {
    double* const sum = &partial[index(s) * count];
    const std::int64_t begin = range.first + s * nodes_per_sum;
    const std::int64_t end = std::min(range.last, begin + nodes_per_sum);
    for (std::int64_t n = begin; n < end; ++n)
      for (std::size_t c = 0; c < count; ++c) sum[c] += weight(n) * part[first(n) + c];
  });
  std::vector<double> mean(count + 1, 0.0);  // and E^T E
  for (std::size_t k = 0; k < partial.size(); ++k) mean[k % count] += partial[k];
  mean.back() = squares(range);
  share.ranks->sum(std::span(mean));
  for (std::size_t c = 0; c < count; ++c) mean[c] /= mean.back();
  parallel_for(nodes, [&](std::int64_t n) {
    for (std::size_t c = 0; c < count; ++c) part[first(n) + c] -= weight(n) * mean[c];
  });
}

}  // namespace odpd
