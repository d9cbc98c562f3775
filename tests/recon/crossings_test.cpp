// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/crossings.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

/// Sections in a row from `from` to `to`, about 3 cm apart, with one point each; returns the first one's
/// number.
std::int32_t add_run(std::vector<Section>& sections, std::int32_t parent, const Vec3& from, const Vec3& to) {
  const auto first = static_cast<std::int32_t>(sections.size());
  const double length = (to - from).norm();
  const int steps = static_cast<int>(std::lround(length / 0.03));
  for (int i = 0; i <= steps; ++i) {
    Section s;
    s.centre = from + (to - from) * (static_cast<double>(i) / steps);
    s.direction = (to - from) / length;
    s.radius_m = s.extent_m = 0.005;
    s.parent = i == 0 ? parent : static_cast<std::int32_t>(sections.size()) - 1;
    s.points = {static_cast<std::uint32_t>(sections.size())};
    sections.push_back(s);
  }
  return first;
}

struct Touching {
  std::vector<Section> sections;
  std::uint32_t end = 0, outer = 0;  // points of the branch's last section and of its outer part's first
};

/// A branch along x bears wood that goes on upwards from its middle, where a branch from below ends.
Touching touching(const Vec3& offset, double lean) {
  Touching t;
  const std::int32_t bearer = add_run(t.sections, -1, {-0.6, 0.01, 0}, {0.6, 0.01, 0});
  add_run(t.sections, -1, Vec3(0, 0, -0.5) + offset, Vec3(0, 0, -0.02) + offset);
  t.end = static_cast<std::uint32_t>(t.sections.size()) - 1;
  t.outer = static_cast<std::uint32_t>(add_run(t.sections, bearer + 20, {0, 0, 0.02}, {0.4 * lean, 0, 0.42}));
  return t;
}

bool holds(const std::vector<std::uint32_t>& points, std::uint32_t p) {
  return std::find(points.begin(), points.end(), p) != points.end();
}

TEST(Crossings, an_end_before_wood_that_goes_straight_on_is_its_door) {
  const Touching t = touching(Vec3::Zero(), 0);
  const std::vector<Gate> gates = gates_at_crossings(t.sections, 0.01);
  ASSERT_EQ(gates.size(), 1u);
  EXPECT_TRUE(holds(gates[0].door, t.end));
  EXPECT_TRUE(holds(gates[0].inside, t.outer));
  EXPECT_FALSE(holds(gates[0].inside, 20));  // the bearer
}

TEST(Crossings, ends_beside_or_askew_leave_everything_as_it_is) {
  EXPECT_TRUE(gates_at_crossings(touching({0.05, 0, 0}, 0).sections, 0.01).empty());
  EXPECT_TRUE(gates_at_crossings(touching(Vec3::Zero(), 1.2).sections, 0.01).empty());
  EXPECT_TRUE(gates_at_crossings(touching({0, 0, -0.2}, 0).sections, 0.01).empty());
}

TEST(Crossings, a_branch_and_its_own_side_shoot_are_no_crossing) {
  std::vector<Section> sections;
  const std::int32_t bearer = add_run(sections, -1, {-0.6, 0.01, 0}, {0.6, 0.01, 0});
  add_run(sections, bearer + 20, {0, 0, 0.02}, {0, 0, 0.42});
  EXPECT_TRUE(gates_at_crossings(sections, 0.01).empty());
  EXPECT_TRUE(gates_at_crossings({}, 0.01).empty());
}

}  // namespace
}  // namespace dendrofit
