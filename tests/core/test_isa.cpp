#include <gtest/gtest.h>

#include <cstdlib>

#include "odpd/core/isa.h"

namespace {

TEST(Isa, IsWhatTheEnvironmentAsksFor) {
  const char* const asked = std::getenv("ODPD_ISA");
  if (asked != nullptr && *asked != '\0') {
    EXPECT_EQ(odpd::isa_name(odpd::isa()), asked);
  } else {
    EXPECT_FALSE(odpd::isa_name(odpd::isa()).empty());
  }
}

TEST(Isa, PicksTheEntryOfItsPath) {
  const auto chosen = odpd::for_isa(odpd::Isa::portable, odpd::Isa::avx2, odpd::Isa::avx512);
  EXPECT_EQ(chosen, odpd::isa());
}

}  // namespace
