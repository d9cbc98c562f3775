// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/radii.h"

#include "core/random.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

constexpr double kNoise = 0.004;

/// A straight limb along +x through `base`, seen from all sides or (as a scanner's even beams do) from -y
/// alone.
Limb straight_limb(std::vector<Vec3>& points, const Vec3& base, double radius, double length, bool one_side,
                   Random& random) {
  Limb limb;
  for (double x = 0; x <= length; x += 0.03) {
    LimbNode node;
    node.centre = base + Vec3(x, 0, 0);
    node.rough_radius_m = radius;
    for (int k = 0; k < 16; ++k) {
      const double turn = 2 * std::numbers::pi * random.uniform();
      const double across = 2 * random.uniform() - 1;
      const Vec3 on = one_side ? Vec3(0, -std::sqrt(1 - across * across), across)
                               : Vec3(0, std::cos(turn), std::sin(turn));
      const Vec3 jitter(random.normal(), random.normal(), random.normal());
      node.points.push_back(static_cast<std::uint32_t>(points.size()));
      points.push_back(node.centre + Vec3(0.03 * (random.uniform() - 0.5), 0, 0) + radius * on +
                       kNoise * jitter);
    }
    limb.nodes.push_back(std::move(node));
  }
  return limb;
}

/// Median radius found along side branches of one true radius on a stem that also bears thicker ones.
double median_found(double radius, bool one_side) {
  std::vector<Vec3> points;
  Random random(3);
  std::vector<Limb> limbs{straight_limb(points, {0, 0, 0}, 0.05, 3, one_side, random)};
  for (int k = 0; k < 12; ++k) {
    Limb limb = straight_limb(points, {0, 1.0 + k, 0}, k % 2 ? radius : 0.015, 1, one_side, random);
    limb.parent = 0;
    limb.parent_node = 8 * k;
    limbs.push_back(std::move(limb));
  }
  measure_lengths(limbs);
  const Sights sights = look_at_limbs(points, limbs, {.noise_m = kNoise, .threads = 1});
  settle_radii(limbs, sights, kNoise);
  std::vector<double> found;
  for (std::size_t l = 2; l < limbs.size(); l += 2)
    for (std::size_t i = 3; i + 8 < limbs[l].nodes.size(); ++i) found.push_back(limbs[l].nodes[i].radius_m);
  std::sort(found.begin(), found.end());
  return found[found.size() / 2];
}

TEST(Radii, twigs_little_thicker_than_the_noise_are_not_widened_by_it) {
  EXPECT_NEAR(median_found(0.006, false), 0.006, 0.0006);
}

TEST(Radii, a_side_that_nobody_saw_does_not_thin_the_twigs) {
  EXPECT_NEAR(median_found(0.007, true), 0.007, 0.001);
}

/// A limb along +x through `base` as four stations see it whose beams are `beam` in radius: each is recorded
/// at its own middle, beside the wood where it grazes it.
Limb limb_in_wide_beams(std::vector<Vec3>& points, const Vec3& base, double radius, double beam, double noise,
                        Random& random) {
  Limb limb;
  for (double x = 0; x <= 2; x += 0.03) {
    LimbNode node;
    node.centre = base + Vec3(x, 0, 0);
    node.rough_radius_m = radius;
    for (int k = 0; k < 24; ++k) {
      const double across = (radius + beam) * random.uniform(-1, 1);
      const double depth =
          std::sqrt(std::max(0.0, radius * radius - across * across)) + noise * random.normal();
      const double turn = 0.5 * std::numbers::pi * (k % 4);
      node.points.push_back(static_cast<std::uint32_t>(points.size()));
      points.push_back(node.centre + Vec3(0.03 * (random.uniform() - 0.5),
                                          across * std::cos(turn) - depth * std::sin(turn),
                                          across * std::sin(turn) + depth * std::cos(turn)));
    }
    limb.nodes.push_back(std::move(node));
  }
  return limb;
}

TEST(Radii, wide_beams_do_not_thicken_branches) {
  constexpr double kBeam = 0.008, kThin = 0.016, kSpread = 0.0035;
  std::vector<Vec3> points;
  Random random(5);
  std::vector<Limb> limbs{limb_in_wide_beams(points, {0, 0, 0}, 0.05, kBeam, 0.001, random)};
  for (int k = 1; k < 5; ++k) {
    Limb limb = limb_in_wide_beams(points, {0, 1.0 * k, 0}, k % 2 ? kThin : 0.05, kBeam, 0.001, random);
    limb.parent = 0;
    limb.parent_node = 10 * k;
    limbs.push_back(std::move(limb));
  }
  measure_lengths(limbs);
  const Sights sights = look_at_limbs(points, limbs, {.noise_m = kSpread, .threads = 1});
  settle_radii(limbs, sights, kSpread);
  std::vector<double> found;
  for (const LimbNode& node : limbs[1].nodes) found.push_back(node.seen_radius_m);
  std::sort(found.begin(), found.end());
  EXPECT_NEAR(found[found.size() / 2], kThin, 0.0005);
}

TEST(Radii, leaves_about_twigs_are_half_of_what_they_show_beyond_thick_wood) {
  std::vector<Limb> limbs(2);
  for (int k = 0; k < 40; ++k) {
    LimbNode node;
    node.centre = Vec3(0.03 * k, 0, 0);
    limbs[0].nodes.push_back(node);
    if (k < 10) limbs[1].nodes.push_back(node);
  }
  limbs[1].parent = 0;
  limbs[1].parent_node = 20;
  measure_lengths(limbs);
  Sights sights(2);
  for (const LimbNode& node : limbs[0].nodes) {
    Sight s;
    s.centre = node.centre;
    s.circle = {.ok = true, .radius = 0.05, .rms = 0.002, .coverage = 0.45};
    sights[0].push_back(s);
  }
  for (std::size_t k = 0; k < limbs[1].nodes.size(); ++k) {
    Sight s;
    s.spread = {.square = 2 * 0.003 * 0.003 + 1.5 * 0.0015 * 0.0015, .count = 9};
    sights[1].push_back(s);
  }
  for (int more = 0; more < 3; ++more) {
    limbs.push_back(Limb(limbs[1]));
    sights.push_back(std::vector<Sight>(sights[1]));
  }
  EXPECT_NEAR(scan_noise(limbs, sights, 0.01), 0.003, 1e-6);
  EXPECT_NEAR(scan_noise(limbs, sights, 0.01, {.in_leaf = true}), std::sqrt((9e-6 + 4e-6) / 2), 1e-6);
}

TEST(Radii, twig_diameter_bounds_the_tips) {
  std::vector<Vec3> points;
  Random random(4);
  std::vector<Limb> limbs{straight_limb(points, {0, 0, 0}, 0.02, 1, false, random)};
  for (std::size_t i = 20; i < limbs[0].nodes.size(); ++i) limbs[0].nodes[i].points.clear();
  measure_lengths(limbs);
  const Sights sights = look_at_limbs(points, limbs, {.noise_m = kNoise, .threads = 1});
  settle_radii(limbs, sights, kNoise, {.twig_diameter_m = 0.008});
  for (const LimbNode& node : limbs[0].nodes) EXPECT_GE(node.radius_m, 0.004 - 1e-9);
}

}  // namespace
}  // namespace dendrofit
