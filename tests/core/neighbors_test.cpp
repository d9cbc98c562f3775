// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/neighbors.h"

#include "core/random.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

std::vector<Vec3> random_points(std::size_t n) {
  Random random(11);
  std::vector<Vec3> points(n);
  for (Vec3& p : points) p = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(0, 5)};
  return points;
}

TEST(Neighbors, agrees_with_brute_force) {
  const auto points = random_points(500);
  const Neighbors tree(points);
  std::vector<Neighbor> found;
  for (std::size_t q = 0; q < points.size(); q += 25) {
    const Vec3 query = points[q] + Vec3(0.01, -0.02, 0.03);
    std::vector<std::pair<double, std::uint32_t>> all;
    for (std::uint32_t i = 0; i < points.size(); ++i) all.emplace_back((points[i] - query).squaredNorm(), i);
    std::sort(all.begin(), all.end());
    tree.nearest(query, 12, found);
    ASSERT_EQ(found.size(), 12u);
    for (std::size_t k = 0; k < found.size(); ++k) {
      EXPECT_EQ(found[k].index, all[k].second);
      EXPECT_NEAR(found[k].distance_squared, all[k].first, 1e-5);
    }
    tree.within(query, 0.4, found);
    const auto third = [](std::uint32_t i) { return i % 3 == 0; };
    const auto wanted = std::find_if(all.begin(), all.end(), [&](const auto& a) { return third(a.second); });
    const auto best = tree.nearest_where(query, 2, third);
    ASSERT_TRUE(best);
    EXPECT_EQ(best->index, wanted->second);
    EXPECT_FALSE(tree.nearest_where(query, 0.99 * std::sqrt(wanted->first), third));
    const auto expected =
        std::count_if(all.begin(), all.end(), [](const auto& a) { return a.first <= 0.16; });
    EXPECT_EQ(static_cast<long>(found.size()), expected);
    EXPECT_TRUE(std::is_sorted(found.begin(), found.end(), [](const Neighbor& a, const Neighbor& b) {
      return a.distance_squared < b.distance_squared;
    }));
  }
}

TEST(Neighbors, few_points_give_few_neighbours) {
  std::vector<Neighbor> found{{1, 2}};
  const Neighbors nothing({});
  nothing.nearest(Vec3::Zero(), 3, found);
  EXPECT_TRUE(found.empty());
  EXPECT_FALSE(nothing.nearest_where(Vec3::Zero(), 3, [](std::uint32_t) { return true; }));
  nothing.within(Vec3::Zero(), 3, found);
  EXPECT_TRUE(found.empty());
  const Neighbors one({Vec3(1, 0, 0)});
  one.nearest(Vec3::Zero(), 3, found);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_DOUBLE_EQ(found[0].distance_squared, 1);
}

}  // namespace
}  // namespace dendrofit
