// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/growth_statistics.h"

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

TEST(GrowthStatistics, StudentQuantilesAreThoseOfTables) {
  EXPECT_NEAR(student_t_two_sided(0.95, 1), 12.706204736174698, 1e-9);
  EXPECT_NEAR(student_t_two_sided(0.95, 2), 4.302652729696142, 1e-10);
  EXPECT_NEAR(student_t_two_sided(0.95, 11), 2.200985160082949, 1e-11);
  EXPECT_NEAR(student_t_two_sided(0.99, 30), 2.749995653567225, 1e-11);
  EXPECT_NEAR(student_t_two_sided(0.95, 1000), 1.962339080826408, 1e-11);
}

TEST(GrowthStatistics, NeighbouringValuesAlikeAreSeen) {
  EXPECT_GT(lag1_correlation({-3, -2, -1, 0, 1, 2, 3}), 0.5);
  EXPECT_LT(lag1_correlation({1, -1, 1, -1, 1, -1}), -0.5);
  EXPECT_EQ(lag1_correlation({}), 0);
  EXPECT_EQ(lag1_correlation({1, 1, 1, 1}), 0);
  EXPECT_LT(runs_z({1, 1, 1, 1, 1, -1, -1, -1, -1, -1}), -1.96);
  EXPECT_GT(runs_z({1, -1, 1, -1, 1, -1, 1, -1, 1, -1}), 1.96);
  EXPECT_EQ(runs_z({1, 1, 1}), 0);
}

TEST(GrowthStatistics, NormalDistribution) {
  EXPECT_NEAR(normal_cdf(1.959963984540054), 0.975, 1e-12);
  EXPECT_NEAR(normal_cdf(0), 0.5, 1e-15);
}

}  // namespace
}  // namespace dendrofit
