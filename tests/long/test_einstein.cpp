// Einstein's relation of rigid bodies, D = kT mu with kT = 1, for translation and rotation, within 3 %.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "support/einstein.h"

namespace odpd {
namespace {

TEST(LongEinstein, DiffusionIsMobility) {
  const auto sides = support::einstein_sides(300, 1.0, 1.0, 0.02, 4.0);
  for (const std::size_t k : {0, 1}) {
    const auto &d = sides.diffusion[k], &mu = sides.mobility[k];
    const double ratio = d.value / mu.value;
    const double error =
        ratio * std::hypot(d.standard_error / d.value, mu.standard_error / mu.value);
    std::printf("%s: D %.5f(%.5f), mu %.5f(%.5f), ratio %.4f(%.4f)\n",
                k == 0 ? "translation" : "rotation", d.value, d.standard_error, mu.value,
                mu.standard_error, ratio, error);
    EXPECT_LT(error, 0.01);
    EXPECT_NEAR(ratio, 1.0, 0.03) << "standard error " << error;
  }
}

}  // namespace
}  // namespace odpd
