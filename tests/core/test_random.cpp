#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <set>
#include <vector>

#include "odpd/core/random.h"

namespace {

using odpd::CounterRandom;
using odpd::Stream;

// A mean of n draws lies within 5 standard errors but once in 1.7e6; the seeds are fixed anyway.
constexpr double allowed = 5.0;

TEST(Random, philox_known_answers) {
  // Published with Random123 (tests/kat_vectors, philox4x64 with 10 rounds): counter, key, answer.
  struct Known {
    std::array<std::uint64_t, 4> counter;
    std::array<std::uint64_t, 2> key;
    std::array<std::uint64_t, 4> bits;
  };
  constexpr std::uint64_t all = ~std::uint64_t{0};
  const Known known[] = {
      {{0, 0, 0, 0},
       {0, 0},
       {0x16554d9eca36314c, 0xdb20fe9d672d0fdc, 0xd7e772cee186176b, 0x7e68b68aec7ba23b}},
      {{all, all, all, all},
       {all, all},
       {0x87b092c3013fe90b, 0x438c3c67be8d0224, 0x9cc7d7c69cd777b6, 0xa09caebf594f0ba0}},
      {{0x243f6a8885a308d3, 0x13198a2e03707344, 0xa4093822299f31d0, 0x082efa98ec4e6c89},
       {0x452821e638d01377, 0xbe5466cf34e90c6c},
       {0xa528f45403e61d95, 0x38c72dbd566e9788, 0xa5a1610e72fd18b5, 0x57bd43b5e52b7fe6}}};
  for (const Known& k : known) {
    const CounterRandom random(k.key[0], static_cast<Stream>(k.key[1]));
    const auto u = random.uniforms(k.counter[0], k.counter[1], k.counter[2], k.counter[3]);
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_EQ(u[i], (static_cast<double>(k.bits[i] >> 12) + 0.5) * 0x1p-52);
    }
  }
}

TEST(Random, the_same_counter_gives_the_same_bits_and_any_change_others) {
  const auto bits = [](std::uint64_t seed, Stream stream, std::uint64_t step, std::uint64_t stage,
                       std::uint64_t a, std::uint64_t b) {
    return std::bit_cast<std::uint64_t>(CounterRandom(seed, stream).uniforms(step, stage, a, b)[0]);
  };
  EXPECT_EQ(bits(1, Stream::pair_noise, 2, 0, 3, 4), bits(1, Stream::pair_noise, 2, 0, 3, 4));
  std::set<std::uint64_t> seen;
  std::size_t drawn = 0;
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    for (const Stream stream : {Stream::pair_noise, Stream::start_positions, Stream::start_species,
                                Stream::overlap_direction, Stream::probe}) {
      for (std::uint64_t k = 0; k < 81; ++k) {
        seen.insert(bits(seed, stream, k % 3, k / 3 % 3, k / 9 % 3, k / 27));
        ++drawn;
      }
    }
  }
  EXPECT_EQ(seen.size(), drawn);
}

TEST(Random, uniforms_are_inside_the_open_interval_with_the_right_moments) {
  const CounterRandom random(7, Stream::probe);
  constexpr std::uint64_t draws = 100000;
  double sum = 0.0, square = 0.0;
  std::vector<int> bins(16);
  for (std::uint64_t k = 0; k < draws; ++k) {
    for (const double u : random.uniforms(k, 0, 5, 6)) {
      ASSERT_GT(u, 0.0);
      ASSERT_LT(u, 1.0);
      sum += u;
      square += (u - 0.5) * (u - 0.5);
      ++bins[static_cast<std::size_t>(16.0 * u)];
    }
  }
  const double n = 4.0 * draws;
  EXPECT_NEAR(sum / n, 0.5, allowed * std::sqrt(1.0 / 12.0 / n));
  // Variance of (u - 1/2)^2: 1/80 - 1/144.
  EXPECT_NEAR(square / n, 1.0 / 12.0, allowed * std::sqrt((1.0 / 80.0 - 1.0 / 144.0) / n));
  double chi2 = 0.0;
  for (const int count : bins) chi2 += std::pow(count - n / 16.0, 2) / (n / 16.0);
  // 15 degrees of freedom: mean 15, standard deviation sqrt(30).
  EXPECT_NEAR(chi2, 15.0, allowed * std::sqrt(30.0));
}

TEST(Random, normals_have_the_moments_of_a_normal) {
  const CounterRandom random(11, Stream::pair_noise);
  constexpr std::uint64_t draws = 100000;
  double m1 = 0.0, m2 = 0.0, m3 = 0.0, m4 = 0.0, beyond = 0.0;
  for (std::uint64_t k = 0; k < draws; ++k) {
    for (const double w : random.normals(k, 0, 17, 42)) {
      m1 += w;
      m2 += w * w;
      m3 += w * w * w;
      m4 += w * w * w * w;
      if (std::abs(w) > 2.0) beyond += 1.0;
    }
  }
  const double n = 4.0 * draws;
  // Standard errors from the moments 1, 3, 15, 105 of even order.
  EXPECT_NEAR(m1 / n, 0.0, allowed * std::sqrt(1.0 / n));
  EXPECT_NEAR(m2 / n, 1.0, allowed * std::sqrt(2.0 / n));
  EXPECT_NEAR(m3 / n, 0.0, allowed * std::sqrt(15.0 / n));
  EXPECT_NEAR(m4 / n, 3.0, allowed * std::sqrt(96.0 / n));
  const double p = std::erfc(2.0 / std::sqrt(2.0));
  EXPECT_NEAR(beyond / n, p, allowed * std::sqrt(p * (1.0 - p) / n));
}

TEST(Random, normals_of_one_counter_and_of_neighbouring_counters_are_uncorrelated) {
  const CounterRandom noise(3, Stream::pair_noise), probe(3, Stream::probe);
  const CounterRandom next_seed(4, Stream::pair_noise);
  constexpr std::uint64_t draws = 100000;
  // Products of independent standard normals have mean 0 and variance 1; of squares less one, 4.
  std::array<double, 6> within{};
  std::array<double, 6> within_squares{};
  std::array<double, 5> between{};
  for (std::uint64_t k = 0; k < draws; ++k) {
    const auto w = noise.normals(k, 0, 8, 9);
    std::size_t pair = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = i + 1; j < 4; ++j, ++pair) {
        within[pair] += w[i] * w[j];
        within_squares[pair] += (w[i] * w[i] - 1.0) * (w[j] * w[j] - 1.0);
      }
    }
    between[0] += w[0] * noise.normals(k + 1, 0, 8, 9)[0];  // step
    between[1] += w[0] * noise.normals(k, 0, 8, 10)[0];     // identity
    between[2] += w[0] * noise.normals(k, 0, 9, 8)[0];      // identities exchanged
    between[3] += w[0] * probe.normals(k, 0, 8, 9)[0];      // stream
    between[4] += w[0] * next_seed.normals(k, 0, 8, 9)[0];  // seed
  }
  const double n = draws;
  for (const double sum : within) EXPECT_NEAR(sum / n, 0.0, allowed / std::sqrt(n));
  for (const double sum : within_squares) EXPECT_NEAR(sum / n, 0.0, 2.0 * allowed / std::sqrt(n));
  for (const double sum : between) EXPECT_NEAR(sum / n, 0.0, allowed / std::sqrt(n));
}

}  // namespace
