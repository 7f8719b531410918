#include <Random123/philox.h>
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <set>
#include <vector>

#include "odpd/core/random.h"

namespace {

using odpd::CounterRandom;
using odpd::PairRandom;
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

// Philox4x32-10 of Random123, and the numbers made of its words as core/random.h says, by the standard library.
TEST(PairRandom, follows_its_definition) {
  for (const std::uint64_t seed : {std::uint64_t{1}, std::uint64_t{0xfedcba9876543210}}) {
    for (const std::uint64_t step : {std::uint64_t{0}, std::uint64_t{0x7123456789abcdef}}) {
      const PairRandom random(seed, step);
      std::vector<std::uint32_t> a, b;
      for (std::uint32_t k = 0; k < 300; ++k) {
        a.push_back(k * 77u);
        b.push_back(~k);
      }
      std::vector<double> w(a.size());
      std::array<std::vector<double>, 4> four;
      for (auto& column : four) column.resize(a.size());
      random.one(a, b, w);
      random.four(a, b, {four[0], four[1], four[2], four[3]});
      for (std::size_t k = 0; k < a.size(); ++k) {
        const auto words = [&](std::uint64_t stage) {
          const std::uint64_t when = 2 * step + stage;
          const r123::Philox4x32::ctr_type counter{{a[k], b[k], static_cast<std::uint32_t>(when),
                                                    static_cast<std::uint32_t>(when >> 32)}};
          const r123::Philox4x32::key_type key{
              {static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)}};
          return r123::Philox4x32{}(counter, key);
        };
        const double turn = 2.0 * std::numbers::pi;
        const auto along = words(0), across = words(1);
        const std::uint64_t bits = along[0] | (static_cast<std::uint64_t>(along[1]) << 32);
        const double u = (static_cast<double>(bits >> 12) + 0.5) * 0x1p-52;
        const double v = (along[2] + 0.5) * 0x1p-32;
        EXPECT_NEAR(w[k], std::sqrt(-2.0 * std::log(u)) * std::cos(turn * v), 1e-11);
        for (std::size_t pair = 0; pair < 2; ++pair) {
          const std::uint32_t high = across[2 * pair], low = across[2 * pair + 1];
          const double radius =
              std::sqrt(-2.0 * std::log((high * 256.0 + (low & 0xffu) + 0.5) * 0x1p-40));
          const double angle = turn * ((low >> 8) + 0.5) * 0x1p-24;
          EXPECT_NEAR(four[2 * pair][k], radius * std::cos(angle), 1e-8);
          EXPECT_NEAR(four[2 * pair + 1][k], radius * std::sin(angle), 1e-8);
        }
        // Alone, a pair gets the same bits.
        double single = 0.0;
        random.one({&a[k], 1}, {&b[k], 1}, {&single, 1});
        EXPECT_EQ(single, w[k]);
      }
    }
  }
}

// Moments, and shares of a normal distribution beyond |w| = 2 and 4.
void expect_normal(const std::vector<double>& w) {
  const double n = static_cast<double>(w.size());
  std::array<double, 5> moment{};
  constexpr std::array<double, 2> limit{2.0, 4.0};
  std::array<double, 2> beyond{};
  for (const double x : w) {
    for (std::size_t k = 1; k < 5; ++k) moment[k] += std::pow(x, static_cast<double>(k)) / n;
    for (std::size_t t = 0; t < 2; ++t) beyond[t] += std::abs(x) > limit[t] ? 1.0 / n : 0.0;
  }
  EXPECT_NEAR(moment[1], 0.0, allowed * std::sqrt(1.0 / n));
  EXPECT_NEAR(moment[2], 1.0, allowed * std::sqrt(2.0 / n));
  EXPECT_NEAR(moment[3], 0.0, allowed * std::sqrt(15.0 / n));
  EXPECT_NEAR(moment[4], 3.0, allowed * std::sqrt(96.0 / n));
  for (std::size_t t = 0; t < 2; ++t) {
    const double p = std::erfc(limit[t] / std::sqrt(2.0));
    EXPECT_NEAR(beyond[t], p, allowed * std::sqrt(p * (1.0 - p) / n));
  }
}

// n pairs of neighbouring identities, as a fluid has them.
void neighbouring_pairs(std::uint32_t n, std::vector<std::uint32_t>& a,
                        std::vector<std::uint32_t>& b) {
  for (std::uint32_t k = 0; k < n; ++k) {
    a.push_back(k / 8);
    b.push_back(k / 8 + 1 + k % 8);
  }
}

TEST(PairRandom, numbers_are_normal_and_reach_into_the_tails) {
  std::vector<std::uint32_t> a, b;
  constexpr std::uint32_t n = 1000000;
  neighbouring_pairs(n, a, b);
  std::vector<double> w(n);
  std::array<std::vector<double>, 4> four;
  for (auto& column : four) column.resize(n);
  const PairRandom random(7, 12);
  random.one(a, b, w);
  random.four(a, b, {four[0], four[1], four[2], four[3]});
  expect_normal(w);
  for (const auto& column : four) expect_normal(column);
  // The largest of 5e6: beyond 4.6 and below 6.5, but for once in 1e9 (2 5e6 Q(6.5) = 4e-4 is the weaker bound).
  double largest = 0.0;
  for (const auto* column : {&w, &four[0], &four[1], &four[2], &four[3]})
    for (const double x : *column) largest = std::max(largest, std::abs(x));
  EXPECT_GT(largest, 4.6);
  EXPECT_LT(largest, 6.5);
}

TEST(PairRandom, numbers_of_neighbouring_keys_are_independent) {
  std::vector<std::uint32_t> a, b;
  constexpr std::uint32_t n = 200000;
  neighbouring_pairs(n, a, b);
  const auto one = [&](std::uint64_t seed, std::uint64_t step, const auto& low, const auto& high) {
    std::vector<double> w(n);
    PairRandom(seed, step).one(low, high, w);
    return w;
  };
  std::array<std::vector<double>, 4> four;
  for (auto& column : four) column.resize(n);
  PairRandom(3, 5).four(a, b, {four[0], four[1], four[2], four[3]});
  const std::vector<double> w = one(3, 5, a, b);
  std::vector<double> next_pair(w.begin() + 1, w.end());
  next_pair.push_back(w.front());
  std::vector<std::vector<double>> others = {
      one(3, 6, a, b), one(3, 5 + (std::uint64_t{1} << 31), a, b),
      one(4, 5, a, b), one(3 + (std::uint64_t{1} << 32), 5, a, b),
      one(3, 5, b, a), next_pair};
  others.insert(others.end(), four.begin(), four.end());
  others.push_back(w);
  // Mean of products of independent standard normals: error 1/sqrt(n), of their squares less one 2/sqrt(n).
  for (std::size_t x = 0; x < others.size(); ++x)
    for (std::size_t y = 0; y < x; ++y) {
      double product = 0.0, squares = 0.0;
      for (std::size_t k = 0; k < n; ++k) {
        product += others[x][k] * others[y][k] / n;
        squares += (others[x][k] * others[x][k] - 1.0) * (others[y][k] * others[y][k] - 1.0) / n;
      }
      EXPECT_NEAR(product, 0.0, allowed / std::sqrt(n)) << x << " with " << y;
      EXPECT_NEAR(squares, 0.0, 2.0 * allowed / std::sqrt(n)) << x << " with " << y;
    }
}

}  // namespace
