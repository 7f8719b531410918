#include "odpd/solvers/spin_blocks.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "odpd/core/index.h"
#include "odpd/core/parallel.h"
#include "odpd/solvers/preconditioner.h"

namespace odpd {

namespace {
constexpr std::int64_t spins_per_sum = 1024;  // whatever the threads
}

template <int D>
auto SpinBlocks<D>::inverse(const SpinResistance<D>& resistance, std::size_t row) -> Whole {
  Whole m = resistance.particle_block(row);
  if (!invert_definite(m, static_cast<int>(freedoms)))
    m.fill(std::numeric_limits<double>::quiet_NaN());
  return m;
}

template <int D>
void SpinBlocks<D>::resize(std::int64_t spins, std::int64_t first_place) {
  first_place_ = first_place;
  places_.resize(index(spins));
  coupling_.resize(index(spins));
  gathered_.resize(index(spins));
  sums_.resize(index((spins + spins_per_sum - 1) / spins_per_sum));
}

template <int D>
auto SpinBlocks<D>::product(std::size_t spin, const float* v) const -> Pair {
  constexpr std::int64_t stride = SlicedRows<D>::stride;
  const float* const linear = v + places_[spin] * stride;
  const float* const angular = v + (first_place_ + static_cast<std::int64_t>(spin)) * stride;
  Pair pair{};
  for (std::size_t r = 0; r < D; ++r)
    for (std::size_t c = 0; c < D; ++c) {
      const float entry = coupling_[spin][r * D + c];
      pair[r] += entry * angular[c];
      pair[D + c] += entry * linear[r];
    }
  return pair;
}

template <int D>
void SpinBlocks<D>::add(float factor, const Pair& pair, std::size_t spin, float* v) const {
  constexpr std::int64_t stride = SlicedRows<D>::stride;
  float* const linear = v + places_[spin] * stride;
  float* const angular = v + (first_place_ + static_cast<std::int64_t>(spin)) * stride;
  for (std::size_t c = 0; c < D; ++c) {
    linear[c] += factor * pair[c];
    angular[c] += factor * pair[D + c];
  }
}

template <int D>
double SpinBlocks<D>::couple(const float* r, float* z) {
  constexpr std::int64_t stride = SlicedRows<D>::stride;
  parallel_ranges(std::ssize(places_), spins_per_sum, [&](std::int64_t first, std::int64_t last) {
    double sum = 0.0;
    for (auto spin = index(first); spin < index(last); ++spin) {
      const Pair pair = product(spin, r);
      add(1.0F, pair, spin, z);
      const float* const linear = r + places_[spin] * stride;
      // That of the torque is the same again.
      for (std::size_t c = 0; c < D; ++c)
        sum += 2.0 * static_cast<double>(linear[c]) * static_cast<double>(pair[c]);
    }
    sums_[index(first / spins_per_sum)] = sum;
  });
  return std::accumulate(sums_.begin(), sums_.end(), 0.0);
}

template <int D>
void SpinBlocks<D>::gather(const float* v) {
  parallel_for(std::ssize(places_),
               [&](std::int64_t spin) { gathered_[index(spin)] = product(index(spin), v); });
}

template <int D>
void SpinBlocks<D>::subtract(float step, float* v) const {
  parallel_for(std::ssize(places_),
               [&](std::int64_t spin) { add(-step, gathered_[index(spin)], index(spin), v); });
}

template <int D>
std::int64_t SpinBlocks<D>::bytes() const {
  return static_cast<std::int64_t>(
      places_.size() * (sizeof(std::int32_t) + sizeof(coupling_[0]) + sizeof(gathered_[0])));
}

template class SpinBlocks<2>;
template class SpinBlocks<3>;

}  // namespace odpd
