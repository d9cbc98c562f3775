// SPDX-License-Identifier: GPL-3.0-or-later
#include "forward/leaves/measured_profile.h"

#include "core/errors.h"
#include "forward/leaves/insert_leaves.h"
#include "tests/leaves/bushes.h"

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

using test::bush;

TEST(MeasuredHeights, OfOneTreeAreMetOnAnother) {
  // Leaf points in the upper third only, the nearest of them many times over, in other coordinates than the
  // tree's.
  Tree scanned = bush();
  scanned.origin_shift = Vec3(1000, 2000, 300);
  PointCloud cloud;
  cloud.origin_shift = Vec3(990, 1990, 290);
  double top = 0;
  for (const Vec3& end : scanned.end) top = std::max(top, end.z());
  for (int k = 0; k < 200; ++k)
    cloud.points.emplace_back(10 + 0.05 * (k % 20), 10 + 0.05 * (k / 20), 10 + top * (2 + k / 200.0) / 3);
  for (int k = 0; k < 5000; ++k) cloud.points.emplace_back(10.01, 10.01, 10 + 0.01 * top);
  const UnitDistribution heights = measured_heights(cloud, scanned);
  ASSERT_EQ(heights.table.size(), 25U);
  const TabulatedLaw law(heights);
  EXPECT_NEAR(law.cdf(0.6), 0.05 * 0.6 + 0.95 / 201, 0.005);
  LeafOptions options;
  options.count = 400;
  options.profile.height = heights;
  const LeafResult result = insert_leaves(bush(), options);
  int above = 0;
  for (const Leaf& leaf : result.foliage.leaves) above += leaf.petiole_foot.z() > 0.6 * top;
  EXPECT_GT(above, 340);
  EXPECT_THROW(measured_heights(PointCloud{}, scanned), InputError);
  EXPECT_THROW(measured_heights(cloud, Tree{}), InputError);
}

}  // namespace
}  // namespace dendrofit
