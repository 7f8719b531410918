// Rigid rotors beside frozen friction-only particles sample their exact distribution of angles within 3 %.
#include <gtest/gtest.h>

#include "support/rotors.h"

namespace odpd {
namespace {

TEST(LongRotors, SampleTheirAnglesWithinThreePercent) {
  const support::Fraction f = support::rotors_turned_away("trapezoidal", 70000, 0.005);
  RecordProperty("fraction", std::to_string(f.value));
  EXPECT_LT(f.standard_error, 0.008);
  EXPECT_NEAR(f.value, 1.0, 0.03) << "standard error " << f.standard_error;
}

}  // namespace
}  // namespace odpd
