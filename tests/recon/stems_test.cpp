// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/stems.h"

#include "core/errors.h"
#include "recon/reconstruct.h"
#include "tests/recon/hand_made_clouds.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

void add_tree(PointCloud& cloud, double x, double height, double radius) {
  test::add_wood(cloud, {x, 0, 0}, {x, 0, height}, radius, 0.01, 0.01, 0.001);
  for (const double side : {-1.0, 1.0})
    test::add_wood(cloud, {x + side * 0.6 * radius, 0, 0.5 * height}, {x + side * 1.2, 0, 0.7 * height},
                   0.3 * radius, 0.006, 0.01, 0.001);
}

/// Number of roots.
long stems_of_model(const Tree& tree) {
  return std::count(tree.parent.begin(), tree.parent.end(), -1);
}

double nearest_to_line(const Tree& tree, double x) {
  double nearest = 1e300;
  for (std::size_t i = 0; i < tree.size(); ++i) {
    const Vec3 at = tree.origin_shift + tree.end[i];
    nearest = std::min(nearest, std::abs(at.x() - x) + std::abs(at.y()));
  }
  return nearest;
}

TEST(Stems, a_neighbours_wood_stays_its_own) {
  PointCloud cloud;
  add_tree(cloud, 0, 6, 0.07);
  const std::size_t own = cloud.size();
  add_tree(cloud, 2.2, 4.5, 0.05);  // boughs cross
  const Reconstruction result = reconstruct(cloud);
  EXPECT_EQ(result.other_trees.size(), 1u);
  EXPECT_EQ(result.stems, 1u);
  EXPECT_EQ(stems_of_model(result.tree), 1);
  EXPECT_NEAR(result.foot.x(), 0, 0.02);
  EXPECT_NEAR(result.metrics.height_m, 6, 0.06);
  EXPECT_GT(nearest_to_line(result.tree, 2.2), 0.3);
  EXPECT_NEAR(static_cast<double>(result.other_points), static_cast<double>(cloud.size() - own),
              0.1 * static_cast<double>(cloud.size() - own));
  ASSERT_FALSE(result.warnings.empty());
  EXPECT_NE(result.warnings.front().find("2 trees stand in this scan"), std::string::npos);
}

TEST(Stems, the_tree_asked_for_is_modelled) {
  PointCloud cloud;
  add_tree(cloud, 0, 6, 0.07);
  add_tree(cloud, 2.2, 4.5, 0.05);
  cloud.origin_shift = {500000, 5000000, 0};
  ReconstructOptions options;
  options.tree_at = Eigen::Vector2d(500002, 5000000.3);
  const Reconstruction result = reconstruct(cloud, options);
  EXPECT_NEAR(result.foot.x(), 500002.2, 0.02);
  EXPECT_NEAR(result.metrics.height_m, 4.5, 0.06);
  EXPECT_EQ(result.other_trees.size(), 1u);
  options.tree_at = Eigen::Vector2d(500020, 5000000);
  try {
    reconstruct(cloud, options);
    FAIL() << "a tree where none stands";
  } catch (const SolverError& error) {
    EXPECT_NE(std::string(error.what()).find("500002.2"), std::string::npos) << error.what();
  }
}

TEST(Stems, stems_of_one_stool_are_one_tree_and_each_begins_at_the_ground) {
  PointCloud cloud;
  test::add_wood(cloud, {0, 0, 0}, {-0.3, 0, 5}, 0.06, 0.01, 0.01, 0.001);
  test::add_wood(cloud, {0.35, 0, 0}, {0.8, 0, 4}, 0.04, 0.01, 0.01, 0.001);
  test::add_wood(cloud, {-0.2, 0, 3}, {0.6, 0, 3.4}, 0.015, 0.006, 0.01, 0.001);  // the crowns touch
  const Reconstruction result = reconstruct(cloud);
  EXPECT_EQ(result.other_trees.size(), 0u);
  EXPECT_EQ(result.stems, 2u);
  ASSERT_EQ(stems_of_model(result.tree), 2);
  std::vector<double> at;
  for (std::size_t i = 0; i < result.tree.size(); ++i)
    if (result.tree.parent[i] < 0) {
      const Vec3 start = result.tree.origin_shift + result.tree.start[i];
      at.push_back(start.x());
      EXPECT_NEAR(start.z(), 0, 0.03);
      EXPECT_EQ(result.tree.order[i], 0);
    }
  std::sort(at.begin(), at.end());
  EXPECT_NEAR(at[0], 0, 0.02);
  EXPECT_NEAR(at[1], 0.35, 0.02);
  ASSERT_TRUE(result.metrics.dbh_m);
  EXPECT_NEAR(*result.metrics.dbh_m, 2 * (0.06 - 0.05 * 1.3 / 5), 0.004);  // of the thicker
  const double cones = std::numbers::pi / 3 *
                       (5 * (0.06 * 0.06 + 0.06 * 0.01 + 1e-4) + 4 * (0.04 * 0.04 + 0.04 * 0.01 + 1e-4));
  EXPECT_NEAR(result.metrics.stem_volume_m3, cones, 0.06 * cones);
}

