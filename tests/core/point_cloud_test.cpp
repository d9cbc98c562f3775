// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/point_cloud.h"

#include "core/errors.h"

#include <limits>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

PointCloud three_points() {
  PointCloud cloud;
  cloud.origin_shift = {500000, 5000000, 100};
  cloud.points = {{0, 0, 0}, {1, 2, 3}, {-1, 0, 5}};
  cloud.intensity = {1, 2, 3};
  cloud.classification = {2, 4, 5};
  return cloud;
}

TEST(PointCloud, subset_takes_attributes_along) {
  const PointCloud part = three_points().subset({1, 0, 1});
  EXPECT_EQ(part.size(), 2u);
  EXPECT_EQ(part.origin_shift.x(), 500000);
  EXPECT_EQ(part.intensity, (std::vector<float>{1, 3}));
  EXPECT_EQ(part.classification, (std::vector<std::uint8_t>{2, 5}));
}

TEST(PointCloud, validate_finds_what_is_broken) {
  PointCloud cloud = three_points();
  EXPECT_NO_THROW(cloud.validate());
  cloud.intensity.pop_back();
  EXPECT_THROW(cloud.validate(), InputError);
  cloud = three_points();
  cloud.points[1].z() = std::numeric_limits<double>::infinity();
  EXPECT_THROW(cloud.validate(), InputError);
  cloud = three_points();
  cloud.classification.push_back(0);
  EXPECT_THROW(cloud.validate(), InputError);
}

TEST(PointCloud, bounds) {
  EXPECT_TRUE(bounds_of({}).empty());
  const Bounds box = bounds_of(three_points().points);
  EXPECT_EQ(box.lo, Vec3(-1, 0, 0));
  EXPECT_EQ(box.size(), Vec3(2, 2, 5));
}

}  // namespace
}  // namespace dendrofit
