// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/align_scans.h"

#include "core/random.h"
#include "recon/scan_order.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace dendrofit {
namespace {

constexpr double kNoise = 0.002;

struct Scanned {
  std::vector<Vec3> points;
  std::vector<std::uint32_t> stored;
  std::vector<std::uint16_t> scan_of;  // truth
  std::vector<Limb> limbs;
};

/// A stem and three branches, each scan's share of their points displaced by its shift. Scans stand evenly
/// around and see the sides that face them, with noise along their beams.
Scanned scanned(const std::vector<Vec3>& shifts) {
  Scanned s;
  Random random(5);
  struct Wood {
    Vec3 from, to;
    double radius;
  };
  const std::vector<Wood> woods = {{{0, 0, 0}, {0, 0, 3}, 0.08},
                                   {{0, 0, 1.5}, {2, 0, 2}, 0.03},
                                   {{0, 0, 2}, {-1.5, 1, 2.6}, 0.025},
                                   {{0, 0, 2.2}, {-0.5, -1.5, 2.9}, 0.03}};
  for (std::size_t w = 0; w < woods.size(); ++w) {
    Limb limb;
    limb.parent = w == 0 ? -1 : 0;
    limb.parent_node = w == 0 ? -1 : 20;
    for (int i = 0; i <= 40; ++i) {
      LimbNode node;
      node.centre = woods[w].from + (woods[w].to - woods[w].from) * i / 40.0;
      node.rough_radius_m = 1.05 * woods[w].radius;  // what misregistration makes of it
      limb.nodes.push_back(node);
    }
    s.limbs.push_back(limb);
  }
  for (std::size_t k = 0; k < shifts.size(); ++k) {
    const double azimuth = 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(shifts.size());
    const Vec3 view(std::cos(azimuth), std::sin(azimuth), 0);
    for (std::size_t w = 0; w < woods.size(); ++w) {
      const Vec3 run = (woods[w].to - woods[w].from).normalized();
      const Vec3 toward = (view - run * run.dot(view)).normalized(), side = run.cross(toward);
      for (LimbNode& node : s.limbs[w].nodes)
        for (int i = 0; i < 12; ++i) {
          const double across = random.uniform(-1, 1), front = std::sqrt(1 - across * across);
          node.points.push_back(static_cast<std::uint32_t>(s.points.size()));
          s.points.push_back(node.centre + woods[w].radius * (front * toward + across * side) +
                             kNoise * random.normal() * view + shifts[k]);
          s.scan_of.push_back(static_cast<std::uint16_t>(k));
        }
    }
  }
  s.stored.resize(s.points.size());
  std::iota(s.stored.begin(), s.stored.end(), 0U);
  return s;
}

const std::vector<Vec3> kShifts = {{0.004, -0.002, 0.003}, {-0.001, 0.005, -0.002}, {-0.004, -0.002, 0.001}};

TEST(AlignScans, the_order_in_the_file_tells_the_scans_apart) {
  const Scanned s = scanned(kShifts);
  const std::vector<std::uint16_t> found = scans_by_order(s.points, s.stored, s.limbs, kNoise);
  std::size_t right = 0;
  for (std::size_t i = 0; i < found.size(); ++i) right += found[i] == s.scan_of[i];
  EXPECT_GT(right, 0.99 * static_cast<double>(found.size()));
}

TEST(AlignScans, points_without_order_count_as_one_scan) {
  Scanned s = scanned(kShifts);
  Random random(9);
  for (std::size_t i = s.stored.size(); i-- > 1;)
    std::swap(s.stored[i], s.stored[static_cast<std::size_t>(random.uniform() * static_cast<double>(i + 1))]);
  const std::vector<std::uint16_t> found = scans_by_order(s.points, s.stored, s.limbs, kNoise);
  EXPECT_EQ(*std::max_element(found.begin(), found.end()), 0);
  EXPECT_TRUE(align_scans(s.points, s.stored, s.limbs, kNoise).empty());
}

TEST(AlignScans, scans_without_shifts_stay_where_they_are) {
  Scanned s = scanned({Vec3::Zero(), Vec3::Zero(), Vec3::Zero()});
  const std::vector<Vec3> before = s.points;
  EXPECT_TRUE(align_scans(s.points, s.stored, s.limbs, kNoise).empty());
  EXPECT_EQ(before, s.points);
}

TEST(AlignScans, shifts_that_rest_on_a_wrong_division_are_refused) {
  const Scanned s = scanned(kShifts);
  std::vector<std::uint16_t> wrong(s.scan_of.size());
  for (std::size_t i = 0; i < wrong.size(); ++i) wrong[i] = static_cast<std::uint16_t>(i % 3);
  EXPECT_FALSE(scan_shifts(s.points, s.scan_of, s.limbs, kNoise).empty());
  EXPECT_TRUE(scan_shifts(s.points, wrong, s.limbs, kNoise).empty());
}

TEST(AlignScans, a_single_scan_stays_where_it_is) {
  Scanned s = scanned({{0.004, 0, 0}});
  const std::vector<Vec3> before = s.points;
  EXPECT_TRUE(align_scans(s.points, s.stored, s.limbs, kNoise).empty());
  EXPECT_EQ(before, s.points);
}

TEST(AlignScans, shifts_come_out_to_a_fraction_of_the_noise) {
  Scanned s = scanned(kShifts);
  const std::vector<Vec3> found = align_scans(s.points, s.stored, s.limbs, kNoise);
  ASSERT_EQ(found.size(), kShifts.size());
  Vec3 mean_found = Vec3::Zero(), mean_true = Vec3::Zero();
  for (std::size_t k = 0; k < found.size(); ++k) {
    mean_found += found[k] / 3;
    mean_true += kShifts[k] / 3;
  }
  // Where all lie in common nobody can tell.
  for (std::size_t k = 0; k < found.size(); ++k)
    EXPECT_LT(((found[k] - mean_found) - (kShifts[k] - mean_true)).norm(), 0.0006) << k;
}

TEST(AlignScans, shells_moved_outwards_are_told_from_thicker_wood) {
  const double out = 0.003;
  std::vector<Vec3> shifts;
  for (int k = 0; k < 4; ++k)
    shifts.emplace_back(out * std::cos(0.5 * std::numbers::pi * k),
                        out * std::sin(0.5 * std::numbers::pi * k), 0);
  Scanned s = scanned(shifts);
  const auto mean_radius = [&] {
    double sum = 0, count = 0;
    for (const LimbNode& node : s.limbs.front().nodes)
      for (const std::uint32_t p : node.points) {
        sum += (s.points[p] - node.centre).head<2>().norm();
        count += 1;
      }
    return sum / count;
  };
  EXPECT_GT(mean_radius(), 0.082);
  align_scans(s.points, s.stored, s.limbs, kNoise);
  EXPECT_NEAR(mean_radius(), 0.08, 0.0005);
}

}  // namespace
}  // namespace dendrofit
