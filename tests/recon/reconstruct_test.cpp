// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/reconstruct.h"

#include "core/errors.h"
#include "core/tree_topology.h"
#include "tests/recon/hand_made_clouds.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

int roots_of(const Tree& tree) {
  int roots = 0;
  for (const std::int32_t p : tree.parent) roots += p < 0;
  return roots;
}

TEST(Reconstruct, a_noisy_cylinder_is_one_axis_of_its_radius) {
  PointCloud cloud;
  test::add_wood(cloud, {0, 0, 0}, {0.1, 0, 2}, 0.06, 0.05, 0.008, 0.002);
  const Reconstruction r = reconstruct(cloud);
  r.tree.validate();
  EXPECT_EQ(roots_of(r.tree), 1);
  ASSERT_TRUE(r.metrics.dbh_m.has_value());
  EXPECT_NEAR(*r.metrics.dbh_m, 2 * (0.06 - 0.01 * 1.3 / 2), 0.003);
  EXPECT_NEAR(r.metrics.height_m, 2, 0.03);
  EXPECT_NEAR(r.metrics.stem_volume_m3, 2.0025 * 3.14159 * (0.0036 + 0.003 + 0.0025) / 3, 0.0010);
}

TEST(Reconstruct, a_half_seen_cylinder_keeps_its_radius) {
  PointCloud cloud;
  test::add_wood(cloud, {0, 0, 0}, {0, 0, 2}, 0.08, 0.08, 0.008, 0.001, 0.0, 0.5);
  const Reconstruction r = reconstruct(cloud);
  EXPECT_NEAR(r.metrics.dbh_m.value_or(0), 0.16, 0.008);
}

TEST(Reconstruct, a_stem_seen_as_a_strip_for_a_metre_stays_one_stem_of_its_thickness) {
  PointCloud cloud;
  test::add_wood(cloud, {0, 0, 0}, {0.1, 0, 1}, 0.08, 0.077, 0.012, 0.003);
  test::add_wood(cloud, {0.1, 0, 1}, {0.2, 0, 2}, 0.077, 0.074, 0.012, 0.003, 0.0, 0.2);
  test::add_wood(cloud, {0.2, 0, 2}, {0.3, 0, 3}, 0.074, 0.07, 0.012, 0.003);
  const Reconstruction r = reconstruct(cloud);
  double stem_top = 0;
  for (std::size_t i = 0; i < r.tree.size(); ++i) {
    if (r.tree.order[i] != 0) continue;
    const Vec3 middle = 0.5 * (r.tree.start[i] + r.tree.end[i]) + r.tree.origin_shift;
    stem_top = std::max(stem_top, r.tree.end[i].z() + r.tree.origin_shift.z());
    if (middle.z() < 1.1 || middle.z() > 1.9) continue;
    EXPECT_NEAR(r.tree.radius[i], 0.08 - 0.01 * middle.z() / 3, 0.008) << middle.z();
    EXPECT_NEAR(middle.x(), 0.1 * middle.z(), 0.02) << middle.z();
    EXPECT_NEAR(middle.y(), 0, 0.02) << middle.z();
  }
  EXPECT_GT(stem_top, 2.9);
  EXPECT_LT(r.metrics.branch_volume_m3, 0.05 * r.metrics.stem_volume_m3);
}

TEST(Reconstruct, a_small_tree_has_its_branches_where_they_are) {
  const Reconstruction r = reconstruct(test::small_tree());
  r.tree.validate();
  EXPECT_EQ(roots_of(r.tree), 1);
  const auto axes = axes_of(r.tree);
  int first_order = 0;
  for (const Axis& axis : axes) {
    if (axis.order != 1 || axis.length < 0.4) continue;
    ++first_order;
    const double z = r.tree.start[static_cast<std::size_t>(axis.nodes.front())].z() + r.tree.origin_shift.z();
    EXPECT_TRUE(std::abs(z - 1.5) < 0.06 || std::abs(z - 1.9) < 0.06) << z;
  }
  EXPECT_EQ(first_order, 2);
}

