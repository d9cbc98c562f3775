// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/foot.h"

#include "core/errors.h"
#include "tests/recon/hand_made_clouds.h"

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

std::vector<Foot> feet_of(const std::vector<Vec3>& points) {
  const PointGraph graph = neighbor_graph(points);
  const Ground none;
  const auto height =
      heights_above_foot(points, connected_parts(graph, std::vector<char>(points.size(), 1)), none);
  return find_feet(points, graph, height, none);
}

TEST(Foot, stands_under_the_stem) {
  const auto feet = feet_of(test::small_tree().points);
  ASSERT_EQ(feet.size(), 1u);
  EXPECT_NEAR(feet[0].position.head<2>().norm(), 0, 0.01);
  EXPECT_NEAR(feet[0].position.z(), 0, 0.01);
  EXPECT_NEAR(feet[0].diameter_m, 0.1, 0.015);
}

TEST(Foot, two_stems_have_two_feet_the_thicker_first) {
  PointCloud cloud = test::small_tree();
  test::add_wood(cloud, {2, 0, 0}, {2, 0.2, 3}, 0.08, 0.02, 0.008, 0.001);
  const auto feet = feet_of(cloud.points);
  ASSERT_EQ(feet.size(), 2u);
  EXPECT_NEAR(feet[0].position.x(), 2, 0.02);
  EXPECT_NEAR(feet[1].position.x(), 0, 0.02);
}

TEST(Foot, a_stem_seen_from_one_side_has_its_own_axis_and_thickness) {
  PointCloud cloud;
  test::add_wood(cloud, {0, 0, 0}, {0, 0, 4}, 0.1, 0.06, 0.01, 0.001, 0, 0.45);
  const auto feet = feet_of(cloud.points);
  ASSERT_EQ(feet.size(), 1u);
  EXPECT_NEAR(feet[0].position.head<2>().norm(), 0, 0.02);  // the points' mean lies 6 cm off
  EXPECT_NEAR(feet[0].diameter_m, 0.2, 0.02);
}

TEST(Foot, foliage_without_a_trunk_is_refused_with_the_reason) {
  Random random(9);
  std::vector<Vec3> points;
  for (int i = 0; i < 4000; ++i)
    points.push_back({random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), random.uniform(0, 6)});
  try {
    feet_of(points);
    FAIL() << "a ball of leaves got a stem";
  } catch (const SolverError& error) {
    EXPECT_NE(std::string(error.what()).find("no stem found"), std::string::npos);
  }
  EXPECT_THROW(feet_of({}), SolverError);
  EXPECT_THROW(feet_of({Vec3::Zero()}), SolverError);
}

}  // namespace
}  // namespace dendrofit
