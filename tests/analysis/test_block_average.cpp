#include <gtest/gtest.h>

#include <cmath>

#include "odpd/analysis/block_average.h"
#include "odpd/core/error.h"
#include "support/memory_archive.h"
#include "support/points.h"

namespace {

using odpd::BlockAverage;

void add(BlockAverage& average, std::initializer_list<double> sample) {
  average.add(std::vector<double>(sample));
}

/// x_t = phi x_(t-1) + sqrt(1 - phi^2) w_t: variance 1, and the mean of n samples has the variance
/// (1 + phi)/(1 - phi)/n for n beyond the correlation time.
std::vector<double> correlated(double phi, std::size_t n, std::uint64_t seed) {
  std::vector<double> x = support::random_numbers(n, seed);
  for (std::size_t t = 1; t < n; ++t) x[t] = phi * x[t - 1] + std::sqrt(1.0 - phi * phi) * x[t];
  return x;
}

TEST(BlockAverage, MeanOfAllSamples) {
  BlockAverage average(2);
  double sum = 0.0;
  for (int k = 0; k < 1000; ++k) {
    add(average, {k * 0.5, -1.0 * k * k});
    sum += k * k;
  }
  EXPECT_EQ(average.samples(), 1000);
  EXPECT_EQ(average.width(), 2u);
  EXPECT_DOUBLE_EQ(average.mean(0), 0.25 * 999);
  EXPECT_DOUBLE_EQ(average.mean(1), -sum / 1000);
}

TEST(BlockAverage, HasNoErrorBelowSixteenBlocks) {
  BlockAverage average;
  for (int k = 0; k < 16; ++k) {
    EXPECT_TRUE(std::isnan(average.standard_error(0))) << "after " << k << " samples";
    EXPECT_TRUE(std::isnan(average.jackknife_error([](const auto& m) { return m[0]; })));
    add(average, {k % 2 == 0 ? 1.0 : -1.0});
  }
  // Variance of the 16 samples over 15 degrees of freedom, divided by 16.
  EXPECT_NEAR(average.standard_error(0), std::sqrt(1.0 / 15.0), 1e-14);
}

TEST(BlockAverage, AConstantHasNoError) {
  BlockAverage average;
  for (int k = 0; k < 5000; ++k) add(average, {0.75});
  EXPECT_EQ(average.mean(0), 0.75);
  EXPECT_NEAR(average.standard_error(0), 0.0, 1e-15);
}

// The estimated error over the true one, in 40 independent series. One estimate scatters by about
// 1/sqrt(2 * 16) = 18 % at most, the mean of 40 by 3 %; taking the largest of up to three block
// lengths lifts it by 10 to 20 %. Ignoring the correlation at phi = 0.9 would give 0.23.
TEST(BlockAverage, ErrorOfIndependentAndCorrelatedSamples) {
  for (const double phi : {0.0, 0.5, 0.9}) {
    constexpr std::size_t n = 20000, series = 40;
    const double exact = std::sqrt((1.0 + phi) / (1.0 - phi) / n);
    double ratio = 0.0, miss = 0.0;
    for (std::uint64_t seed = 0; seed < series; ++seed) {
      BlockAverage average;
      for (const double x : correlated(phi, n, seed)) average.add({&x, 1});
      ratio += average.standard_error(0) / exact / series;
      miss += average.mean(0) * average.mean(0) / (exact * exact) / series;
    }
    EXPECT_GT(ratio, 0.95) << "phi " << phi;
    EXPECT_LT(ratio, 1.30) << "phi " << phi;
    // The means scatter as they should: mean square 1, standard error sqrt(2/40) = 0.22, bound 4.
    EXPECT_NEAR(miss, 1.0, 0.9) << "phi " << phi;
  }
}

TEST(BlockAverage, SaveAndLoadMidStreamKeepEveryBit) {
  const auto x = support::random_numbers(3000, 1);
  for (const std::size_t stop : {0u, 5u, 64u, 129u, 1000u}) {
    BlockAverage through(3), first(3), second(3);
    for (std::size_t k = 0; k < 1000; ++k) {
      const std::span<const double> sample(&x[3 * k], 3);
      through.add(sample);
      if (k < stop) first.add(sample);
    }
    support::MemoryArchive archive;
    first.save(archive, "average");
    second.load(archive, "average");
    EXPECT_EQ(second.samples(), static_cast<std::int64_t>(stop));
    for (std::size_t k = stop; k < 1000; ++k) second.add({&x[3 * k], 3});
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_EQ(second.mean(c), through.mean(c));
      EXPECT_EQ(second.standard_error(c), through.standard_error(c));
    }
    const auto product = [](const std::vector<double>& m) { return m[0] * m[1]; };
    EXPECT_EQ(second.jackknife_error(product), through.jackknife_error(product));
  }
}

