// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/report/overlay.h"

#include "cli/report/colours.h"

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

TEST(Overlay, an_outline_marks_the_trees_outermost_pixels_and_no_others) {
  Photograph photo;
  photo.width = 40;
  photo.height = 20;
  photo.rgb.assign(3 * 40 * 20, 100);
  Silhouette half;  // of half the photograph's size
  half.width = 20;
  half.height = 10;
  half.tree.assign(200, 0);
  for (int y = 3; y < 10; ++y)
    for (int x = 5; x < 12; ++x) half.tree[half.pixel(x, y)] = 1;

  const Image image = draw_outline(photo, half);
  ASSERT_EQ(image.width, 40);
  ASSERT_EQ(image.height, 20);
  const Rgb pale = image.at(0, 0);
  EXPECT_NE(pale, order_colour(0));
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 40; ++x) {
      const bool inside = x >= 10 && x < 24 && y >= 6;
      const bool edge = inside && (x == 10 || x == 23 || y == 6 || y == 19);  // the picture's last row is one
      EXPECT_EQ(image.at(x, y), edge ? order_colour(0) : pale) << x << ' ' << y;
    }
  EXPECT_EQ(draw_outline(photo, half, 20).width, 20);
}

}  // namespace
}  // namespace dendrofit
