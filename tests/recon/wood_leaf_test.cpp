// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/wood_leaf.h"

#include "core/errors.h"
#include "recon/path_evidence.h"
#include "recon/reconstruct.h"
#include "tests/recon/hand_made_clouds.h"

#include <array>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

/// A flat leaf: points `step` apart on a disc about `centre`, turned at random.
void add_leaf(PointCloud& cloud, const Vec3& centre, double radius, double step, Random& random) {
  const Vec3 normal = random.direction();
  Vec3 u, v;
  plane_frame(normal, u, v);
  for (double a = -radius; a <= radius; a += step)
    for (double b = -radius; b <= radius; b += step)
      if (a * a + b * b <= radius * radius)
        cloud.points.push_back(centre + a * u + b * v + 0.001 * random.normal() * normal);
}

/// Stem, four branches, and on request leaves about the branches' outer parts. Returns how many points are
/// wood; they come first.
std::size_t add_tree(PointCloud& cloud, bool leaves) {
  test::add_wood(cloud, {0, 0, 0}, {0, 0, 3}, 0.05, 0.02, 0.01, 0.001);
  const Vec3 ends[4] = {{1, 0, 2.6}, {-1, 0.1, 2.9}, {0.1, 1, 3.1}, {0, -1, 3.3}};
  for (int k = 0; k < 4; ++k) test::add_wood(cloud, {0, 0, 1.6 + 0.3 * k}, ends[k], 0.02, 0.004, 0.01, 0.001);
  const std::size_t wood = cloud.size();
  if (!leaves) return wood;
  Random random = Random(3).child({1});
  for (int k = 0; k < 4; ++k)
    for (int i = 0; i < 150; ++i) {
      const double t = random.uniform(0.35, 1.05);
      const Vec3 on = (1 - t) * Vec3(0, 0, 1.6 + 0.3 * k) + t * ends[k];
      add_leaf(cloud, on + random.uniform(0.05, 0.2) * random.direction(), 0.03, 0.012, random);
    }
  return wood;
}

std::set<std::array<double, 3>> places(const PointCloud& cloud) {
  std::set<std::array<double, 3>> set;
  for (const Vec3& p : cloud.points) {
    const Vec3 w = cloud.origin_shift + p;
    set.insert({w.x(), w.y(), w.z()});
  }
  return set;
}

TEST(WoodLeaf, leaves_are_set_aside_and_wood_stays) {
  PointCloud cloud;
  const std::size_t wood = add_tree(cloud, true);
  const Reconstruction r = reconstruct(cloud);
  EXPECT_TRUE(r.leaf_on);
  const auto leaf = places(r.leaf_points);
  std::size_t lost = 0, found = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Vec3& p = cloud.points[i];
    (i < wood ? lost : found) += leaf.count({p.x(), p.y(), p.z()});
  }
  EXPECT_LT(static_cast<double>(lost), 0.15 * static_cast<double>(wood));
  EXPECT_GT(static_cast<double>(found), 0.85 * static_cast<double>(cloud.size() - wood));
  std::size_t counted = 0;
  for (const LeafLayer& layer : r.metrics.leaf_profile) counted += layer.points;
  EXPECT_EQ(counted, r.leaf_points.size());
  EXPECT_NEAR(r.wood_share, static_cast<double>(wood) / static_cast<double>(cloud.size()), 0.1);
}

TEST(WoodLeaf, leaves_do_not_thicken_the_tree) {
  PointCloud bare, leafy;
  add_tree(bare, false);
  add_tree(leafy, true);
  const TreeMetrics a = reconstruct(bare).metrics, b = reconstruct(leafy).metrics;
  EXPECT_NEAR(b.stem_volume_m3, a.stem_volume_m3, 0.1 * a.stem_volume_m3);
  EXPECT_NEAR(b.branch_volume_m3, a.branch_volume_m3, 0.25 * a.branch_volume_m3);
}

