// SPDX-License-Identifier: GPL-3.0-or-later
#include "forward/virtual_scan/virtual_scan.h"

#include "core/errors.h"
#include "forward/igm/grow.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

Tree pole(double radius, double height) {
  Tree tree;
  TreeNode node;
  node.end = Vec3(0, 0, height);
  node.radius = radius;
  tree.add(node);
  return tree;
}

ScanOptions ideal() {
  ScanOptions options;
  options.rays_per_beam = 1;
  options.range_noise_m = 0;
  options.ground_radius_m.reset();
  options.step_deg = 0.2;
  return options;
}

TEST(VirtualScan, an_ideal_instrument_puts_every_point_on_the_surface) {
  const VirtualScan scan = scan_tree(pole(0.2, 3), nullptr, ideal());
  ASSERT_GT(scan.cloud.size(), 500u);
  std::vector<double> azimuth;
  for (const Vec3& p : scan.cloud.points) {
    const double r = std::hypot(p.x(), p.y());
    if (p.z() < 3 - 1e-6) {
      EXPECT_NEAR(r, 0.2, 1e-5);
    }
    EXPECT_LE(r, 0.2 + 1e-5);
    azimuth.push_back(std::atan2(p.y(), p.x()));
  }
  std::sort(azimuth.begin(), azimuth.end());
  for (std::size_t i = 1; i < azimuth.size(); ++i)
    EXPECT_LT(azimuth[i] - azimuth[i - 1], 0.3);  // seen all round
  EXPECT_EQ(scan.cloud.classification.size(), scan.cloud.size());
  EXPECT_EQ(scan.node, std::vector<std::int32_t>(scan.cloud.size(), 0));
}

TEST(VirtualScan, one_station_sees_one_side) {
  ScanOptions options = ideal();
  options.stations = 1;
  for (const Vec3& p : scan_tree(pole(0.2, 3), nullptr, options).cloud.points) EXPECT_GT(p.x(), 0);
}

TEST(VirtualScan, tapered_cones_run_from_radius_to_radius) {
  Tree tree = pole(0.2, 1);
  TreeNode upper;
  upper.start = Vec3(0, 0, 1), upper.end = Vec3(0, 0, 2), upper.parent = 0, upper.radius = 0.1;
  tree.add(upper);
  for (const Vec3& p : scan_tree(tree, nullptr, ideal()).cloud.points) {
    if (p.z() > 1.999) continue;
    const double expected = p.z() < 1 ? 0.2 - 0.05 * p.z() : 0.15 - 0.05 * (p.z() - 1);
    EXPECT_NEAR(std::hypot(p.x(), p.y()), expected, 1e-4) << p.z();
  }
  ScanOptions plain = ideal();
  plain.tapered = false;
  for (const Vec3& p : scan_tree(tree, nullptr, plain).cloud.points)
    if (p.z() < 0.99) {
      EXPECT_NEAR(std::hypot(p.x(), p.y()), 0.2, 1e-5);
    }
}

TEST(VirtualScan, noise_has_the_asked_spread_along_the_beam) {
  ScanOptions options = ideal();
  options.range_noise_m = 0.004;
  options.step_deg = 0.05;
  options.stations = 1;
  const VirtualScan scan = scan_tree(pole(0.2, 3), nullptr, options);
  double sum = 0, squares = 0;
  for (const float e : scan.range_error_m) sum += e, squares += static_cast<double>(e) * e;
  const auto n = static_cast<double>(scan.range_error_m.size());
  EXPECT_NEAR(sum / n, 0, 0.0003);
  EXPECT_NEAR(std::sqrt(squares / n), 0.004, 0.0002);
}

