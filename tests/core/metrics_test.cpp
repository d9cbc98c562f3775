// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/metrics.h"

#include "core/errors.h"
#include "tests/support/tiny_trees.h"

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dendrofit {
namespace {

using ::testing::DoubleNear;
using ::testing::ElementsAre;
constexpr double kPi = std::numbers::pi;

TEST(Metrics, a_small_tree_measured_by_hand) {
  const TreeMetrics m = measure(test::small_tree());
  EXPECT_DOUBLE_EQ(m.height_m, 4);
  // 1.3 m lies 0.2 m below the middle of the second piece: 0.8 of its radius and 0.2 of the first's
  ASSERT_TRUE(m.dbh_m);
  EXPECT_NEAR(*m.dbh_m, 2 * (0.8 * 0.15 + 0.2 * 0.2), 1e-12);
  const double stem = kPi * (0.04 + 0.0225 + 0.01 + 0.0025);
  const double branch = kPi * (0.0016 + 0.0004);
  const double twig = kPi * 0.0001 * 0.5;
  EXPECT_NEAR(m.stem_volume_m3, stem, 1e-12);
  EXPECT_NEAR(m.branch_volume_m3, branch + twig, 1e-12);
  EXPECT_NEAR(m.total_volume_m3, stem + branch + twig, 1e-12);
  EXPECT_THAT(m.branch_count_by_order, ElementsAre(1, 1, 1));
  EXPECT_THAT(m.length_by_order_m,
              ElementsAre(DoubleNear(4, 1e-12), DoubleNear(2, 1e-12), DoubleNear(0.5, 1e-12)));
  ASSERT_TRUE(m.crown_base_m);
  EXPECT_DOUBLE_EQ(*m.crown_base_m, 2);
  EXPECT_NEAR(m.lean_deg, 0, 1e-9);
  EXPECT_NEAR(m.volume_by_diameter_class_m3[1], twig, 1e-12);
  EXPECT_NEAR(m.volume_by_diameter_class_m3[2], kPi * 0.0004, 1e-12);
}

TEST(Metrics, several_order_zero_axes_are_all_stem) {
  Tree tree = test::pole(2);
  tree.add({.start = {1, 0, 0}, .end = {1, 0, 3}, .parent = -1, .radius = 0.2, .axis = 1, .order = 0});
  const TreeMetrics m = measure(tree);
  EXPECT_NEAR(m.stem_volume_m3, kPi * (0.01 * 2 + 0.04 * 3), 1e-12);
  EXPECT_EQ(m.branch_volume_m3, 0);
  EXPECT_THAT(m.branch_count_by_order, ElementsAre(2));
  EXPECT_NEAR(*m.dbh_m, 0.4, 1e-12);
  EXPECT_DOUBLE_EQ(m.height_m, 3);
}

TEST(Metrics, no_dbh_below_breast_height_and_no_crown_without_branches) {
  const TreeMetrics m = measure(test::pole(1));
  EXPECT_FALSE(m.dbh_m);
  EXPECT_FALSE(m.crown_base_m);
  EXPECT_EQ(m.crown_area_m2, 0);
}

TEST(Metrics, breast_height_is_an_option) {
  EXPECT_NEAR(*measure(test::small_tree(), {.dbh_height_m = 1.5}).dbh_m, 0.3, 1e-12);
  EXPECT_THROW(measure(test::small_tree(), {.dbh_height_m = -1}), InputError);
  EXPECT_THROW(measure(Tree{}), InputError);
}

TEST(Metrics, heights_count_from_the_foot_not_from_zero) {
  Tree tree = test::small_tree();
  for (std::size_t i = 0; i < tree.size(); ++i) {
    tree.start[i].z() += 812.5;
    tree.end[i].z() += 812.5;
  }
  const TreeMetrics a = measure(test::small_tree());
  const TreeMetrics b = measure(tree);
  EXPECT_DOUBLE_EQ(a.height_m, b.height_m);
  EXPECT_NEAR(*a.dbh_m, *b.dbh_m, 1e-9);
  EXPECT_NEAR(*a.crown_base_m, *b.crown_base_m, 1e-9);
}

TEST(Metrics, crown_measures_of_a_square_crown) {
  Tree tree = test::pole(2);
  const double arms[4][2] = {{1, 1}, {-1, 1}, {-1, -1}, {1, -1}};
  for (int k = 0; k < 4; ++k)
    tree.add({.start = {0, 0, 1},
              .end = {arms[k][0], arms[k][1], 2},
              .parent = 0,
              .radius = 0.02,
              .axis = k + 1,
              .order = 1});
  const TreeMetrics m = measure(tree);
  EXPECT_NEAR(m.crown_area_m2, 4, 1e-9);
  EXPECT_NEAR(m.crown_diameter_m, 8 / kPi, 1e-9);
  // square of side 2 at z = 2 over the apex (0, 0, 1): a pyramid
  EXPECT_NEAR(m.crown_volume_m3, 4.0 / 3, 1e-9);
  EXPECT_NEAR(*m.crown_base_m, 1, 1e-9);
}

TEST(Metrics, a_leaning_stem) {
  const auto leaning = [](const Vec3& top) {
    Tree tree;
    tree.add({.start = {0, 0, 0}, .end = top, .parent = -1, .radius = 0.1});
    return measure(tree);
  };
  EXPECT_NEAR(leaning({1, 0, 1}).lean_deg, 45, 1e-9);
  EXPECT_NEAR(leaning({1, 0, 1}).lean_azimuth_deg, 90, 1e-9);  // east
  EXPECT_NEAR(leaning({0, -1, 2}).lean_azimuth_deg, 180, 1e-9);
  EXPECT_NEAR(leaning({-1, 0, 2}).lean_azimuth_deg, 270, 1e-9);
}

TEST(Metrics, branch_angles_are_those_at_the_base) {
  Tree tree = test::small_tree();
  EXPECT_THAT(measure(tree).branch_angle_by_order_deg,
              ElementsAre(DoubleNear(0, 1e-9), DoubleNear(90, 1e-9), DoubleNear(90, 1e-9)));
  tree.end[4] = tree.start[5] = {1.15, 0, 3};  // 45 degrees upwards; what comes later does not count
  EXPECT_NEAR(measure(tree).branch_angle_by_order_deg[1], 45, 1e-9);
}

TEST(Metrics, foliage_belongs_to_the_crown_and_not_to_the_wood) {
  const Tree tree = test::small_tree();
  const TreeMetrics bare = measure(tree), leafy = measure(tree, {}, {{-1, 2, 3}, {-1, -2, 3}, {9, 9, 0.5}});
  EXPECT_GT(leafy.crown_area_m2, 2);
  EXPECT_LT(leafy.crown_area_m2, 20);  // grass under the crown base is none of it
  EXPECT_GT(leafy.crown_volume_m3, bare.crown_volume_m3);
  EXPECT_EQ(leafy.total_volume_m3, bare.total_volume_m3);
  EXPECT_EQ(leafy.height_m, bare.height_m);
}

TEST(Metrics, the_leaf_profile_counts_every_leaf_point_once) {
  const std::vector<LeafLayer> layers = leaf_layers({{0, 0, 1.2}, {0, 0, 1.3}, {0, 0, 2.6}}, 0.1);
  ASSERT_EQ(layers.size(), 4u);
  EXPECT_EQ(layers.front().from_m, 1);
  EXPECT_EQ(layers.front().points, 2u);
  EXPECT_EQ(layers[1].points + layers[2].points, 0u);
  EXPECT_EQ(layers.back().to_m, 3);
  EXPECT_EQ(layers.back().points, 1u);
  EXPECT_TRUE(leaf_layers({}, 0).empty());
}

}  // namespace
}  // namespace dendrofit
