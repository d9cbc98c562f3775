// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/trunk_wood.h"

#include "tests/recon/hand_made_clouds.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

/// Which points stay leaves of a cloud that is all called leaves, with paths from its lowest 10 cm.
std::vector<char> leaves_left(const PointCloud& cloud) {
  const PointGraph graph = neighbor_graph(cloud.points);
  std::vector<std::uint32_t> feet;
  for (std::uint32_t i = 0; i < cloud.size(); ++i)
    if (cloud.points[i].z() < 0.1) feet.push_back(i);
  const Paths paths = shortest_paths(cloud.points, graph, {}, std::vector<char>(cloud.size(), 1), feet);
  std::vector<char> leaf(cloud.size(), 1);
  keep_round_bole(cloud.points, paths, graph.typical_spacing_m, leaf);
  return leaf;
}

double share_kept(const std::vector<char>& leaf, std::size_t first, std::size_t last) {
  const auto begin = leaf.begin();
  return static_cast<double>(std::count(begin + static_cast<std::ptrdiff_t>(first),
                                        begin + static_cast<std::ptrdiff_t>(last), 0)) /
         static_cast<double>(last - first);
}

TEST(TrunkWood, all_of_a_bare_leaning_bole_is_wood) {
  PointCloud cloud;
  test::add_wood(cloud, {0, 0, 0}, {1.5, 0, 6}, 0.16, 0.08, 0.04, 0.004);
  EXPECT_GT(share_kept(leaves_left(cloud), 0, cloud.size()), 0.97);
}

TEST(TrunkWood, one_side_of_a_bole_is_enough) {
  PointCloud cloud;
  test::add_wood(cloud, {0, 0, 0}, {0, 0, 5}, 0.16, 0.1, 0.03, 0.004, 0, 0.45);
  EXPECT_GT(share_kept(leaves_left(cloud), 0, cloud.size()), 0.9);
}

TEST(TrunkWood, a_crown_above_stays_foliage) {
  PointCloud cloud;
  test::add_wood(cloud, {0, 0, 0}, {0, 0, 3}, 0.12, 0.09, 0.04, 0.004);
  const std::size_t wood = cloud.size();
  Random random(4);
  for (int i = 0; i < 8000; ++i)
    cloud.points.push_back(Vec3(0, 0, 4) + std::cbrt(random.uniform()) * random.direction());
  const std::vector<char> leaf = leaves_left(cloud);
  EXPECT_GT(share_kept(leaf, 0, wood), 0.9);
  EXPECT_LT(share_kept(leaf, wood, cloud.size()), 0.02);
}

TEST(TrunkWood, nothing_is_answered_with_nothing) {
  std::vector<char> leaf;
  keep_round_bole({}, {}, 0.01, leaf);
  EXPECT_TRUE(leaf.empty());
}

}  // namespace
}  // namespace dendrofit
