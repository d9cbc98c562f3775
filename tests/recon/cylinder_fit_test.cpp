// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/cylinder_fit.h"

#include "core/random.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

std::vector<Eigen::Vector2d> arc(double radius, double turns, int n, double noise) {
  Random random(3);
  std::vector<Eigen::Vector2d> points;
  for (int i = 0; i < n; ++i) {
    const double a = 2 * std::numbers::pi * turns * i / n;
    const double r = radius + noise * random.normal();
    points.emplace_back(0.3 + r * std::cos(a), -0.2 + r * std::sin(a));
  }
  return points;
}

TEST(CircleFit, finds_a_clean_circle_exactly) {
  const CircleFit fit = algebraic_circle(arc(0.17, 1, 40, 0));
  ASSERT_TRUE(fit.ok);
  EXPECT_NEAR(fit.radius, 0.17, 1e-9);
  EXPECT_NEAR(fit.centre.x(), 0.3, 1e-9);
  EXPECT_NEAR(fit.centre.y(), -0.2, 1e-9);
  EXPECT_DOUBLE_EQ(fit.coverage, 1);
}

TEST(CircleFit, half_seen_stem_keeps_its_radius) {
  const auto points = arc(0.17, 0.5, 200, 0.003);
  const CircleFit fit = robust_circle(points, algebraic_circle(points), 0.003);
  ASSERT_TRUE(fit.ok);
  EXPECT_NEAR(fit.radius, 0.17, 3 * fit.radius_se);
  EXPECT_NEAR(fit.coverage, 0.5, 0.1);
  EXPECT_LT(fit.radius_se, 0.002);
}

TEST(CircleFit, a_branch_beside_the_stem_does_not_move_it) {
  auto points = arc(0.1, 1, 200, 0.002);
  for (int i = 0; i < 60; ++i) points.emplace_back(0.3 + 0.12 + 0.001 * i, -0.2);
  const CircleFit plain = algebraic_circle(points);
  const CircleFit robust = robust_circle(points, plain, 0.002);
  ASSERT_TRUE(robust.ok);
  EXPECT_GT(std::abs(plain.radius - 0.1), 0.003);
  EXPECT_NEAR(robust.radius, 0.1, 0.001);
}

TEST(CircleFit, too_few_points_or_a_line_give_no_circle) {
  EXPECT_FALSE(algebraic_circle({}).ok);
  EXPECT_FALSE(algebraic_circle(arc(0.1, 1, 3, 0)).ok);
  std::vector<Eigen::Vector2d> line;
  for (int i = 0; i < 20; ++i) line.emplace_back(0.01 * i, 0);
  const CircleFit fit = algebraic_circle(line);
  EXPECT_TRUE(!fit.ok || fit.radius > 1);
}

}  // namespace
}  // namespace dendrofit
