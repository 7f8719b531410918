#include "odpd/core/random.h"

#include <Random123/philox.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "odpd/core/isa.h"
#include "pair_random_kernels.h"

namespace odpd {

CounterRandom::CounterRandom(std::uint64_t seed, Stream stream)
    : seed_(seed), stream_(static_cast<std::uint64_t>(stream)) {}

std::array<double, 4> CounterRandom::uniforms(std::uint64_t step, std::uint64_t stage,
                                              std::uint64_t a, std::uint64_t b) const {
  const r123::Philox4x64::ctr_type counter{{step, stage, a, b}};
  const r123::Philox4x64::key_type key{{seed_, stream_}};
  const auto bits = r123::Philox4x64{}(counter, key);
  std::array<double, 4> u{};
  // 52 bits and half a unit: never 0, never 1, so that log(u) is finite.
  for (std::size_t k = 0; k < 4; ++k) u[k] = (static_cast<double>(bits[k] >> 12) + 0.5) * 0x1p-52;
  return u;
}

std::array<double, 4> CounterRandom::normals(std::uint64_t step, std::uint64_t stage,
                                             std::uint64_t a, std::uint64_t b) const {
  const std::array<double, 4> u = uniforms(step, stage, a, b);
  const double radius0 = std::sqrt(-2.0 * std::log(u[0]));
  const double radius1 = std::sqrt(-2.0 * std::log(u[1]));
  const double angle0 = 2.0 * std::numbers::pi * u[2];
  const double angle1 = 2.0 * std::numbers::pi * u[3];
  return {radius0 * std::cos(angle0), radius0 * std::sin(angle0), radius1 * std::cos(angle1),
          radius1 * std::sin(angle1)};
}

double CounterRandom::normal(std::uint64_t step, std::uint64_t stage, std::uint64_t a,
                             std::uint64_t b) const {
  const std::array<double, 4> u = uniforms(step, stage, a, b);
  return std::sqrt(-2.0 * std::log(u[0])) * std::cos(2.0 * std::numbers::pi * u[2]);
}

namespace {

const kernels::PairRandomKernels& pair_kernels() {
  using namespace kernels;
  return for_isa(pair_random_portable, pair_random_avx2, pair_random_avx512);
}

// Pairs per call of a kernel: a multiple of its lanes, few enough for the stack.
constexpr std::size_t most = 256;

// Calls body(first, n, padded n, a, b) for blocks of pairs that are padded to whole vectors.
template <class Body>
void in_blocks(std::span<const std::uint32_t> a, std::span<const std::uint32_t> b,
               const Body& body) {
  std::uint32_t low[most] = {}, high[most] = {};
  for (std::size_t first = 0; first < a.size(); first += most) {
    const std::size_t n = std::min(most, a.size() - first);
    std::copy_n(a.begin() + static_cast<std::ptrdiff_t>(first), n, low);
    std::copy_n(b.begin() + static_cast<std::ptrdiff_t>(first), n, high);
    body(first, n, static_cast<int>((n + 7) / 8 * 8), low, high);
  }
}

}  // namespace

void PairRandom::one(std::span<const std::uint32_t> a, std::span<const std::uint32_t> b,
                     std::span<double> w) const {
  double out[most];
  in_blocks(a, b,
            [&](std::size_t first, std::size_t n, int padded, const auto* low, const auto* high) {
              pair_kernels().one(seed_, step_, padded, low, high, out);
              std::copy_n(out, n, w.begin() + static_cast<std::ptrdiff_t>(first));
            });
}

void PairRandom::four(std::span<const std::uint32_t> a, std::span<const std::uint32_t> b,
                      const std::array<std::span<double>, 4>& w) const {
  double out[4][most];
  double* const columns[4] = {out[0], out[1], out[2], out[3]};
  in_blocks(a, b,
            [&](std::size_t first, std::size_t n, int padded, const auto* low, const auto* high) {
              pair_kernels().four(seed_, step_, padded, low, high, columns);
              for (std::size_t c = 0; c < 4; ++c)
                std::copy_n(out[c], n, w[c].begin() + static_cast<std::ptrdiff_t>(first));
            });
}

}  // namespace odpd
