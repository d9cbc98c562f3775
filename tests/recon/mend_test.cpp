// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/mend.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

constexpr double kSpacing = 0.01;

/// Sections of wood, each with a ring of points.
struct Wood {
  std::vector<Vec3> points;
  std::vector<Section> sections;

  std::int32_t add(std::int32_t parent, const Vec3& centre, const Vec3& direction, double radius) {
    Section s;
    s.parent = parent;
    s.centre = centre;
    s.direction = direction.normalized();
    s.radius_m = s.extent_m = radius;
    for (int k = 0; k < 12; ++k) {
      s.points.push_back(static_cast<std::uint32_t>(points.size()));
      points.push_back(centre + radius * Vec3(std::cos(0.5 * k), std::sin(0.5 * k), 0));
    }
    sections.push_back(std::move(s));
    return static_cast<std::int32_t>(sections.size()) - 1;
  }
};

/// A stem 6 cm in radius that ends half a metre up; its upper part, reached from the side by a twig.
Wood cut_stem(double upper_x, std::int32_t& end, std::int32_t& upper) {
  Wood wood;
  end = -1;
  for (int k = 0; k <= 5; ++k) end = wood.add(end, {0, 0, 0.1 * k}, {0, 0, 1}, 0.06);
  std::int32_t twig = end;
  for (int k = 1; k <= 6; ++k) twig = wood.add(twig, {upper_x + 0.15, 0, 0.5 + 0.11 * k}, {0, 0, 1}, 0.008);
  upper = wood.add(twig, {upper_x, 0, 1.22}, {-1, 0, 0.1}, 0.04);
  std::int32_t on = upper;
  for (int k = 1; k <= 6; ++k) on = wood.add(on, {upper_x, 0, 1.22 + 0.08 * k}, {0, 0, 1}, 0.04);
  return wood;
}

bool joins(const Wood& wood, const std::vector<Bridge>& bridges, std::int32_t a, std::int32_t b) {
  const auto has = [&](std::int32_t s, std::uint32_t p) {
    const auto& members = wood.sections[static_cast<std::size_t>(s)].points;
    return std::find(members.begin(), members.end(), p) != members.end();
  };
  return std::any_of(bridges.begin(), bridges.end(),
                     [&](const Bridge& bridge) { return has(a, bridge.a) && has(b, bridge.b); });
}

TEST(Mend, a_stem_goes_on_straight_ahead_although_its_upper_part_was_entered_from_the_side) {
  std::int32_t end = 0, upper = 0;
  const Wood wood = cut_stem(0, end, upper);
  const auto bridges = mend_cut_branches(wood.points, wood.sections, kSpacing, 1.5);
  EXPECT_TRUE(joins(wood, bridges, end, upper));
}

TEST(Mend, what_stands_aside_is_another_stem) {
  std::int32_t end = 0, upper = 0;
  const Wood wood = cut_stem(0.3, end, upper);
  const auto bridges = mend_cut_branches(wood.points, wood.sections, kSpacing, 1.5);
  EXPECT_FALSE(joins(wood, bridges, end, upper));
}

TEST(Mend, nothing_of_nothing) {
  EXPECT_TRUE(mend_cut_branches({}, {}, kSpacing, 1.5).empty());
}

}  // namespace
}  // namespace dendrofit
