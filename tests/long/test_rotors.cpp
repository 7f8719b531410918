// Rigid rotors beside frozen friction-only particles sample their exact distribution of angles within 3 %.
#include <gtest/gtest.h>

#include <cstdio>

#include "support/rotors.h"

namespace odpd {
namespace {

// At dt = 0.01 the tip moves too far for the change of friction within 0.05 of the cluster: 1.034(5) there.
TEST(LongRotors, SampleTheirAnglesWithinThreePercent) {
  const support::Fraction f = support::rotors_turned_away("trapezoidal", 100000, 0.005);
  std::printf("fraction turned away over the exact one: %.4f(%.4f)\n", f.value, f.standard_error);
  EXPECT_LT(f.standard_error, 0.01);
  EXPECT_NEAR(f.value, 1.0, 0.03);
}

}  // namespace
}  // namespace odpd