TEST(VirtualScan, registration_moves_each_station_as_a_whole) {
  ScanOptions exact = ideal(), moved = ideal();
  moved.registration_error_m = 0.02;
  const VirtualScan a = scan_tree(pole(0.2, 3), nullptr, exact), b = scan_tree(pole(0.2, 3), nullptr, moved);
  ASSERT_EQ(a.cloud.size(), b.cloud.size());
  std::vector<Vec3> shift(4, Vec3::Constant(1e9));
  for (std::size_t i = 0; i < a.cloud.size(); ++i) {
    const Vec3 d = b.cloud.points[i] - a.cloud.points[i];
    Vec3& first = shift[a.station[i]];
    if (first.x() > 1e8) first = d;
    EXPECT_LT((d - first).norm(), 1e-9);
  }
  EXPECT_GT((shift[0] - shift[1]).norm(), 1e-4);
}

TEST(VirtualScan, a_wide_beam_mixes_ranges_at_edges) {
  ScanOptions options = ideal();
  options.rays_per_beam = 13;
  options.divergence_mrad = 4;
  options.range_resolution_m = 0.5;
  options.stations = 1;
  Tree tree = pole(0.05, 2);
  TreeNode behind;
  behind.start = Vec3(-0.3, -0.5, 0), behind.end = Vec3(-0.3, 0.5, 2), behind.radius = 0.2, behind.axis = 1;
  tree.add(behind);
  const VirtualScan scan = scan_tree(tree, nullptr, options);
  int mixed = 0, partial = 0;
  for (std::size_t i = 0; i < scan.cloud.size(); ++i) {
    mixed += std::abs(scan.range_error_m[i]) > 0.02F;
    partial += scan.cloud.intensity[i] < 0.999F;
  }
  EXPECT_GT(mixed, 20);
  EXPECT_GT(partial, 20);
}

TEST(VirtualScan, drop_outs_lose_their_share) {
  ScanOptions options = ideal();
  const auto all = static_cast<double>(scan_tree(pole(0.2, 3), nullptr, options).cloud.size());
  options.drop_out = 0.3;
  EXPECT_NEAR(static_cast<double>(scan_tree(pole(0.2, 3), nullptr, options).cloud.size()) / all, 0.7, 0.04);
}

TEST(VirtualScan, leaves_and_ground_are_told_apart_and_hide_what_is_behind) {
  const Tree tree = pole(0.1, 2);
  Foliage foliage;
  LeafShape square;
  square.name = "square";
  square.vertices = {{-0.5, 0, 0}, {0.5, 0, 0}, {0.5, 1, 0}, {-0.5, 1, 0}};
  square.triangles = {{0, 1, 2}, {0, 2, 3}};
  foliage.shapes.push_back(square);
  Leaf leaf;
  leaf.origin = Vec3(0.5, 0, 1);
  leaf.direction = Vec3::UnitZ();
  leaf.normal = Vec3::UnitX();
  leaf.length_m = 0.5;
  foliage.leaves.push_back(leaf);
  ScanOptions options = ideal();
  options.stations = 1;
  options.ground_radius_m = 3;
  const VirtualScan scan = scan_tree(tree, &foliage, options);
  int wood = 0, leaves = 0, ground = 0;
  for (std::size_t i = 0; i < scan.cloud.size(); ++i) {
    const auto what = static_cast<ScanClass>(scan.cloud.classification[i]);
    const Vec3& p = scan.cloud.points[i];
    wood += what == ScanClass::wood;
    leaves += what == ScanClass::leaf;
    ground += what == ScanClass::ground;
    EXPECT_EQ(what == ScanClass::wood, scan.node[i] >= 0);
    EXPECT_EQ(what == ScanClass::leaf, scan.leaf[i] == 0);
    if (what == ScanClass::leaf) {
      EXPECT_NEAR(p.x(), 0.5, 1e-5);
    }
    if (what == ScanClass::ground) {
      EXPECT_NEAR(p.z(), 0, 1e-5);
    }
    if (what == ScanClass::wood) {
      EXPECT_TRUE(p.z() < 1.05 || p.z() > 1.4) << p.z();  // behind the leaf
    }
  }
  EXPECT_GT(wood, 100);
  EXPECT_GT(leaves, 50);
  EXPECT_GT(ground, 100);
}

