// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/image/carve.h"

#include "core/errors.h"
#include "recon/image/agreement.h"
#include "recon/image/foot.h"
#include "tests/support/photo_render.h"
#include "tests/support/tiny_trees.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

struct Scene {
  std::vector<Camera> cameras;
  std::vector<Outline> outlines;
};

/// Masks of a tree from a ring of small cameras.
Scene scene(const Tree& tree, int views, double turn_error_deg = 0) {
  const ViewSet set = test::photograph_ring(tree, {.views = views,
                                                   .width = 240,
                                                   .height = 360,
                                                   .focal_px = 300,
                                                   .turn_error_deg = turn_error_deg,
                                                   .render = {.photograph = false, .threads = 1}});
  Scene s;
  for (const View& view : set.views) {
    s.cameras.push_back(view.camera);
    s.outlines.emplace_back(view.photo.mask, view.photo.width, view.photo.height);
  }
  return s;
}

TEST(Outline, DistanceChangesSignMidwayBetweenPixels) {
  std::vector<std::uint8_t> mask(20 * 10, 0);
  for (int y = 0; y < 10; ++y)
    for (int x = 8; x < 12; ++x) mask[static_cast<std::size_t>(20 * y + x)] = 1;
  const Outline outline(mask, 20, 10);
  EXPECT_NEAR(outline.at({8, 5}), 0, 0.05);
  EXPECT_NEAR(outline.at({12, 5}), 0, 0.05);
  EXPECT_NEAR(outline.at({10, 5}), -1.5, 0.51);
  EXPECT_NEAR(outline.at({3, 5}), 5, 0.1);
  EXPECT_GT(outline.at({10, -40}), 39);
  EXPECT_TRUE(outline.touches_top());
  EXPECT_TRUE(outline.unknown({10, -1}));
  EXPECT_FALSE(outline.unknown({-1, 5}));
  EXPECT_EQ(outline.area_px(), 40U);
}

TEST(Outline, RefusesAMaskOfAnotherSize) {
  EXPECT_THROW(Outline(std::vector<std::uint8_t>(12), 5, 3), InputError);
}

TEST(Carve, ACylinderKeepsItsSurface) {
  const double radius = 0.15;
  Tree post;
  for (int i = 0; i < 4; ++i)
    post.add({.start = {0, 0, 0.5 * i}, .end = {0, 0, 0.5 * (i + 1)}, .parent = i - 1, .radius = radius});
  const Scene s = scene(post, 12);
  const Hull hull = carve(s.cameras, s.outlines, {.cell_m = 0.01, .tolerance_px = 0, .threads = 1});
  ASSERT_GT(hull.cells.size(), 1000U);
  // The skin's mean distance from the axis in the middle of the post, less half the skin, is the radius: the
  // area of the cross-section, and with it the volume, is right to 5 %.
  double sum = 0, count = 0, top = -1e9, bottom = 1e9;
  for (const Vec3& c : hull.cells) {
    top = std::max(top, c.z());
    bottom = std::min(bottom, c.z());
    if (c.z() < 0.5 || c.z() > 1.5) continue;
    sum += c.head<2>().norm();
    ++count;
    EXPECT_LT(c.head<2>().norm(), radius + 0.02);
  }
  EXPECT_NEAR(sum / count + 0.005, radius, 0.025 * radius);
  EXPECT_NEAR(top, 2, 0.03);
  // Cameras above the ground see the near side of the lower end: below it the space stays open a little.
  EXPECT_NEAR(bottom, 0, 0.12);
  const auto foot = foot_of_masks(s.cameras, s.outlines);
  ASSERT_TRUE(foot.has_value());
  EXPECT_NEAR(foot->position.z(), 0, 0.012);
  EXPECT_LT(foot->position.head<2>().norm(), 0.01);
  EXPECT_NEAR(foot->radius_m, radius, 0.01);
  EXPECT_EQ(foot->views, 12U);
}

TEST(Carve, TheSameForAnyNumberOfThreads) {
  const Scene s = scene(test::small_tree(), 6);
  const Hull one = carve(s.cameras, s.outlines, {.cell_m = 0.02, .threads = 1});
  const Hull three = carve(s.cameras, s.outlines, {.cell_m = 0.02, .threads = 3});
  EXPECT_EQ(one.cells, three.cells);
  EXPECT_EQ(one.misses, three.misses);
}

