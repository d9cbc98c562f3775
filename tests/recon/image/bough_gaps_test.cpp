// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/image/bough_gaps.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

constexpr int kWidth = 120, kHeight = 40;

struct Marks {
  std::vector<std::uint8_t> at = std::vector<std::uint8_t>(kWidth * kHeight, 0);
  Marks& box(int left, int right, int top, int bottom) {
    for (int y = top; y < bottom; ++y)
      for (int x = left; x < right; ++x) at[static_cast<std::size_t>(y * kWidth + x)] = 1;
    return *this;
  }
  bool has(int x, int y) const { return at[static_cast<std::size_t>(y * kWidth + x)] != 0; }
};

TEST(BoughGaps, are_led_over_by_faint_pixels) {
  Marks tree, strong, faint;
  tree.box(0, 10, 0, kHeight);
  strong.box(18, 60, 20, 23).box(66, 110, 20, 23);  // one bough in two pieces: the second hangs on the first
  faint.box(8, 110, 20, 23);
  EXPECT_GT(bridge_gaps(strong.at, faint.at, kWidth, kHeight, 10, tree.at), 250u);
  for (int x = 0; x < 110; ++x) EXPECT_TRUE(tree.has(x, 21)) << x;
  EXPECT_FALSE(tree.has(30, 25));
}

TEST(BoughGaps, stay_open_where_nothing_leads_over_or_too_far) {
  Marks strong, faint, apart;
  strong.box(18, 60, 20, 23);
  faint.box(18, 60, 20, 23);  // nothing between 10 and 18
  apart.box(8, 60, 20, 23);
  for (const auto& [way, gap] : {std::pair{faint.at, 10}, std::pair{apart.at, 5}}) {
    Marks tree;
    tree.box(0, 10, 0, kHeight);
    const Marks before = tree;
    EXPECT_EQ(bridge_gaps(strong.at, way, kWidth, kHeight, gap, tree.at), 0u);
    EXPECT_EQ(tree.at, before.at);
  }
}

TEST(BoughGaps, are_none_of_blots) {
  Marks tree, strong, faint;
  tree.box(0, 10, 0, kHeight);
  strong.box(14, 40, 8, 34).box(90, 95, 20, 23);  // a patch; a speck
  faint.box(0, kWidth, 0, kHeight);
  EXPECT_EQ(bridge_gaps(strong.at, faint.at, kWidth, kHeight, 10, tree.at), 0u);
}

}  // namespace
}  // namespace dendrofit
