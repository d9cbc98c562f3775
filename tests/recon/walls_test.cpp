// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/walls.h"

#include "recon/reconstruct.h"
#include "tests/recon/hand_made_clouds.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace dendrofit {
namespace {

/// Points 1.5 cm apart on an upright plane through `corner`, `width` along `way` and `height` high.
void add_wall(std::vector<Vec3>& points, const Vec3& corner, const Vec3& way, double width, double height) {
  Random random(11);
  const Vec3 normal = way.cross(Vec3::UnitZ());
  for (double a = 0; a <= width; a += 0.015)
    for (double z = 0; z <= height; z += 0.015)
      points.push_back(corner + a * way + Vec3(0, 0, z) + 0.003 * random.normal() * normal);
}

CleanScan scan_of(const std::vector<Vec3>& points) {
  CleanScan scan;
  scan.points = points;
  for (std::uint32_t i = 0; i < points.size(); ++i) scan.source.push_back(i);
  return scan;
}

TEST(Walls, an_oblique_wall_is_taken_out_and_the_tree_before_it_is_not) {
  std::vector<Vec3> points = test::small_tree().points;
  const std::size_t tree = points.size();
  add_wall(points, {-1.5, 0.6, 0}, Vec3(1, 0.3, 0).normalized(), 3, 2.5);
  CleanScan scan = scan_of(points);
  const std::size_t removed = remove_walls(scan);
  EXPECT_GT(removed, 0.999 * static_cast<double>(points.size() - tree));
  std::size_t left = 0;
  for (const std::uint32_t i : scan.source) left += i < tree;
  EXPECT_EQ(left, tree);
}

TEST(Walls, boards_trunks_and_crowns_are_none) {
  PointCloud thick;  // a trunk 1.2 m through
  test::add_wood(thick, {0, 0, 0}, {0, 0, 4}, 0.6, 0.55, 0.02, 0.003);
  std::vector<Vec3> points = thick.points;
  add_wall(points, {3, 0, 0}, Vec3::UnitX(), 0.6, 3);  // a board
  Random random(3);
  for (int i = 0; i < 30000; ++i)
    points.push_back({5 + random.uniform(-1, 1), random.uniform(-1, 1), 2 + random.uniform(-1, 1)});
  CleanScan scan = scan_of(points);
  EXPECT_EQ(remove_walls(scan), 0u);
  EXPECT_EQ(scan.points.size(), points.size());
  CleanScan nothing;
  EXPECT_EQ(remove_walls(nothing), 0u);
}

TEST(Walls, a_branch_that_reaches_a_wall_does_not_grow_over_it) {
  PointCloud cloud = test::small_tree();
  const Reconstruction alone = reconstruct(cloud);
  add_wall(cloud.points, {0.79, -1.5, 0.5}, Vec3::UnitY(), 3, 2.5);
  const Reconstruction r = reconstruct(cloud);
  EXPECT_GT(r.wall_points, 30000u);
  EXPECT_NEAR(r.metrics.total_length_m, alone.metrics.total_length_m, 0.05);
  EXPECT_NEAR(r.metrics.total_volume_m3, alone.metrics.total_volume_m3, 0.02 * alone.metrics.total_volume_m3);
}

}  // namespace
}  // namespace dendrofit
