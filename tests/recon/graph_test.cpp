// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/graph.h"

#include "tests/recon/hand_made_clouds.h"

#include <cmath>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

/// A row of points 1 cm apart with a gap of 16 cm after the fifteenth, and one stray far off.
std::vector<Vec3> broken_row() {
  std::vector<Vec3> points;
  for (int i = 0; i < 30; ++i) points.push_back({0, 0, 0.01 * i + (i >= 15 ? 0.15 : 0)});
  points.push_back({3, 3, 3});
  return points;
}

TEST(Graph, gaps_part_it_and_bridges_join_it_again) {
  const auto points = broken_row();
  const PointGraph graph = neighbor_graph(points);
  const std::vector<char> open(points.size(), 1);
  const Parts parts = connected_parts(graph, open);
  EXPECT_EQ(parts.points.size(), 3u);

  const Paths before = shortest_paths(points, graph, {}, open, {0});
  EXPECT_EQ(before.order.size(), 15u);
  const auto bridges = bridge_gaps(points, graph, parts);
  ASSERT_FALSE(bridges.empty());
  EXPECT_NEAR(bridges.front().gap_m, 0.16, 1e-6);
  EXPECT_GT(bridges.front().cost_m, bridges.front().gap_m);
  const Paths after = shortest_paths(points, graph, bridges, open, {0});
  EXPECT_EQ(after.order.size(), 30u);  // the stray stays out
  EXPECT_NEAR(after.length[29], 0.44, 1e-4);
  EXPECT_EQ(after.parent[30], Paths::kNone);
}

TEST(Graph, a_stem_crosses_a_gap_although_a_thin_branch_beside_it_sees_across_first) {
  // A slab of the scan is missing; the stem's points have hundreds of its own before the first beyond the
  // gap.
  PointCloud cloud;
  test::add_wood(cloud, {0, 0, 0}, {0, 0, 1.8}, 0.15, 0.14, 0.02);
  test::add_wood(cloud, {0.14, 0, 1.5}, {1.4, 0, 1.75}, 0.02, 0.01, 0.02);
  test::add_wood(cloud, {0, 0, 2.3}, {0, 0, 4}, 0.12, 0.08, 0.02);
  test::add_wood(cloud, {0.1, 0, 2.8}, {1.4, 0, 2.25}, 0.02, 0.01, 0.02);
  const PointGraph graph = neighbor_graph(cloud.points);
  const Parts parts = connected_parts(graph, std::vector<char>(cloud.size(), 1));
  ASSERT_EQ(parts.points.size(), 2u);
  bool on_the_stem = false;
  for (const Bridge& b : bridge_gaps(cloud.points, graph, parts))
    on_the_stem |= cloud.points[b.a].head<2>().norm() < 0.16 && cloud.points[b.b].head<2>().norm() < 0.16;
  EXPECT_TRUE(on_the_stem);
}

TEST(Graph, no_bridge_is_wider_than_allowed) {
  const auto points = broken_row();
  const PointGraph graph = neighbor_graph(points);
  const Parts parts = connected_parts(graph, std::vector<char>(points.size(), 1));
  EXPECT_TRUE(bridge_gaps(points, graph, parts, {.max_gap_m = 0.10}).empty());
}

TEST(Graph, paths_do_not_pass_closed_points) {
  const auto points = broken_row();
  const PointGraph graph = neighbor_graph(points, {.neighbors = 4});
  std::vector<char> open(points.size(), 1);
  for (int i = 3; i < 7; ++i) open[static_cast<std::size_t>(i)] = 0;
  EXPECT_EQ(shortest_paths(points, graph, {}, open, {0}).order.size(), 3u);
}

TEST(Graph, a_gate_is_entered_by_its_door_although_another_way_is_shorter) {
  // A square of two ways from the first point to the last.
  std::vector<Vec3> points;
  for (int i = 0; i <= 20; ++i) points.push_back({0.01 * i, 0, 0});
  const auto straight = static_cast<std::uint32_t>(points.size()) - 1;
  for (int i = 1; i <= 25; ++i) points.push_back({0.008 * i, 0.1 * std::sin(0.04 * M_PI * i) + 0.008, 0});
  const auto detour = static_cast<std::uint32_t>(points.size()) - 1;
  points.push_back({0.21, 0.004, 0});
  const auto last = static_cast<std::uint32_t>(points.size()) - 1;
  const PointGraph graph = neighbor_graph(points);
  const std::vector<char> open(points.size(), 1);
  EXPECT_EQ(shortest_paths(points, graph, {}, open, {0}).parent[last], straight);
  const Gate gate{.inside = {last}, .door = {detour}};
  EXPECT_EQ(shortest_paths(points, graph, {}, open, {0}, no_progress(), {gate}).parent[last], detour);
}

TEST(Graph, empty_and_single_clouds_are_answered) {
  EXPECT_EQ(neighbor_graph({}).size(), 0u);
  EXPECT_EQ(neighbor_graph({Vec3(1, 2, 3)}).size(), 1u);
}

}  // namespace
}  // namespace dendrofit