TEST(Reconstruct, a_crooked_branch_and_its_spurs_are_followed_closely) {
  PointCloud cloud;
  test::add_wood(cloud, {0, 0, 0}, {0, 0, 2}, 0.04, 0.02, 0.012, 0.001);
  const std::array<Vec3, 5> bends = {Vec3(0.02, 0, 1.2), Vec3(0.15, 0, 1.3), Vec3(0.22, 0.1, 1.3),
                                     Vec3(0.35, 0.1, 1.42), Vec3(0.5, 0.02, 1.42)};
  for (std::size_t i = 0; i + 1 < bends.size(); ++i)
    test::add_wood(cloud, bends[i], bends[i + 1], 0.008, 0.008, 0.012, 0.001);
  test::add_wood(cloud, {0.42, 0.07, 1.43}, {0.42, 0.07, 1.47}, 0.003, 0.002, 0.012, 0.001);
  const Reconstruction r = reconstruct(cloud);
  std::size_t far = 0;
  for (const Vec3& p : cloud.points) {
    double nearest = 1e300;
    for (std::size_t i = 0; i < r.tree.size(); ++i) {
      const Vec3 start = r.tree.start[i] + r.tree.origin_shift, run = r.tree.end[i] - r.tree.start[i];
      const double t = std::clamp((p - start).dot(run) / run.squaredNorm(), 0.0, 1.0);
      nearest = std::min(nearest, std::abs((start + t * run - p).norm() - r.tree.radius[i]));
    }
    far += nearest > 0.01;
  }
  EXPECT_LT(static_cast<double>(far), 0.01 * static_cast<double>(cloud.size())) << far;
}

TEST(Reconstruct, a_stem_that_stands_in_grass_is_found_above_it) {
  PointCloud cloud = test::small_tree();
  Random random(3);
  for (int i = 0; i < 40; ++i)
    for (int k = 0; k < 40; ++k)
      cloud.points.emplace_back(-1 + 0.05 * i, -1 + 0.05 * k, 0.01 * random.normal());
  for (int i = 0; i < 4000; ++i) {  // blades, dense enough to be one piece with the stem
    const Vec3 foot(2 * random.uniform() - 1, 2 * random.uniform() - 1, 0);
    const double length = 0.1 + 0.1 * random.uniform();
    for (double z = 0.02; z < length; z += 0.02) cloud.points.push_back(foot + Vec3(0.2 * z, 0, z));
  }
  const Reconstruction r = reconstruct(cloud);
  EXPECT_TRUE(r.ground_found);
  EXPECT_NEAR(r.foot.x(), 0, 0.03);
  EXPECT_NEAR(r.foot.y(), 0, 0.03);
  EXPECT_NEAR(r.metrics.dbh_m.value_or(0), 0.1 - 0.08 * 1.3 / 3, 0.006);
  EXPECT_NEAR(r.metrics.height_m, 3, 0.2);
  const Reconstruction bare = reconstruct(test::small_tree());
  EXPECT_NEAR(r.metrics.branch_volume_m3, bare.metrics.branch_volume_m3,
              0.15 * bare.metrics.branch_volume_m3);
}

TEST(Reconstruct, a_fence_beside_a_tree_without_ground_is_no_branch) {
  const Reconstruction bare = reconstruct(test::small_tree());
  PointCloud cloud = test::small_tree();
  for (const double y : {-0.6, 0.0, 0.6})
    test::add_wood(cloud, {0.3, y, 0}, {0.3, y, 0.5}, 0.02, 0.02, 0.008);
  for (const double z : {0.2, 0.4}) test::add_wood(cloud, {0.3, -0.6, z}, {0.3, 0.6, z}, 0.015, 0.015, 0.008);
  const Reconstruction r = reconstruct(cloud);
  EXPECT_NEAR(r.metrics.total_volume_m3, bare.metrics.total_volume_m3, 0.02 * bare.metrics.total_volume_m3);
  EXPECT_NEAR(r.metrics.total_length_m, bare.metrics.total_length_m, 0.05 * bare.metrics.total_length_m);
}

TEST(Reconstruct, a_y_becomes_two_arms_and_the_thicker_goes_on) {
  PointCloud cloud;
  test::add_wood(cloud, {0, 0, 0}, {0, 0, 1}, 0.05, 0.05, 0.008, 0.001);
  test::add_wood(cloud, {0.01, 0, 1}, {0.6, 0, 2}, 0.04, 0.03, 0.008, 0.001);
  test::add_wood(cloud, {-0.01, 0, 1}, {-0.6, 0, 2}, 0.025, 0.015, 0.008, 0.001);
  const Reconstruction r = reconstruct(cloud);
  double stem_end = 0;
  for (std::size_t i = 0; i < r.tree.size(); ++i)
    if (r.tree.order[i] == 0) stem_end = r.tree.end[i].x() + r.tree.origin_shift.x();
  EXPECT_GT(stem_end, 0.4);
  EXPECT_GT(r.metrics.branch_volume_m3, 0.0005);
}

