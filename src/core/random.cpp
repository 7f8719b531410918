#include "odpd/core/random.h"

#include <Random123/philox.h>

#include <cmath>
#include <numbers>

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

}  // namespace odpd