TEST(BlockAverage, RefusesADamagedState) {
  BlockAverage average(2);
  for (int k = 0; k < 100; ++k) add(average, {1.0 * k, 2.0});
  support::MemoryArchive whole;
  average.save(whole, "a");
  const auto load = [](const support::MemoryArchive& archive, std::size_t width) {
    BlockAverage copy(width);
    copy.load(archive, "a");
  };
  EXPECT_NO_THROW(load(whole, 2));
  EXPECT_THROW(load(whole, 3), odpd::IoError) << "the state of something else";
  for (const char* part : {"a/total", "a/open", "a/blocks"}) {
    support::MemoryArchive damaged = whole;
    damaged.doubles[part].pop_back();
    EXPECT_THROW(load(damaged, 2), odpd::IoError) << part;
    damaged.doubles.erase(part);
    EXPECT_THROW(load(damaged, 2), odpd::IoError) << part;
  }
  whole.integers["a/counts"].pop_back();
  EXPECT_THROW(load(whole, 2), odpd::IoError);
}

// N = 3 Y + w with w of mean 0 and variance 0.04: the error of <N>/<Y> is 0.2/(<Y> sqrt(n)), not
// the far larger one of N and Y alone. Ratio of estimate to truth over 30 series as above.
TEST(BlockAverage, RatioErrorKnowsThatBothVaryTogether) {
  constexpr std::size_t n = 4000, series = 30;
  const std::vector<BlockAverage::RatioTerm> term{{1.0, 0, 1}};
  const std::vector<BlockAverage::RatioTerm> twice{{2.0, 0, 1}};
  const double exact = 0.2 / (5.0 * std::sqrt(1.0 * n));
  double estimate = 0.0;
  for (std::uint64_t seed = 0; seed < series; ++seed) {
    const auto x = support::random_numbers(2 * n, seed);
    BlockAverage average(2);
    for (std::size_t k = 0; k < n; ++k) {
      const double y = 5.0 + 0.5 * x[2 * k];
      add(average, {3.0 * y + 0.2 * x[2 * k + 1], y});
    }
    EXPECT_NEAR(average.ratio(0, 1), 3.0, 5.0 * exact);
    EXPECT_NEAR(average.ratio_error(twice), 2.0 * average.ratio_error(term), 1e-15);
    estimate += average.ratio_error(term) / exact / series;
    const double jackknife = average.jackknife_error([](const auto& m) { return m[0] / m[1]; });
    EXPECT_NEAR(jackknife, average.ratio_error(term), 0.02 * jackknife)
        << "to first order the same";
  }
  EXPECT_GT(estimate, 0.9);
  EXPECT_LT(estimate, 1.3);
}

TEST(BlockAverage, JackknifeOfALinearFunctionIsTheStandardError) {
  BlockAverage average(2);
  const auto x = support::random_numbers(4000, 1);
  for (std::size_t k = 0; k < 2000; ++k) add(average, {1.0 + x[2 * k], x[2 * k + 1]});
  const double direct = average.standard_error(0);
  EXPECT_NEAR(average.jackknife_error([](const auto& m) { return m[0]; }), direct, 1e-12);
  EXPECT_NEAR(average.jackknife_error([](const auto& m) { return 7.0 - 3.0 * m[0]; }), 3.0 * direct,
              1e-12);
  // d(m^2) = 2 m dm, up to the square of dm.
  EXPECT_NEAR(average.jackknife_error([](const auto& m) { return m[0] * m[0]; }),
              2.0 * average.mean(0) * direct, 0.02 * direct);
}

}  // namespace
