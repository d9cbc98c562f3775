// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/preprocess.h"

#include "core/errors.h"
#include "tests/recon/hand_made_clouds.h"

#include <limits>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

TEST(CleanScan, merges_duplicates_and_keeps_the_rest) {
  PointCloud cloud;
  cloud.points = {{0, 0, 0}, {0, 0, 0}, {0.0001, 0, 0}, {1, 1, 1}};
  const CleanScan clean = clean_scan(cloud);
  EXPECT_EQ(clean.raw_points, 4u);
  EXPECT_EQ(clean.points.size(), 2u);
}

TEST(CleanScan, is_the_same_wherever_the_cloud_stands) {
  // Coordinates as instruments give them: doubles, single precision, tenths of a millimetre.
  std::vector<PointCloud> clouds = {test::small_tree(), test::small_tree(0.003), test::small_tree()};
  for (Vec3& p : clouds[1].points) p = p.cast<float>().cast<double>();
  for (Vec3& p : clouds[2].points) p = (1e4 * p).array().round() / 1e4;
  for (const PointCloud& here : clouds)
    for (const double voxel : {0.004, 0.0051, 0.03})
      for (const Vec3& place : test::places()) {
        const PointCloud there = test::moved(here, place);
        const CleanScan a = clean_scan(here, {.voxel_size_m = voxel}),
                        b = clean_scan(there, {.voxel_size_m = voxel});
        EXPECT_EQ(a.points, b.points);
        EXPECT_EQ(a.source, b.source);
        EXPECT_LT((b.origin_shift - a.origin_shift - place).norm(), 2e-9);
      }
}

TEST(CleanScan, moves_no_single_point_by_more_than_the_lattice_asks) {
  const PointCloud cloud = test::small_tree();
  const CleanScan clean = clean_scan(cloud, {.voxel_size_m = 1e-4});
  ASSERT_EQ(clean.points.size(), cloud.size());
  for (std::size_t i = 0; i < clean.points.size(); ++i)
    EXPECT_LT((clean.origin_shift + clean.points[i] - cloud.points[clean.source[i]]).norm(), 5e-5);
}

TEST(CleanScan, refuses_coordinates_that_are_not_finite) {
  PointCloud cloud;
  cloud.points = {{0, 0, 0}, {std::numeric_limits<double>::infinity(), 0, 0}};
  EXPECT_THROW(clean_scan(cloud), InputError);
  EXPECT_TRUE(clean_scan(PointCloud{}).points.empty());
}

TEST(Ground, a_slope_under_a_tree_is_found_and_removed) {
  PointCloud cloud = test::small_tree();
  Random random(5);
  const std::size_t wood = cloud.size();
  for (int i = 0; i < 6000; ++i) {
    const double x = random.uniform(-1.5, 1.5), y = random.uniform(-1.5, 1.5);
    cloud.points.push_back({x, y, 0.2 * x + 0.01 * random.normal()});
  }
  CleanScan scan = clean_scan(cloud);
  const Ground ground = find_ground(scan.points);
  ASSERT_TRUE(ground.present);
  const Vec3 origin = scan.origin_shift;
  EXPECT_NEAR(ground.height_at(0 - origin.x(), 0 - origin.y()) + origin.z(), 0, 0.06);
  EXPECT_NEAR(ground.height_at(1 - origin.x(), 0 - origin.y()) + origin.z(), 0.2, 0.06);
  const std::size_t removed = remove_ground(scan, ground);
  EXPECT_GT(removed, 5500u);
  EXPECT_GT(scan.points.size(), wood * 9 / 10);
}

TEST(Ground, a_tree_cut_out_of_its_scene_has_none) {
  const CleanScan scan = clean_scan(test::small_tree());
  EXPECT_FALSE(find_ground(scan.points).present);
  EXPECT_FALSE(find_ground({}).present);
}

}  // namespace
}  // namespace dendrofit
