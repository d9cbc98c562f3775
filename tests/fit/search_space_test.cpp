// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/search_space.h"

#include "core/errors.h"
#include "tests/support/tiny_trees.h"

#include <cmath>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

TEST(SearchSpace, the_scale_keeps_internode_numbers_in_the_models_range) {
  for (double height = 0.4; height < 60; height *= 1.3) {
    const double internodes = height / scale_for(height);
    EXPECT_GE(internodes, 50);
    EXPECT_LE(internodes, 125);
  }
  EXPECT_DOUBLE_EQ(scale_for(8), 0.1);
}

TEST(SearchSpace, pipe_exponent_is_read_off_the_forks) {
  // twelve forks in a row, each into a thick and a thin child that obey r^2.2 = sum r_i^2.2
  Tree tree;
  double radius = 0.1;
  std::int32_t parent = -1;
  for (int i = 0; i < 13; ++i) {
    const double z = i;
    parent = tree.add({.start = {0, 0, z}, .end = {0, 0, z + 1}, .parent = parent, .radius = radius});
    if (i == 12) break;
    const double lateral = 0.4 * radius;
    tree.add({.start = {0, 0, z + 1},
              .end = {1, 0, z + 1},
              .parent = parent,
              .radius = lateral,
              .axis = i + 1,
              .order = 1});
    radius = std::pow(std::pow(radius, 2.2) - std::pow(lateral, 2.2), 1 / 2.2);
  }
  const DirectEstimates direct = estimate_directly(tree);
  EXPECT_EQ(direct.forks, 12);
  EXPECT_NEAR(direct.pipe_exponent, 2.2, 1e-6);
  for (auto& quality : tree.quality) quality = RadiusQuality::allometric;
  EXPECT_EQ(estimate_directly(tree).forks, 0);
  EXPECT_EQ(estimate_directly(tree).pipe_exponent, 2.6);
}

TEST(SearchSpace, every_corner_is_a_valid_parameter_set) {
  const DirectEstimates direct = estimate_directly(test::small_tree());
  for (const char* equation : {"logistic", "bertalanffy", "weibull"}) {
    for (const std::optional<int> cycles : {std::optional<int>{}, std::optional<int>{15}}) {
      const SearchSpace space(direct, equation, cycles);
      for (const double u : {0.0, 0.5, 1.0})
        EXPECT_NO_THROW(space.at(Eigen::VectorXd::Constant(space.size(), u)).validate());
      if (cycles) {
        EXPECT_EQ(space.at(Eigen::VectorXd::Constant(space.size(), 0.5)).cycles, 15);
      }
    }
  }
  EXPECT_THROW(SearchSpace(direct, "korf", {}), InputError);
}

}  // namespace
}  // namespace dendrofit