TEST(Stems, a_bough_that_hangs_to_the_ground_is_no_stem) {
  PointCloud cloud;
  test::add_wood(cloud, {0, 0, 0}, {0, 0, 6}, 0.07, 0.01, 0.01, 0.001);
  test::add_wood(cloud, {0.04, 0, 2.6}, {1, 0, 2.9}, 0.025, 0.02, 0.01, 0.001);
  test::add_wood(cloud, {1, 0, 2.9}, {1.5, 0, 1.8}, 0.02, 0.012, 0.01, 0.001);
  test::add_wood(cloud, {1.5, 0, 1.8}, {1.6, 0, 0.01}, 0.012, 0.008, 0.01, 0.001);
  const Reconstruction result = reconstruct(cloud);
  EXPECT_EQ(result.other_trees.size(), 0u);
  EXPECT_EQ(result.stems, 1u);
  EXPECT_EQ(stems_of_model(result.tree), 1);
  EXPECT_LT(nearest_to_line(result.tree, 1.6), 0.05);  // and the bough is followed to its end
}

TEST(Stems, a_post_beside_the_tree_is_neither_a_tree_nor_its_wood) {
  PointCloud cloud;
  add_tree(cloud, 0, 6, 0.07);
  test::add_wood(cloud, {1, 1, 0}, {1, 1, 0.9}, 0.05, 0.05, 0.01, 0.001);
  const Reconstruction result = reconstruct(cloud);
  EXPECT_EQ(result.other_trees.size(), 0u);
  EXPECT_EQ(result.stems, 1u);
  EXPECT_GT(result.other_points, 200u);
  EXPECT_NEAR(result.foot.x(), 0, 0.02);
  for (const Vec3& end : result.tree.end) EXPECT_LT((result.tree.origin_shift + end).y(), 0.5);
}

TEST(Stems, far_copies_of_one_tree_are_told_apart_in_any_order) {
  PointCloud cloud;
  for (const double x : {0.0, 3.0, 6.0}) add_tree(cloud, x, x == 3 ? 6 : 5, 0.06);
  const PointGraph graph = neighbor_graph(cloud.points);
  const Ground none;
  const auto height =
      heights_above_foot(cloud.points, connected_parts(graph, std::vector<char>(cloud.size(), 1)), none);
  std::vector<Foot> feet = find_feet(cloud.points, graph, height, none);
  ASSERT_EQ(feet.size(), 3u);
  for (int turn = 0; turn < 3; ++turn) {
    const std::vector<Stool> trees = tell_trees(cloud.points, graph, height, feet);
    ASSERT_EQ(trees.size(), 3u);
    EXPECT_EQ(trees.front().front().position.x(), feet.front().position.x());
    std::vector<char> open(cloud.size(), 1);
    const KeptTree largest = keep_tree(cloud.points, graph, {}, trees, {}, open, no_progress());
    EXPECT_NEAR(trees[largest.tree].front().position.x(), 3, 0.02);
    for (std::size_t i = 0; i < cloud.size(); ++i)
      if (open[i]) {
        EXPECT_NEAR(cloud.points[i].x(), 3, 1.5);
      }
    std::rotate(feet.begin(), feet.begin() + 1, feet.end());
  }
}

}  // namespace
}  // namespace dendrofit
