// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/sectors.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

TEST(Sectors, every_direction_falls_where_its_angle_says) {
  for (int i = 0; i < 24 * 200; ++i) {
    const double angle = 2 * std::numbers::pi * (i + 0.5) / (24 * 200) - std::numbers::pi;
    // Two directions lie in one sector or in two, as their exact angles do.
    const double turn = (angle + std::numbers::pi) / (2 * std::numbers::pi);
    const int sector = static_cast<int>(24 * turn);
    const double middle = 2 * std::numbers::pi * (sector + 0.5) / 24 - std::numbers::pi;
    Sectors both;
    both.add({0.02 * std::cos(angle), 0.02 * std::sin(angle)});
    EXPECT_EQ(both.count(), 1);
    both.add({3 * std::cos(middle), 3 * std::sin(middle)});
    EXPECT_EQ(both.count(), 1) << angle;
    both.add({std::cos(middle + std::numbers::pi / 12), std::sin(middle + std::numbers::pi / 12)});
    EXPECT_EQ(both.count(), 2) << angle;
  }
}

TEST(Sectors, count_up_to_all_around) {
  Sectors seen;
  EXPECT_EQ(seen.count(), 0);
  for (int i = 0; i < 24; ++i) {
    const double angle = 2 * std::numbers::pi * (i + 0.5) / 24;
    seen.add({std::cos(angle), std::sin(angle)});
    EXPECT_EQ(seen.count(), i + 1);
  }
  EXPECT_EQ(seen.share(), 1);
  Sectors middle;
  middle.add({0, 0});
  EXPECT_EQ(middle.count(), 1);
}

}  // namespace
}  // namespace dendrofit
