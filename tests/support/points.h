#pragma once
// Random points, vectors and permutations with fixed seeds.
#include <algorithm>
#include <cstdint>
#include <numeric>
#include <random>
#include <vector>

#include "odpd/core/random.h"
#include "odpd/core/vec.h"

namespace support {

/// `count` independent points, uniform between low and high.
template <int D>
std::vector<odpd::Vec<D>> random_points(const odpd::Vec<D>& low, const odpd::Vec<D>& high,
                                        std::size_t count, std::uint64_t seed) {
  const odpd::CounterRandom random(seed, odpd::Stream::probe);
  std::vector<odpd::Vec<D>> points(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto u = random.uniforms(0, 0, i, 0);
    for (int c = 0; c < D; ++c) {
      points[i][c] = low[c] + (high[c] - low[c]) * u[static_cast<std::size_t>(c)];
    }
  }
  return points;
}

/// Independent standard normal numbers.
inline std::vector<double> random_numbers(std::size_t count, std::uint64_t seed) {
  const odpd::CounterRandom random(seed, odpd::Stream::probe);
  std::vector<double> x(count);
  for (std::size_t i = 0; i < count; ++i) x[i] = random.normal(1, 0, i, 0);
  return x;
}

template <int D>
std::vector<odpd::Vec<D>> random_vectors(std::size_t count, std::uint64_t seed) {
  const std::vector<double> x = random_numbers(count * D, seed);
  std::vector<odpd::Vec<D>> v(count);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t c = 0; c < D; ++c) v[i].x[c] = x[i * D + c];
  }
  return v;
}

/// 0 .. count - 1 in random order.
inline std::vector<std::int32_t> random_order(std::size_t count, std::uint32_t seed) {
  std::vector<std::int32_t> order(count);
  std::iota(order.begin(), order.end(), 0);
  std::mt19937 random(seed);
  std::shuffle(order.begin(), order.end(), random);
  return order;
}

/// All components the same.
template <int D>
odpd::Vec<D> uniform_vec(double value) {
  odpd::Vec<D> v;
  for (int c = 0; c < D; ++c) v[c] = value;
  return v;
}

}  // namespace support