TEST(VirtualScan, ground_slopes_and_grass_stands_on_it) {
  ScanOptions options = ideal();
  options.stations = 2;  // uphill and downhill
  options.ground_radius_m = 4;
  options.ground_slope_deg = 20;
  options.grass_height_m = 0.3;
  const VirtualScan scan = scan_tree(pole(0.1, 3), nullptr, options);
  const double rise = std::tan(20 * std::numbers::pi / 180);
  for (const Vec3& position : scan.positions)
    EXPECT_NEAR(position.z(), rise * position.x() + options.instrument_height_m, 1e-9);
  double grass = 0, ground = 0, mean = 0;
  for (std::size_t i = 0; i < scan.cloud.size(); ++i) {
    const auto what = static_cast<ScanClass>(scan.cloud.classification[i]);
    const Vec3& p = scan.cloud.points[i];
    const double above = p.z() - rise * p.x();
    if (what == ScanClass::ground) {
      ++ground;
      ASSERT_NEAR(above, 0, 1e-5);
    } else if (what == ScanClass::grass) {
      ++grass;
      mean += above;
      ASSERT_GT(above, 0);
      ASSERT_LE(above, 0.3 + 1e-5);
    }
  }
  ASSERT_GT(ground, 500);
  EXPECT_NEAR(ground / (ground + grass), 0.25, 0.03);
  EXPECT_NEAR(mean / grass, 0.15, 0.02);
  // Grass hides the foot.
  const auto low_wood = [](const VirtualScan& of) {
    int count = 0;
    for (std::size_t i = 0; i < of.cloud.size(); ++i)
      count += of.node[i] >= 0 && of.cloud.points[i].z() < 0.15;
    return count;
  };
  options.grass_height_m = 0;
  EXPECT_LT(low_wood(scan), low_wood(scan_tree(pole(0.1, 3), nullptr, options)) / 2);
  options.grass_height_m = -1;
  EXPECT_THROW(options.validate(), InputError);
  options.grass_height_m = 0;
  options.ground_slope_deg = 80;
  EXPECT_THROW(options.validate(), InputError);
  options.ground_slope_deg = 0;
  options.instrument_height_m = -1;
  EXPECT_THROW(options.validate(), InputError);
  options.ground_radius_m.reset();
  EXPECT_NO_THROW(options.validate());
}

TEST(VirtualScan, is_the_same_for_any_number_of_threads_and_can_be_cancelled) {
  IgmParameters p = igm_preset("standard").parameters;
  p.cycles = 7;
  Tree tree = grow_igm(p).tree;
  tree.origin_shift = Vec3(500000, 4e6, 300);
  ScanOptions options;
  options.step_deg = 0.3;
  options.threads = 1;
  options.drop_out = 0.1;
  const VirtualScan one = scan_tree(tree, nullptr, options);
  options.threads = 3;
  const VirtualScan three = scan_tree(tree, nullptr, options);
  EXPECT_EQ(one.cloud.points, three.cloud.points);
  EXPECT_EQ(one.node, three.node);
  EXPECT_EQ(one.cloud.origin_shift, tree.origin_shift);
  options.seed = 2;
  EXPECT_NE(one.cloud.points, scan_tree(tree, nullptr, options).cloud.points);
  std::atomic<bool> cancel{true};
  Progress progress(&cancel);
  EXPECT_THROW(scan_tree(tree, nullptr, options, progress), Cancelled);
}

TEST(VirtualScan, refuses_bad_input) {
  EXPECT_THROW(scan_tree(Tree()), InputError);
  ScanOptions options;
  options.step_deg = 0;
  EXPECT_THROW(scan_tree(pole(0.1, 1), nullptr, options), InputError);
  options = ScanOptions();
  options.drop_out = 1;
  EXPECT_THROW(scan_tree(pole(0.1, 1), nullptr, options), InputError);
}

}  // namespace
}  // namespace dendrofit
