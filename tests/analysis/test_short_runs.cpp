// Standard errors of short, correlated series: honest, not several times too small.
#include <gtest/gtest.h>

#include <cmath>

#include "odpd/analysis/block_average.h"
#include "odpd/core/random.h"

namespace odpd {
namespace {

// 30 samples of a first-order autoregression with coefficient 0.9, over 400 seeds: the scatter of the mean (standard
// error of that estimate about 4 %) against the error claimed. Without the correction the claim is 0.25 of it.
TEST(ShortRuns, ErrorOfAFewCorrelatedSamples) {
  constexpr int seeds = 400, samples = 30;
  constexpr double phi = 0.9;
  double scatter = 0.0, claimed = 0.0;
  for (int seed = 0; seed < seeds; ++seed) {
    const CounterRandom random(static_cast<std::uint64_t>(seed), Stream::probe);
    double x = random.normal(0, 0, 0, 0);
    BlockAverage average;
    for (std::uint64_t k = 1; k <= samples; ++k) {
      x = phi * x + std::sqrt(1.0 - phi * phi) * random.normal(k, 0, 0, 0);
      average.add(std::span<const double>(&x, 1));
    }
    scatter += average.mean(0) * average.mean(0) / seeds;
    claimed += average.standard_error(0) / seeds;
  }
  EXPECT_GT(claimed / std::sqrt(scatter), 0.45);
  EXPECT_LT(claimed / std::sqrt(scatter), 1.5);
}

// Independent samples pay little for it: the largest of three levels is about 10 % above the true error.
TEST(ShortRuns, IndependentSamplesKeepTheirError) {
  double claimed = 0.0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const CounterRandom random(seed, Stream::probe);
    BlockAverage average;
    for (std::uint64_t k = 0; k < 1024; ++k) {
      const double x = random.normal(k, 0, 0, 0);
      average.add(std::span<const double>(&x, 1));
    }
    claimed += average.standard_error(0) / 200.0;
  }
  EXPECT_NEAR(claimed * 32.0, 1.1, 0.15);
}

}  // namespace
}  // namespace odpd
