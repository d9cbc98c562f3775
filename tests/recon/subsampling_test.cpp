// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/subsampling.h"

#include "core/random.h"
#include "recon/intervals.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

/// A stem of 2 m and constant radius with its settled centre line; `seed` draws its noise.
struct Stem {
  std::vector<Vec3> points;
  std::vector<Limb> limbs{1};

  Stem(double radius, double noise, std::uint64_t seed) {
    Random random(seed);
    for (int i = 0; i <= 100; ++i) {
      LimbNode node;
      node.centre = {0, 0, 0.02 * i};
      node.along_m = 0.02 * i;
      node.rough_radius_m = node.radius_m = radius;
      for (int k = 0; k < 12; ++k) {
        const double a = random.uniform(0, 2 * std::numbers::pi);
        node.points.push_back(static_cast<std::uint32_t>(points.size()));
        const double r = radius + noise * random.normal();
        points.push_back({r * std::cos(a), r * std::sin(a), 0.02 * (i + random.uniform(-0.5, 0.5))});
      }
      limbs[0].nodes.push_back(std::move(node));
    }
    limbs[0].beyond_m = 2;
  }
  Sights sights() const { return look_at_limbs(points, limbs, {.noise_m = 0.004, .threads = 1}); }
};

SubsampleOptions options(double noise, std::uint64_t seed = 1) {
  return {.breast_z_m = 1.3, .seed = seed, .seeing = {.noise_m = noise, .threads = 1}};
}

TEST(Subsampling, tells_how_far_the_diameter_scatters_from_scan_to_scan) {
  constexpr double kNoise = 0.004;
  double sum = 0, square = 0, told = 0;
  constexpr int kScans = 40;
  for (int scan = 0; scan < kScans; ++scan) {
    const Stem stem(0.1, kNoise, static_cast<std::uint64_t>(scan) + 1);
    const auto slice = slice_diameter(stem.points, stem.limbs, 1.3, kNoise);
    ASSERT_TRUE(slice);
    sum += slice->diameter_m;
    square += slice->diameter_m * slice->diameter_m;
    told += std::pow(subsample(stem.points, stem.limbs, stem.sights(), options(kNoise)).dbh_m, 2);
  }
  const double scatter = std::sqrt(square / kScans - std::pow(sum / kScans, 2));
  told = std::sqrt(told / kScans);
  EXPECT_GT(told, 0.6 * scatter);
  EXPECT_LT(told, 1.7 * scatter);
}

TEST(Subsampling, more_noise_more_spread_and_the_same_seed_the_same) {
  const Stem fine(0.1, 0.001, 1), coarse(0.1, 0.01, 1);
  const SubsampleSpread a = subsample(fine.points, fine.limbs, fine.sights(), options(0.001)),
                        b = subsample(coarse.points, coarse.limbs, coarse.sights(), options(0.01));
  EXPECT_GT(b.dbh_m, 3 * a.dbh_m);
  EXPECT_GT(b.stem_share, 2 * a.stem_share);
  EXPECT_GT(a.stem_share, 0);
  EXPECT_LT(a.stem_share, 0.01);
  EXPECT_EQ(a.branch_share, 0);
  EXPECT_EQ(a.dbh_m, subsample(fine.points, fine.limbs, fine.sights(), options(0.001)).dbh_m);
  EXPECT_NE(a.dbh_m, subsample(fine.points, fine.limbs, fine.sights(), options(0.001, 2)).dbh_m);
}

TEST(Subsampling, nothing_seen_spreads_nothing) {
  const SubsampleSpread none = subsample({}, {}, {}, {});
  EXPECT_EQ(none.dbh_m + none.height_m + none.stem_share + none.branch_share, 0);
}

}  // namespace
}  // namespace dendrofit
