// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/fit_search.h"

#include <cmath>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

TEST(FitSearch, parameters_far_from_the_posterior_count_against_them) {
  SearchBox box;
  box.centre = Eigen::Vector2d(0.5, 0.5);
  box.deviation = Eigen::Vector2d(0.1, HUGE_VAL);
  EXPECT_DOUBLE_EQ(box.improbability(box.centre), 0);
  EXPECT_NEAR(box.improbability(Eigen::Vector2d(0.7, 0.9)), 4, 1e-12);   // 2 sd; the second is not searched
  EXPECT_NEAR(box.improbability(Eigen::Vector2d(1.0, 0.5)), 21, 1e-12);  // 5 sd: linear beyond 3
  box.doubt = 4;  // the model is 2 sd off: so may the posterior be
  EXPECT_NEAR(box.improbability(Eigen::Vector2d(0.7, 0.9)), 1, 1e-12);
}

TEST(FitSearch, of_parameter_sets_equally_near_the_probable_one_costs_less) {
  SearchBox box;
  box.centre = Eigen::Vector2d(0.5, 0.5);
  box.deviation = Eigen::Vector2d(0.1, 0.2);
  const SeedNoise typical{Eigen::Matrix2d::Identity()};
  const NoiseMetric metric(typical, Eigen::MatrixXd(0, 2), Eigen::Vector2d(0, 0), Eigen::Vector2d(0, 0));
  EXPECT_DOUBLE_EQ(search_cost(0.8, box.centre, box, metric), 0.8);
  // each coordinate counts as one descriptor more: 1 sd of one, over two descriptors
  EXPECT_NEAR(search_cost(0.8, Eigen::Vector2d(0.6, 0.5), box, metric), 1.3, 1e-12);
}

}  // namespace
}  // namespace dendrofit