TEST(Reconstruct, a_gap_is_crossed_and_marked) {
  PointCloud cloud;
  test::add_wood(cloud, {0, 0, 0}, {0, 0, 1.5}, 0.05, 0.045, 0.008, 0.001);
  test::add_wood(cloud, {0, 0, 1.8}, {0, 0, 3}, 0.044, 0.03, 0.008, 0.001);
  const Reconstruction r = reconstruct(cloud);
  EXPECT_EQ(roots_of(r.tree), 1);
  EXPECT_NEAR(r.metrics.height_m, 3, 0.05);
  EXPECT_GE(r.bridged_gaps, 1u);
  bool marked = false;
  for (std::size_t i = 0; i < r.tree.size(); ++i) {
    const double z = 0.5 * (r.tree.start[i].z() + r.tree.end[i].z()) + r.tree.origin_shift.z();
    marked = marked || (z > 1.5 && z < 1.8 && r.tree.quality[i] != RadiusQuality::measured);
  }
  EXPECT_TRUE(marked);
}

TEST(Reconstruct, standing_elsewhere_or_other_threads_change_nothing) {
  const PointCloud here = test::small_tree();
  const Reconstruction a = reconstruct(here, {.threads = 1});
  for (const Vec3& place : test::places()) {
    const Reconstruction b = reconstruct(test::moved(here, place), {.threads = 2});
    ASSERT_EQ(a.tree.size(), b.tree.size());
    EXPECT_EQ(a.tree.radius, b.tree.radius);
    EXPECT_EQ(a.tree.start, b.tree.start);
    EXPECT_EQ(a.tree.end, b.tree.end);
    EXPECT_EQ(a.tree.axis, b.tree.axis);
    EXPECT_LT((b.foot - a.foot - place).norm(), 2e-9);
  }
}

TEST(Reconstruct, intervals_hold_the_truth) {
  const Reconstruction r = reconstruct(test::small_tree(0.002));
  for (const char* name : {"dbh_m", "height_m", "stem_volume_m3", "total_volume_m3"})
    ASSERT_TRUE(r.metrics.intervals.count(name)) << name;
  const Interval dbh = r.metrics.intervals.at("dbh_m"), height = r.metrics.intervals.at("height_m");
  const double truth = 2 * (0.05 - 0.04 * 1.3 / 3);
  EXPECT_LE(dbh.lo, truth);
  EXPECT_GE(dbh.hi, truth);
  EXPECT_LT(dbh.hi - dbh.lo, 0.3 * truth);
  EXPECT_LE(height.lo, 3.0);
  EXPECT_GE(height.hi, 3.0);
}

TEST(Reconstruct, empty_and_single_points_are_refused) {
  EXPECT_THROW(reconstruct(PointCloud{}), SolverError);
  PointCloud one;
  one.points = {{1, 2, 3}};
  EXPECT_THROW(reconstruct(one), SolverError);
  EXPECT_THROW(reconstruct(one, {.voxel_size_m = -1}), InputError);
  EXPECT_THROW(reconstruct(one, {.dbh_height_m = 0}), InputError);
}

TEST(Reconstruct, points_on_one_line_are_no_tree) {
  PointCloud cloud;
  for (int i = 0; i < 500; ++i) cloud.points.push_back({0.002 * i, 0.001 * i, 0.01 * i});
  EXPECT_THROW(reconstruct(cloud), SolverError);
  cloud.points.clear();
  test::add_wood(cloud, {0, 0, 0}, {0, 0, 2}, 0.004, 0.003, 0.004, 0.001);  // a thin whip is one
  EXPECT_NO_THROW(reconstruct(cloud));
}

TEST(Reconstruct, stops_when_asked_to) {
  const std::atomic<bool> stop{true};
  Progress progress(&stop);
  EXPECT_THROW(reconstruct(test::small_tree(), {}, progress), Cancelled);
}

}  // namespace
}  // namespace dendrofit