TEST(Carve, AHullTooLargeIsKeptInLargerCells) {
  const Scene s = scene(test::small_tree(), 4);
  const Hull fine = carve(s.cameras, s.outlines, {.cell_m = 0.02, .threads = 1});
  const Hull coarse = carve(s.cameras, s.outlines,
                            {.cell_m = 0.02, .most_cells = 1000, .most_coarse_cells = 1000, .threads = 1});
  const Hull twice = carve(s.cameras, s.outlines, {.cell_m = 0.02, .most_cells = 1000, .threads = 1});
  EXPECT_DOUBLE_EQ(fine.cell_m, 0.02);
  EXPECT_DOUBLE_EQ(twice.cell_m, 0.04);
  EXPECT_GE(coarse.cell_m, 0.08);
  EXPECT_LT(coarse.cells.size(), fine.cells.size() / 2);
  EXPECT_GT(coarse.cells.size(), 50U);
  const Bounds a = bounds_of(fine.cells), b = bounds_of(coarse.cells);
  EXPECT_LT((a.lo - b.lo).cwiseAbs().maxCoeff(), 1.5 * coarse.cell_m);
  EXPECT_LT((a.hi - b.hi).cwiseAbs().maxCoeff(), 1.5 * coarse.cell_m);
}

TEST(Carve, RefusesAnEmptyMaskAndOneView) {
  Scene s = scene(test::small_tree(), 3);
  s.outlines[1] = Outline(std::vector<std::uint8_t>(240 * 360, 0), 240, 360);
  EXPECT_THROW(carve(s.cameras, s.outlines, {}), InputError);
  s.cameras.resize(1);
  s.outlines.erase(s.outlines.begin() + 1, s.outlines.end());
  EXPECT_THROW(carve(s.cameras, s.outlines, {}), InputError);
}

TEST(Agreement, GoodPosesExplainTheMasks) {
  const Scene s = scene(test::small_tree(), 8);
  const Agreement a = agreement(s.cameras, s.outlines, {.cell_m = 0.015, .threads = 1});
  EXPECT_GT(a.least(), 0.95);
  EXPECT_TRUE(a.good());
}

TEST(Agreement, NamesTheViewWhosePoseIsOff) {
  Scene s = scene(test::small_tree(), 6);
  s.cameras[4].translation.x() += 0.5;  // of a tree 4 m tall
  const CarveOptions options{.cell_m = 0.015, .tolerance_px = 2, .threads = 1};
  EXPECT_FALSE(agreement(s.cameras, s.outlines, options).good());
  const auto odd = find_odd_views(s.cameras, s.outlines, options);
  ASSERT_EQ(odd.size(), 1U);
  EXPECT_EQ(odd[0].view, 4U);
  EXPECT_LT(odd[0].explained, 0.85);
}

TEST(Agreement, GoodViewsAreNotBlamed) {
  const Scene s = scene(test::small_tree(), 8);
  EXPECT_TRUE(find_odd_views(s.cameras, s.outlines, {.cell_m = 0.015, .threads = 1}).empty());
}

TEST(Agreement, NamesTwoMasksWithoutTheStem) {
  Scene s = scene(test::small_tree(), 12);
  for (const std::size_t v : {3, 7}) {
    std::vector<std::uint8_t> mask(240 * 360, 0);
    for (int y = 0; y < 180; ++y)
      for (int x = 0; x < 240; ++x) mask[static_cast<std::size_t>(240 * y + x)] = s.outlines[v].inside(x, y);
    s.outlines[v] = Outline(mask, 240, 360);
  }
  const auto odd = find_odd_views(s.cameras, s.outlines, {.cell_m = 0.015, .threads = 1});
  ASSERT_EQ(odd.size(), 2U);
  EXPECT_EQ(odd[0].view, 3U);
  EXPECT_EQ(odd[1].view, 7U);
  EXPECT_GT(odd[0].missing, 0.2);
}

}  // namespace
}  // namespace dendrofit
