// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/direct_estimates.h"

#include "core/errors.h"
#include "forward/igm/grow.h"
#include "tests/support/tiny_trees.h"

#include <cmath>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

TEST(DirectEstimates, the_scale_keeps_internode_numbers_in_the_models_range) {
  for (double height = 0.4; height < 60; height *= 1.3) {
    const double internodes = height / scale_for(height);
    EXPECT_GE(internodes, 55);
    EXPECT_LE(internodes, 93);
  }
  EXPECT_DOUBLE_EQ(scale_for(7.6), 0.1);
}

TEST(DirectEstimates, pipe_exponent_is_read_off_the_forks) {
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

TEST(DirectEstimates, branch_angle_and_tropism_follow_the_parameters_that_grew_the_tree) {
  IgmParameters p = igm_preset("table2-06").parameters;
  p.cycles = 12;
  p.mu = 0.5;
  const auto estimate = [&](double angle, double gamma) {
    p.branch_angle_deg = angle;
    p.gamma = p.gamma_late = gamma;
    return estimate_directly(grow_igm(p, {}, {.seed = 3}).tree);
  };
  const DirectEstimates steep = estimate(30, -1.5), flat = estimate(75, 1.5);
  EXPECT_NEAR(*steep.branch_angle_deg, 30, 15);
  EXPECT_NEAR(*flat.branch_angle_deg, 75, 15);
  EXPECT_GT(*steep.bend_deg, *flat.bend_deg);
}

TEST(DirectEstimates, a_bare_pole_tells_little) {
  const DirectEstimates direct = estimate_directly(test::pole(3, 0.05));
  EXPECT_FALSE(direct.branch_angle_deg);
  EXPECT_NEAR(direct.size_internodes, 60, 1e-9);
  EXPECT_THROW(estimate_directly(test::pole(3), -1.0), InputError);
  EXPECT_THROW(estimate_directly(Tree{}), InputError);
}

}  // namespace
}  // namespace dendrofit