TEST(WoodLeaf, nothing_is_taken_from_a_bare_tree) {
  PointCloud cloud;
  add_tree(cloud, false);
  const Reconstruction r = reconstruct(cloud);
  EXPECT_FALSE(r.leaf_on);
  EXPECT_TRUE(r.leaf_points.empty());
  EXPECT_TRUE(r.metrics.leaf_profile.empty());
  EXPECT_EQ(r.wood_share, 1);
}

TEST(WoodLeaf, a_bundle_of_bare_twigs_stays_wood) {
  PointCloud cloud;
  add_tree(cloud, false);
  Random random = Random(5).child({1});
  for (int k = 0; k < 40; ++k) {  // a broom of shoots
    const Vec3 out = random.direction();
    test::add_wood(cloud, Vec3(0, 0, 3), Vec3(0, 0, 3) + 0.5 * Vec3(out.x(), out.y(), std::abs(out.z())),
                   0.003, 0.002, 0.01, 0.001);
  }
  EXPECT_FALSE(reconstruct(cloud).leaf_on);
}

TEST(WoodLeaf, a_trunk_with_points_5_cm_apart_stays_wood_all_round) {
  PointCloud cloud;
  test::add_wood(cloud, {0, 0, 0}, {0, 0, 7}, 0.13, 0.03, 0.05, 0.004);
  Random random = Random(5).child({2});
  for (int k = 0; k < 5; ++k) {
    const Vec3 base(0, 0, 3 + 0.7 * k), out(std::cos(2.4 * k), std::sin(2.4 * k), 0.5);
    test::add_wood(cloud, base, base + 1.5 * out, 0.03, 0.01, 0.03, 0.004);
    for (int i = 0; i < 400; ++i)
      add_leaf(cloud, base + random.uniform(0.5, 1.7) * out + random.uniform(0.05, 0.4) * random.direction(),
               0.04, 0.04, random);
  }
  const Reconstruction r = reconstruct(cloud);
  ASSERT_TRUE(r.leaf_on);
  std::size_t lost = 0;
  for (const Vec3& p : r.leaf_points.points) lost += (r.leaf_points.origin_shift + p).z() < 2.5;
  EXPECT_LT(lost, 20u);  // of some 800
  ASSERT_TRUE(r.metrics.dbh_m);
  EXPECT_NEAR(*r.metrics.dbh_m, 2 * (0.13 - 0.1 * 1.3 / 7), 0.02);
}

TEST(PathEvidence, straight_runs_score_higher_than_crooked_ones) {
  // One straight path of 2 m and one that turns at right angles every 4 cm, both from point 0.
  std::vector<Vec3> points = {Vec3::Zero()};
  Paths paths;
  paths.parent = {Paths::kNone};
  paths.length = {0};
  const auto run = [&](auto step) {
    std::uint32_t last = 0;
    for (int i = 0; i < 100; ++i) {
      const auto here = static_cast<std::uint32_t>(points.size());
      points.push_back(points[last] + step(i));
      paths.parent.push_back(last);
      paths.length.push_back(paths.length[last] + 0.02f);
      last = here;
    }
  };
  run([](int) { return Vec3(0, 0, 0.02); });
  run([](int i) { return (i / 2) % 2 ? Vec3(0.02, 0, 0) : Vec3(0, 0.02, 0); });
  for (std::uint32_t i = 0; i < points.size(); ++i) paths.order.push_back(i);
  const PathEvidence evidence = weigh_paths(points, paths, 0.1);
  EXPECT_NEAR(evidence.reach[0], 2, 1e-4);
  EXPECT_NEAR(evidence.reach[50], 1, 1e-4);
  EXPECT_NEAR(evidence.straight[50], 1, 1e-4);
  EXPECT_NEAR(evidence.straight[150], std::sqrt(0.5), 0.05);
  EXPECT_EQ(evidence.straight[100], 0);  // a tip bears nothing
}

TEST(WoodLeaf, options_out_of_range_are_refused) {
  EXPECT_THROW(WoodLeafOptions{.window_m = 0}.validate(), InputError);
  EXPECT_THROW(WoodLeafOptions{.leaf_on_share = 1.5}.validate(), InputError);
  EXPECT_NO_THROW(WoodLeafOptions{}.validate());
}

}  // namespace
}  // namespace dendrofit
