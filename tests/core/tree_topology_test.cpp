// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/tree_topology.h"

#include "core/errors.h"
#include "tests/support/tiny_trees.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dendrofit {
namespace {

using ::testing::ElementsAre;

TEST(TreeTopology, children_come_in_rising_index) {
  const Tree tree = test::small_tree();
  const TreeChildren children(tree);
  EXPECT_THAT(std::vector<int>(children.of(1).begin(), children.of(1).end()), ElementsAre(2, 4));
  EXPECT_THAT(std::vector<int>(children.of(4).begin(), children.of(4).end()), ElementsAre(5, 6));
  EXPECT_TRUE(children.of(3).empty());
}

TEST(TreeTopology, axes_know_their_parents_and_lengths) {
  const auto axes = axes_of(test::small_tree());
  ASSERT_EQ(axes.size(), 3u);
  EXPECT_THAT(axes[1].nodes, ElementsAre(4, 5));
  EXPECT_EQ(axes[1].parent_axis, 0);
  EXPECT_EQ(axes[1].parent_node, 1);
  EXPECT_DOUBLE_EQ(axes[0].length, 4);
  EXPECT_EQ(axes[2].parent_axis, 1);
  EXPECT_EQ(axes[2].order, 2);
}

TEST(TreeTopology, the_thickest_child_continues_the_axis) {
  Tree tree = test::small_tree();
  tree.radius[6] = 0.03;  // now thicker than the branch's own continuation
  assign_axes_by_thickness(tree);
  tree.validate();
  EXPECT_EQ(tree.axis[6], tree.axis[4]);
  EXPECT_NE(tree.axis[5], tree.axis[4]);
  EXPECT_THAT(tree.order, ElementsAre(0, 0, 0, 0, 1, 2, 1));
}

TEST(TreeTopology, a_tie_in_thickness_goes_to_the_longer_branch) {
  Tree tree = test::small_tree();
  tree.radius[6] = tree.radius[5];
  assign_axes_by_thickness(tree);
  EXPECT_EQ(tree.axis[5], tree.axis[4]);
}

TEST(TreeTopology, length_beyond_sums_the_subtree) {
  const auto beyond = length_beyond(test::small_tree());
  EXPECT_DOUBLE_EQ(beyond[0], 6.5);
  EXPECT_DOUBLE_EQ(beyond[4], 2.5);
  EXPECT_DOUBLE_EQ(beyond[6], 0.5);
}

TEST(TreeTopology, subset_keeps_links_and_refuses_orphans) {
  const Tree tree = test::small_tree();
  const Tree part = subset(tree, {1, 1, 0, 0, 1, 0, 1});
  part.validate();
  EXPECT_THAT(part.parent, ElementsAre(-1, 0, 1, 2));
  EXPECT_THAT(part.order, ElementsAre(0, 0, 1, 2));
  EXPECT_THROW(subset(tree, {1, 0, 1, 1, 0, 0, 0}), InputError);
  EXPECT_THROW(subset(tree, {1}), InputError);
  EXPECT_TRUE(subset(Tree{}, {}).empty());
}

}  // namespace
}  // namespace dendrofit
