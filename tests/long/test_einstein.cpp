// Einstein's relation of rigid bodies, D = kT mu with kT = 1, for translation and rotation, within 3 %.
#include <gtest/gtest.h>

#include <cstdio>

#include "support/einstein.h"

namespace odpd {
namespace {

TEST(LongEinstein, DiffusionIsMobility) {
  const auto sides = support::einstein_sides(200, 1.0, 1.0, 0.02, 4.0);
  for (const std::size_t k : {0, 1}) {
    const auto &d = sides.diffusion[k], &mu = sides.mobility[k], &ratio = sides.ratio[k];
    std::printf("%s: D %.5f(%.5f), mu %.5f(%.5f), ratio %.4f(%.4f)\n",
                k == 0 ? "translation" : "rotation", d.value, d.standard_error, mu.value,
                mu.standard_error, ratio.value, ratio.standard_error);
    EXPECT_LT(ratio.standard_error, 0.01);
    EXPECT_NEAR(ratio.value, 1.0, 0.03) << "standard error " << ratio.standard_error;
  }
}

}  // namespace
}  // namespace odpd
