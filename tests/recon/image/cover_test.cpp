// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/image/cover.h"

#include "tests/support/photo_render.h"

#include <cmath>
#include <cstdlib>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

constexpr double kFocal = 700, kAway = 8;  // pixels, metres

View photograph_of(const Tree& tree) {
  return test::render_view(tree, test::camera_at({0, -kAway, 1.6}, {0, 0, 2.2}, 500, 750, kFocal),
                           {.threads = 1});
}

std::int32_t add(Tree& tree, const Vec3& from, const Vec3& to, double radius, std::int32_t parent,
                 std::int32_t axis) {
  return tree.add({.start = from,
                   .end = to,
                   .parent = parent,
                   .radius = radius,
                   .axis = axis,
                   .order = axis == 0 ? 0 : 1});
}

/// A stem, and two thin shoots that rise side by side from a bough, their barks 2 cm (1.7 px) apart.
Tree stem_and_shoots() {
  Tree tree;
  const std::int32_t low = add(tree, {0, 0, 0}, {0, 0, 2.6}, 0.05, -1, 0);
  add(tree, {0, 0, 2.6}, {0, 0, 4.2}, 0.05, low, 0);
  const std::int32_t bough = add(tree, {0, 0, 2.6}, {0.56, 0, 2.8}, 0.03, low, 1);
  add(tree, {0.56, 0, 2.8}, {0.56, 0, 3.9}, 0.02, bough, 1);
  add(tree, {0.5, 0, 2.8}, {0.5, 0, 3.9}, 0.02, bough, 2);
  return tree;
}

/// Pixels a row's wood covers within `reach` of where a place at that row's height is seen.
double width_at(const Silhouette& s, const View& view, const Vec3& place, double reach) {
  const Eigen::Vector2d at = *view.camera.project(place);
  const int y = static_cast<int>(at.y());
  double sum = 0;
  for (int x = static_cast<int>(at.x() - reach); x <= static_cast<int>(at.x() + reach); ++x)
    if (s.tree[s.pixel(x, y)]) sum += s.cover[s.pixel(x, y)];
  return sum;
}

TEST(Cover, AddsUpToTheWoodsWidthBeforeTheSkyAndBelowTheHorizon) {
  View view = photograph_of(stem_and_shoots());
  view.photo.mask.clear();
  const Silhouette found = find_silhouette(view.photo);
  for (const double from : {0.5, 3.0}) {
    const double doubt = from < 1.6 ? 0.6 : 0.25;  // grass and bark are less even than the sky
    double sum = 0;
    int rows = 0;
    for (double z = from; z < from + 0.9; z += 0.03, ++rows) sum += width_at(found, view, {0, 0, z}, 14);
    EXPECT_NEAR(sum / rows, 2 * 0.05 * kFocal / kAway, doubt) << from;
  }
}

TEST(Cover, SharpenedWoodHasNoFilledGaps) {
  View view = photograph_of(stem_and_shoots());
  view.photo.mask.clear();
  const Silhouette found = find_silhouette(view.photo);
  const std::vector<std::uint8_t> sharp = sharpened(found);
  int filled = 0, open = 0, rows = 0;
  for (double z = 3.0; z < 3.8; z += 0.02, ++rows) {
    const Eigen::Vector2d left = *view.camera.project({0.5, 0, z}),
                          right = *view.camera.project({0.56, 0, z});
    const auto runs = [&](const std::vector<std::uint8_t>& mask) {
      int count = 0;
      bool before = false;
      for (int x = static_cast<int>(left.x()) - 4; x <= static_cast<int>(right.x()) + 4; ++x) {
        const bool here = mask[found.pixel(x, static_cast<int>(left.y()))] != 0;
        count += here && !before;
        before = here;
      }
      return count;
    };
    filled += runs(found.tree) == 1;
    open += runs(sharp) == 2;
  }
  EXPECT_GT(filled, rows / 3);
  EXPECT_GT(open, 9 * rows / 10);
}

TEST(Cover, AMaskStaysAsItIs) {
  View view = photograph_of(stem_and_shoots());
  const Silhouette found = find_silhouette(view.photo);
  EXPECT_EQ(sharpened(found), found.tree);
}

TEST(Boughs, ACrownFromBelowTheHorizonIsFollowedToTheFoot) {
  Tree tree;
  std::int32_t last = add(tree, {0, 0, 0}, {0, 0, 0.7}, 0.06, -1, 0);
  for (int k = 0; k < 4; ++k) {
    const double angle = 0.3 * (k - 1.5);
    const Vec3 fork(0, 0, 0.6), middle(1.2 * std::sin(angle), 0, 0.6 + 1.2 * std::cos(angle)),
        end(2.8 * std::sin(angle), 0, 0.6 + 2.8 * std::cos(angle));
    const std::int32_t bough = add(tree, fork, middle, 0.03, last, k + 1);
    add(tree, middle, end, 0.02, bough, k + 1);
  }
  View view = photograph_of(tree);
  const std::vector<std::uint8_t> truth = view.photo.mask;
  view.photo.mask.clear();
  const Silhouette found = find_silhouette(view.photo);
  ASSERT_TRUE(found.horizon_px.has_value());
  int wood = 0, hit = 0, wrong = 0, lowest = 0, true_lowest = 0;
  for (int y = static_cast<int>(*found.horizon_px); y < found.height; ++y)
    for (int x = 0; x < found.width; ++x) {
      const std::size_t p = found.pixel(x, y);
      const bool told = found.tree[p] && found.cover[p] >= 0.5F;
      wood += truth[p] != 0;
      hit += truth[p] && told;
      wrong += !truth[p] && told;
      if (told) lowest = y;
      if (truth[p]) true_lowest = y;
    }
  EXPECT_GT(hit, 0.9 * wood);
  EXPECT_LT(wrong, 0.15 * wood);
  EXPECT_NEAR(lowest, true_lowest, 6);
  for (const std::string& warning : found.warnings) ADD_FAILURE() << warning;
}

}  // namespace
}  // namespace dendrofit
