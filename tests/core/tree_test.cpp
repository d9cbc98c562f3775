// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/tree.h"

#include "core/errors.h"
#include "tests/support/tiny_trees.h"

#include <limits>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dendrofit {
namespace {

using ::testing::HasSubstr;

std::string complaint(const Tree& tree) {
  try {
    tree.validate();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Tree, hand_made_trees_are_valid) {
  EXPECT_EQ(complaint(Tree{}), "");
  EXPECT_EQ(complaint(test::pole(3)), "");
  EXPECT_EQ(complaint(test::small_tree()), "");
}

TEST(Tree, geometry_of_a_node) {
  const Tree tree = test::small_tree();
  EXPECT_EQ(tree.axis_count(), 3);
  EXPECT_DOUBLE_EQ(tree.length(6), 0.5);
  EXPECT_EQ(tree.direction(4), Vec3::UnitX());
  EXPECT_DOUBLE_EQ(tree.volume(0), std::numbers::pi * 0.04);
}

TEST(Tree, validate_names_node_and_fault) {
  Tree tree = test::small_tree();
  tree.radius[3] = -1;
  EXPECT_THAT(complaint(tree), HasSubstr("node 4: radius -1"));
  tree = test::small_tree();
  tree.parent[2] = 2;
  EXPECT_THAT(complaint(tree), HasSubstr("node 3: parent"));
  tree = test::small_tree();
  tree.end[5].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(complaint(tree), HasSubstr("node 6: a coordinate"));
  tree = test::small_tree();
  tree.end[0] = tree.start[0];
  EXPECT_THAT(complaint(tree), HasSubstr("node 1: length 0"));
  tree = test::small_tree();
  tree.order[4] = tree.order[5] = 0;
  EXPECT_THAT(complaint(tree), HasSubstr("node 5: order 0"));
  tree = test::small_tree();
  tree.order[5] = 3;
  EXPECT_THAT(complaint(tree), HasSubstr("order changes along its axis"));
  tree = test::small_tree();
  tree.axis[6] = 1;
  EXPECT_THAT(complaint(tree), HasSubstr("unbranched run"));
  tree = test::small_tree();
  tree.order[0] = 1;
  EXPECT_THAT(complaint(tree), HasSubstr("a root has order 0"));
  tree = test::small_tree();
  tree.radius_se.pop_back();
  EXPECT_THAT(complaint(tree), HasSubstr("differ in length"));
}

TEST(Tree, quality_words_go_both_ways) {
  for (const auto q : {RadiusQuality::measured, RadiusQuality::interpolated, RadiusQuality::allometric,
                       RadiusQuality::extrapolated})
    EXPECT_EQ(radius_quality_from(to_string(q)), q);
  EXPECT_THROW(radius_quality_from("guessed"), InputError);
}

}  // namespace
}  // namespace dendrofit
