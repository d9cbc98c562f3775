// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/scan_intervals.h"

#include "recon/reconstruct.h"
#include "tests/recon/hand_made_clouds.h"

#include <cmath>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

/// A stem of 2 m with one limb, `limb_radius` thick, from its middle.
Tree forked(double limb_radius) {
  Tree tree;
  const auto add = [&](const Vec3& from, const Vec3& to, std::int32_t parent, double radius, int axis,
                       int order) {
    TreeNode node;
    node.start = from;
    node.end = to;
    node.parent = parent;
    node.radius = radius;
    node.axis = axis;
    node.order = order;
    node.radius_se = 0.05 * radius;
    return tree.add(node);
  };
  const std::int32_t foot = add({0, 0, 0}, {0, 0, 1}, -1, 0.06, 0, 0);
  add({0, 0, 1}, {0, 0, 2}, foot, 0.05, 0, 0);
  add({0.05, 0, 1}, {1, 0, 1.5}, foot, limb_radius, 1, 1);
  return tree;
}

TreeMetrics with_intervals(const Tree& tree, const Visibility& seen, double noise = 0.002,
                           double spacing = 0.01) {
  TreeMetrics metrics = measure(tree);
  estimate_scan_intervals(tree, SliceDiameter{0.1, 0.0005, 1, 0}, seen, noise, spacing, metrics);
  return metrics;
}

double width(const TreeMetrics& metrics, const char* name) {
  const Interval& i = metrics.intervals.at(name);
  EXPECT_LE(i.lo, i.value);
  EXPECT_GE(i.hi, i.value);
  return i.hi - i.lo;
}

TEST(ScanIntervals, noise_and_spacing_widen_them) {
  const Tree tree = forked(0.01);
  const TreeMetrics fine = with_intervals(tree, {}), coarse = with_intervals(tree, {}, 0.008, 0.04);
  for (const char* name : {"dbh_m", "height_m", "stem_volume_m3", "total_volume_m3"})
    EXPECT_GT(width(coarse, name), 1.2 * width(fine, name)) << name;
}

TEST(ScanIntervals, a_stem_seen_from_one_side_may_hide_wood_but_not_invent_it) {
  const Tree tree = forked(0.03);
  const Interval all = with_intervals(tree, {}).intervals.at("total_volume_m3");
  const Interval half = with_intervals(tree, {.stem_coverage = 0.45}).intervals.at("total_volume_m3");
  EXPECT_GT(half.hi - half.value, 1.5 * (all.hi - all.value));
  EXPECT_GT(half.hi - half.value, 1.2 * (half.value - half.lo));
}

TEST(ScanIntervals, a_rival_limb_makes_the_stem_doubtful_and_not_the_total) {
  const TreeMetrics thin = with_intervals(forked(0.01), {}), rival = with_intervals(forked(0.045), {});
  EXPECT_GT(width(rival, "stem_volume_m3"), 1.3 * width(thin, "stem_volume_m3"));
  EXPECT_LT(width(rival, "total_volume_m3") / rival.total_volume_m3, 0.3);
}

TEST(ScanIntervals, foliage_may_hide_the_tip) {
  const Tree tree = forked(0.01);
  const Interval bare = with_intervals(tree, {}).intervals.at("height_m");
  const Interval leafy = with_intervals(tree, {.in_leaf = true}).intervals.at("height_m");
  EXPECT_GT(leafy.hi, bare.hi + 0.05);
  EXPECT_LT(leafy.lo, bare.lo - 0.05);
}

TEST(ScanIntervals, the_highest_leaves_tell_a_hidden_top_and_two_strays_do_not) {
  std::vector<Vec3> leaves(10, Vec3(0, 0, 12.5));
  EXPECT_NEAR(height_in_leaf(2, leaves, 10), 2.47, 1e-9);
  leaves.push_back({0, 0, 14});
  leaves.push_back({0, 0, 15});
  EXPECT_NEAR(height_in_leaf(2, leaves, 10), 2.47, 1e-9);
  EXPECT_EQ(height_in_leaf(3, leaves, 10), 3);
  EXPECT_EQ(height_in_leaf(2, {}, 10), 2);
}

TEST(ScanIntervals, halves_that_disagree_widen_them) {
  const Tree tree = forked(0.01);
  const SubsampleSpread far{.dbh_m = 0.004, .height_m = 0.1, .stem_share = 0.1, .branch_share = 0.3};
  const TreeMetrics sure = with_intervals(tree, {}), unsure = with_intervals(tree, {.spread = far});
  for (const char* name : {"dbh_m", "height_m", "stem_volume_m3", "total_volume_m3"})
    EXPECT_GT(width(unsure, name), 1.5 * width(sure, name)) << name;
}

TEST(ScanIntervals, a_diameter_without_a_circle_is_a_guess) {
  const Tree tree = forked(0.01);
  TreeMetrics metrics = measure(tree);
  estimate_scan_intervals(tree, std::nullopt, {}, 0.002, 0.01, metrics);
  EXPECT_GT(width(metrics, "dbh_m"), 0.4 * *metrics.dbh_m);
}

TEST(ScanIntervals, how_well_seen_counts_coverage_and_gaps) {
  Limb stem;
  for (int i = 0; i < 5; ++i) {
    LimbNode node;
    node.along_m = 0.5 * i;
    node.radius_m = 0.05;
    node.coverage = i < 3 ? 1.0 : 0.5;
    node.measured = true;
    node.after_gap = i == 4;
    stem.nodes.push_back(node);
  }
  Limb branch = stem;
  branch.parent = 0;
  for (LimbNode& node : branch.nodes) node.after_gap = false;
  branch.nodes[2].measured = false;
  const Visibility seen = how_well_seen({stem, branch}, false);
  EXPECT_NEAR(seen.stem_coverage, 0.75, 1e-9);
  EXPECT_NEAR(seen.gap_share, 0.25, 1e-9);
  EXPECT_NEAR(seen.unmeasured_share, 0.25, 1e-9);
  EXPECT_EQ(how_well_seen({}, true).stem_coverage, 0);
}

TEST(ScanIntervals, nine_noisy_scans_of_one_stem_hold_its_diameter) {
  int held = 0, all = 0;
  for (const double noise : {0.001, 0.002, 0.004})
    for (const double arc : {1.0, 0.75, 0.5}) {
      PointCloud cloud;
      test::add_wood(cloud, {0, 0, 0}, {0, 0, 2.5}, 0.08, 0.05, 0.008, noise, 0, arc);
      const TreeMetrics metrics = reconstruct(cloud).metrics;
      const Interval dbh = metrics.intervals.at("dbh_m");
      const double truth = 2 * (0.08 - 0.03 * 1.3 / 2.5);
      held += dbh.lo <= truth && truth <= dbh.hi;
      EXPECT_LT(dbh.hi - dbh.lo, 0.15 * truth) << noise << ' ' << arc;
      ++all;
    }
  EXPECT_GE(held, all - 1);
}

}  // namespace
}  // namespace dendrofit
