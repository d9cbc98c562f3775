// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/section_course.h"

#include "tests/recon/hand_made_clouds.h"

#include <numeric>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

std::optional<CoursePlace> go_on(const PointCloud& cloud, const Section& from) {
  std::vector<std::uint32_t> members(cloud.size());
  std::iota(members.begin(), members.end(), 0u);
  return next_on_course(cloud.points, members, from, 0.008);
}

Section upright(double radius) {
  Section s;
  s.centre = {0, 0, 0};
  s.radius_m = radius;
  return s;
}

TEST(SectionCourse, a_strip_of_the_surface_keeps_the_course) {
  PointCloud cloud;
  test::add_wood(cloud, {0, 0, 0.05}, {0, 0, 0.1}, 0.08, 0.08, 0.008, 0.001, 0.1, 0.3);
  const auto next = go_on(cloud, upright(0.08));
  ASSERT_TRUE(next.has_value());
  EXPECT_NEAR(next->radius_m, 0.08, 0.003);
  EXPECT_LT(next->centre.head<2>().norm(), 0.006);
  EXPECT_NEAR(next->centre.z(), 0.075, 0.01);
}

TEST(SectionCourse, a_whole_thinner_circle_is_followed_beside_the_course) {
  // Beyond a fork: the limb leaves the axis by 4 cm and is half as thick; its far side still touches the
  // forecast.
  PointCloud cloud;
  test::add_wood(cloud, {0.04, 0, 0.05}, {0.044, 0, 0.1}, 0.042, 0.041, 0.008, 0.001);
  const auto next = go_on(cloud, upright(0.08));
  ASSERT_TRUE(next.has_value());
  EXPECT_NEAR(next->radius_m, 0.0415, 0.003);
  EXPECT_NEAR(next->centre.x(), 0.042, 0.004);
}

TEST(SectionCourse, points_off_the_course_give_none) {
  PointCloud cloud;
  test::add_wood(cloud, {0.3, 0, 0.05}, {0.3, 0, 0.1}, 0.01, 0.01, 0.008);
  EXPECT_FALSE(go_on(cloud, upright(0.08)).has_value());
  EXPECT_FALSE(go_on({}, upright(0.08)).has_value());
}

}  // namespace
}  // namespace dendrofit
