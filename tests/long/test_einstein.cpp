// Einstein's relation of rigid bodies, D = kT mu with kT = 1, for translation and rotation. Within 3 %, which is not
// reached at present: this test fails. docs/accuracy.md has the runs.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "support/einstein.h"

namespace odpd {
namespace {

TEST(LongEinstein, DiffusionIsMobility) {
  const auto d = support::diffusion(0.01, 1.0, 300.0);
  const auto mu = support::mobility(2.0, 1.0, 0.01, 500.0);
  for (const std::size_t k : {0, 1}) {
    const double ratio = d[k].value / mu[k].value;
    const double error =
        ratio * std::hypot(d[k].standard_error / d[k].value, mu[k].standard_error / mu[k].value);
    std::printf("%s: D %.5f(%.5f), mu %.5f(%.5f), ratio %.4f(%.4f)\n",
                k == 0 ? "translation" : "rotation", d[k].value, d[k].standard_error, mu[k].value,
                mu[k].standard_error, ratio, error);
    EXPECT_LT(error, 0.018);
    EXPECT_NEAR(ratio, 1.0, 0.03) << "standard error " << error;
  }
}

}  // namespace
}  // namespace odpd
