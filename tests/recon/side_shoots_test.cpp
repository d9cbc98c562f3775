// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/side_shoots.h"

#include "core/errors.h"
#include "tests/recon/hand_made_clouds.h"

#include <numeric>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

/// A straight limb along x with a node every 2 cm that owns the points.
Limb limb_along_x(const std::vector<Vec3>& points, std::uint32_t first, std::uint32_t last, double y,
                  double radius) {
  Limb limb;
  for (int i = 0; i <= 15; ++i) {
    LimbNode node;
    node.centre = {0.02 * i, y, 0};
    node.rough_radius_m = radius;
    limb.nodes.push_back(node);
  }
  for (std::uint32_t p = first; p < last; ++p)
    limb.nodes[static_cast<std::size_t>(std::clamp(points[p].x() / 0.02, 0.0, 15.0))].points.push_back(p);
  return limb;
}

Paths paths_along_x(const std::vector<Vec3>& points) {
  Paths paths;
  for (const Vec3& p : points) paths.length.push_back(static_cast<float>(p.x() + p.y() + 1));
  return paths;
}

std::size_t points_of(const Limb& limb) {
  return std::accumulate(limb.nodes.begin(), limb.nodes.end(), std::size_t{0},
                         [](std::size_t n, const LimbNode& node) { return n + node.points.size(); });
}

TEST(SideShoots, a_shoot_of_four_centimetres_becomes_a_limb_that_takes_its_points) {
  PointCloud cloud;
  test::add_wood(cloud, {0, 0, 0}, {0.3, 0, 0}, 0.01, 0.01, 0.006, 0.0005);
  const auto bark = static_cast<std::uint32_t>(cloud.size());
  test::add_wood(cloud, {0.15, 0.016, 0}, {0.16, 0.05, 0}, 0.003, 0.002, 0.006, 0.0005);
  const PointGraph graph = neighbor_graph(cloud.points);
  std::vector<Limb> limbs = {limb_along_x(cloud.points, 0, bark, 0, 0.01)};
  for (std::uint32_t p = bark; p < cloud.size(); ++p) limbs[0].nodes[7].points.push_back(p);
  measure_lengths(limbs);
  grow_side_shoots(cloud.points, graph, paths_along_x(cloud.points), limbs, 0.0005);
  ASSERT_EQ(limbs.size(), 2u);
  EXPECT_EQ(limbs[1].parent, 0);
  EXPECT_NEAR(limbs[0].nodes[static_cast<std::size_t>(limbs[1].parent_node)].centre.x(), 0.15, 0.021);
  EXPECT_NEAR(limbs[1].nodes.back().centre.y(), 0.05, 0.006);
  EXPECT_LT(limbs[1].nodes.back().rough_radius_m, 0.005);
  EXPECT_GE(points_of(limbs[1]), 0.9 * static_cast<double>(cloud.size() - bark));
  EXPECT_EQ(points_of(limbs[0]) + points_of(limbs[1]), cloud.size());
}

TEST(SideShoots, bark_and_lone_points_are_none) {
  PointCloud cloud;
  test::add_wood(cloud, {0, 0, 0}, {0.3, 0, 0}, 0.01, 0.01, 0.006, 0.001);
  for (const double x : {0.05, 0.15, 0.25}) cloud.points.emplace_back(x, 0.035, 0);  // far, but alone
  for (const double x : {0.10, 0.104, 0.108, 0.112, 0.116, 0.12})
    cloud.points.emplace_back(x, 0.017, 0);  // a knob
  const PointGraph graph = neighbor_graph(cloud.points);
  std::vector<Limb> limbs = {
      limb_along_x(cloud.points, 0, static_cast<std::uint32_t>(cloud.size()), 0, 0.01)};
  measure_lengths(limbs);
  grow_side_shoots(cloud.points, graph, paths_along_x(cloud.points), limbs, 0.001);
  EXPECT_EQ(limbs.size(), 1u);
  EXPECT_EQ(points_of(limbs[0]), cloud.size());
}

TEST(SideShoots, points_go_to_the_limb_on_whose_surface_they_lie) {
  PointCloud cloud;
  test::add_wood(cloud, {0, 0, 0}, {0.3, 0, 0}, 0.01, 0.01, 0.006, 0.0005);
  const auto second = static_cast<std::uint32_t>(cloud.size());
  test::add_wood(cloud, {0, 0.026, 0}, {0.3, 0.026, 0}, 0.01, 0.01, 0.006, 0.0005);
  const auto all = static_cast<std::uint32_t>(cloud.size());
  const PointGraph graph = neighbor_graph(cloud.points);
  // The first limb was given what lies between 10 and 14 cm of the second.
  std::vector<Limb> limbs = {limb_along_x(cloud.points, 0, second, 0, 0.01),
                             limb_along_x(cloud.points, second, all, 0.026, 0.01)};
  std::size_t stolen = 0;
  for (std::size_t i : {5u, 6u}) {
    auto& from = limbs[1].nodes[i].points;
    for (const std::uint32_t p : from)
      if (cloud.points[p].y() < 0.034) {
        limbs[0].nodes[i].points.push_back(p);
        ++stolen;
      }
    std::erase_if(from, [&](std::uint32_t p) { return cloud.points[p].y() < 0.034; });
  }
  measure_lengths(limbs);
  ASSERT_GT(stolen, 10u);
  const std::size_t before = points_of(limbs[1]);
  hand_over_points(cloud.points, graph, limbs, 0.0005);
  EXPECT_GT(points_of(limbs[1]), before + stolen * 9 / 10);
  EXPECT_EQ(points_of(limbs[0]) + points_of(limbs[1]), all);
}

TEST(SideShoots, nothing_of_nothing) {
  std::vector<Limb> limbs;
  hand_over_points({}, neighbor_graph({}), limbs, 0.001);
  grow_side_shoots({}, neighbor_graph({}), {}, limbs, 0.001);
  EXPECT_TRUE(limbs.empty());
  EXPECT_THROW(grow_side_shoots({}, neighbor_graph({}), {}, limbs, 0.001, {.shortest_limb_m = -1}),
               InputError);
}

}  // namespace
}  // namespace dendrofit
