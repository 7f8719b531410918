#pragma once
// Typed tests over two and three dimensions: TYPED_TEST_SUITE(Name, support::Dimensions).
#include <gtest/gtest.h>

namespace support {

template <int Value>
struct Dimension {
  static constexpr int D = Value;
};

using Dimensions = ::testing::Types<Dimension<2>, Dimension<3>>;

}  // namespace support
