#include <gtest/gtest.h>

#include "odpd/pairs/column.h"
#include "odpd/pairs/dpd.h"
#include "support/network.h"

namespace {

using odpd::Column;

TEST(Column, IsOneNumberUntilItVaries) {
  Column c;
  c.resize(1000);
  EXPECT_EQ(c[999], 0.0);
  c.fill(0.25);
  EXPECT_FALSE(c.varies());
  EXPECT_EQ(c.size(), 1000u);
  EXPECT_EQ(c[0], 0.25);
  EXPECT_EQ(c[999], 0.25);
  EXPECT_EQ(c.sum(), 250.0);
  EXPECT_EQ(c.bytes(), 8);
  c.resize(2000);
  EXPECT_EQ(c[1999], 0.25) << "later ones too";
}

TEST(Column, VariesFromWhatItWas) {
  Column c;
  c.resize(10);
  c.fill(2.0);
  c.each()[3] = 5.0;
  EXPECT_TRUE(c.varies());
  EXPECT_EQ(c[2], 2.0);
  EXPECT_EQ(c[3], 5.0);
  EXPECT_EQ(c.sum(), 23.0);
  c.resize(12);
  EXPECT_EQ(c[3], 5.0);
  c.each()[11] = 1.0;
  EXPECT_EQ(c[11], 1.0);
  EXPECT_EQ(c.bytes(), 96);
  c.fill(1.0);
  EXPECT_EQ(c[3], 1.0);
  EXPECT_EQ(c.bytes(), 8) << "gives the room back";
}

// i, j, e, r, u, f_c, zeta_par of an edge, twice its number in the index: what a million particles can afford.
TEST(Column, OfOneNumberTakesNoRoomInANetwork) {
  support::Fluid<3> fluid(8.0, true, 2000, 1);
  odpd::DpdParameters p;
  fluid.connect(odpd::DpdModel<3>(1, {p}), 0.0);
  const auto edges = static_cast<double>(fluid.network.size());
  const auto bytes_per_edge = [&] {
    // Without what there is per particle.
    return (static_cast<double>(fluid.network.bytes()) - 2000.0 * 20.0) / edges;
  };
  EXPECT_NEAR(bytes_per_edge(), 8 + 24 + 4 * 8 + 2 * 4, 0.5);
  p.gamma_perp = 1.0;
  p.s_bar = 2.0;
  fluid.connect(odpd::DpdModel<3>(1, {p}), 0.0);
  EXPECT_NEAR(bytes_per_edge(), 8 + 24 + 6 * 8 + 2 * 4, 0.5) << "zeta_perp and k_c besides";
}

}  // namespace
