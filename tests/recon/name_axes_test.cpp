// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/name_axes.h"

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

/// A stem of two cylinders that forks into two branches of five cylinders each, the first straight on, the
/// second at a right angle.
Tree fork() {
  Tree tree;
  const auto add = [&](std::int32_t parent, const Vec3& start, const Vec3& end) {
    TreeNode node;
    node.parent = parent;
    node.start = start;
    node.end = end;
    node.radius = 0.03;
    return tree.add(node);
  };
  const std::int32_t base = add(add(-1, {0, 0, 0}, {0, 0, 0.1}), {0, 0, 0.1}, {0, 0, 0.2});
  for (const Vec3& way : {Vec3(0, 0, 0.1), Vec3(0.1, 0, 0)}) {
    std::int32_t at = base;
    for (int k = 0; k < 5; ++k)
      at = add(at, tree.end[static_cast<std::size_t>(at)], tree.end[static_cast<std::size_t>(at)] + way);
  }
  return tree;
}

TEST(NameAxes, the_thicker_branch_goes_on_even_at_a_right_angle) {
  Tree tree = fork();
  std::vector<double> seen(tree.size(), 0.02);
  for (std::size_t i = 7; i < 12; ++i) seen[i] = 0.03;
  name_axes(tree, seen);
  tree.validate();
  EXPECT_EQ(tree.order[11], 0);
  EXPECT_EQ(tree.order[6], 1);
  EXPECT_EQ(tree.axis_count(), 2);
}

TEST(NameAxes, one_wrong_radius_in_the_crotch_does_not_decide) {
  Tree tree = fork();
  std::vector<double> seen(tree.size(), 0.025);
  for (std::size_t i = 7; i < 12; ++i) seen[i] = 0.02;
  seen[7] = 0.09;
  name_axes(tree, seen);
  EXPECT_EQ(tree.order[6], 0);
  EXPECT_EQ(tree.order[11], 1);
}

TEST(NameAxes, a_long_thick_piece_outweighs_a_short_thin_one) {
  Tree tree = fork();
  tree.end[2] = {0, 0, 0.4};  // the straight branch: 20 cm, then 10 cm that one bad view made thin
  for (std::size_t i = 3; i < 7; ++i) {
    tree.start[i] = tree.end[i - 1];
    tree.end[i] = tree.start[i] + Vec3(0, 0, 0.1);
  }
  std::vector<double> seen(tree.size(), 0.025);
  seen[2] = 0.04;
  seen[3] = 0.012;
  name_axes(tree, seen);
  EXPECT_EQ(tree.order[6], 0);
  EXPECT_EQ(tree.order[11], 1);
}

TEST(NameAxes, of_equals_the_straighter_goes_on) {
  Tree tree = fork();
  name_axes(tree, std::vector<double>(tree.size(), 0.02));
  EXPECT_EQ(tree.order[6], 0);
  EXPECT_EQ(tree.order[11], 1);
}

}  // namespace
}  // namespace dendrofit
