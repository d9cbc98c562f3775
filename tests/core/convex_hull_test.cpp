// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/convex_hull.h"

#include "core/random.h"

#include <numbers>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

std::vector<Vec3> cube_corners() {
  std::vector<Vec3> corners;
  for (int i = 0; i < 8; ++i) corners.emplace_back(i & 1, (i >> 1) & 1, 2 * (i >> 2));
  return corners;
}

TEST(ConvexHull, of_a_box_whatever_lies_inside) {
  auto points = cube_corners();
  Random random(1);
  for (int i = 0; i < 100; ++i) points.emplace_back(random.uniform(), random.uniform(), 2 * random.uniform());
  EXPECT_NEAR(plan_hull(points).area_m2, 1, 1e-12);
  EXPECT_NEAR(plan_hull(points).perimeter_m, 4, 1e-12);
  EXPECT_NEAR(hull_volume(points), 2, 1e-12);
}

TEST(ConvexHull, of_a_ball) {
  Random random(1);
  std::vector<Vec3> points;
  for (int i = 0; i < 5000; ++i) points.push_back(random.direction());
  EXPECT_NEAR(hull_volume(points), 4 * std::numbers::pi / 3, 0.02);
  EXPECT_NEAR(plan_hull(points).area_m2, std::numbers::pi, 0.02);
}

TEST(ConvexHull, degenerate_input_has_no_extent) {
  EXPECT_EQ(plan_hull({}).area_m2, 0);
  EXPECT_EQ(hull_volume({}), 0);
  EXPECT_EQ(hull_volume({Vec3(0, 0, 0)}), 0);
  const std::vector<Vec3> line = {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}, {4, 4, 4}};
  EXPECT_EQ(plan_hull(line).area_m2, 0);
  EXPECT_EQ(hull_volume(line), 0);
  const std::vector<Vec3> flat = {{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}, {0.5, 0.5, 1}};
  EXPECT_EQ(hull_volume(flat), 0);
}

}  // namespace
}  // namespace dendrofit
