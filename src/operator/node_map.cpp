#include "odpd/operator/node_map.h"

#include "odpd/core/index.h"
#include "odpd/core/parallel.h"

namespace odpd {

NodeMap::NodeMap(std::span<const char> known, int block_size) : block_(block_size) {
  node_.reserve(known.size());
  for (const char flag : known) {
    node_.push_back(flag != 0 ? -1 : static_cast<std::int32_t>(particle_.size()));
    if (flag == 0) particle_.push_back(static_cast<std::int32_t>(node_.size()) - 1);
  }
}

void NodeMap::gather(std::span<const double> values, std::span<double> q) const {
  const auto b = index(block_);
  parallel_for(nodes(), [&](std::int64_t node) {
    const auto n = index(node);
    const auto p = index(particle_[n]);
    for (std::size_t c = 0; c < b; ++c) q[n * b + c] = values[p * b + c];
  });
}

void NodeMap::scatter(std::span<const double> q, std::span<double> values) const {
  const auto b = index(block_);
  parallel_for(nodes(), [&](std::int64_t node) {
    const auto n = index(node);
    const auto p = index(particle_[n]);
    for (std::size_t c = 0; c < b; ++c) values[p * b + c] = q[n * b + c];
  });
}

}  // namespace odpd
