// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/ellipse_fit.h"

#include "core/random.h"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

std::vector<Eigen::Vector2d> ellipse(double a, double b, double turn, double noise, double share = 1) {
  Random random(3);
  std::vector<Eigen::Vector2d> points;
  for (int i = 0; i < 200; ++i) {
    const double t = share * 2 * std::numbers::pi * i / 200;
    const Eigen::Vector2d p(a * std::cos(t), b * std::sin(t));
    points.emplace_back(3 + std::cos(turn) * p.x() - std::sin(turn) * p.y() + noise * random.normal(),
                        -7 + std::sin(turn) * p.x() + std::cos(turn) * p.y() + noise * random.normal());
  }
  return points;
}

TEST(EllipseFit, finds_a_turned_ellipse_exactly_also_from_three_quarters_of_it) {
  for (const double share : {1.0, 0.75}) {
    const auto fit = fit_ellipse(ellipse(0.22, 0.17, 0.7, 0, share));
    ASSERT_TRUE(fit);
    EXPECT_NEAR(fit->longest, 0.44, 1e-9);
    EXPECT_NEAR(fit->shortest, 0.34, 1e-9);
  }
}

TEST(EllipseFit, noise_of_three_millimetres_costs_less_than_it) {
  const auto fit = fit_ellipse(ellipse(0.22, 0.17, 0.7, 0.003));
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->longest, 0.44, 0.003);
  EXPECT_NEAR(fit->shortest, 0.34, 0.003);
}

TEST(EllipseFit, few_points_and_a_line_have_none) {
  EXPECT_FALSE(fit_ellipse({}));
  EXPECT_FALSE(fit_ellipse(std::vector<Eigen::Vector2d>(20, Eigen::Vector2d(1, 2))));
  std::vector<Eigen::Vector2d> line;
  for (int i = 0; i < 20; ++i) line.emplace_back(i, 2 * i);
  EXPECT_FALSE(fit_ellipse(line));
}

}  // namespace
}  // namespace dendrofit
