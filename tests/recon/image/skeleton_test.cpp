// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/image/skeleton.h"

#include "core/errors.h"
#include "recon/image/distance.h"
#include "recon/image/thinning.h"
#include "tests/recon/image/drawn_silhouettes.h"

#include <array>
#include <numeric>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

using test::Drawing;

std::vector<std::size_t> tips(const PlaneSkeleton& s) {
  std::vector<char> bears(s.size(), 0);
  for (std::size_t i = 1; i < s.size(); ++i) bears[static_cast<std::size_t>(s.parent[i])] = 1;
  std::vector<std::size_t> ends;
  for (std::size_t i = 0; i < s.size(); ++i)
    if (!bears[i]) ends.push_back(i);
  return ends;
}

std::size_t node_near(const PlaneSkeleton& s, double x, double y) {
  std::size_t best = 0;
  for (std::size_t i = 1; i < s.size(); ++i)
    if ((s.px[i] - Eigen::Vector2d(x, y)).norm() < (s.px[best] - Eigen::Vector2d(x, y)).norm()) best = i;
  return best;
}

/// Whether the way from node `i` to the root passes within 5 px of (x, y).
bool passes(const PlaneSkeleton& s, std::size_t i, double x, double y) {
  for (auto k = static_cast<std::int32_t>(i); k >= 0; k = s.parent[static_cast<std::size_t>(k)])
    if ((s.px[static_cast<std::size_t>(k)] - Eigen::Vector2d(x, y)).norm() < 5) return true;
  return false;
}

TEST(Distance, is_exact_and_counts_the_outside_as_marked) {
  std::vector<std::uint8_t> marked(20 * 10, 1);
  marked[0] = 0;
  const auto d = distance_inside(marked, 20, 10);
  EXPECT_EQ(d[0], 0);
  EXPECT_NEAR(d[3 * 20 + 4], 5, 1e-5);
  EXPECT_NEAR(d[9 * 20 + 19], std::hypot(9, 19), 1e-4);
  EXPECT_GE(distance_inside(std::vector<std::uint8_t>(200, 1), 20, 10)[0], 20);
}

TEST(Thinning, leaves_lines_one_pixel_wide_and_keeps_holes_and_pieces) {
  Drawing drawing(120, 120);
  drawing.stroke(20, 20, 5, 100, 20, 5).stroke(100, 20, 5, 100, 100, 5).stroke(100, 100, 5, 20, 20, 5);
  drawing.stroke(20, 90, 3, 50, 90, 3);  // a piece of its own
  const auto lines = thin(drawing.silhouette.tree, 120, 120);
  int pixels = 0, ends = 0;
  for (int y = 1; y < 119; ++y)
    for (int x = 1; x < 119; ++x) {
      if (!lines[static_cast<std::size_t>(120 * y + x)]) continue;
      ++pixels;
      EXPECT_TRUE(drawing.silhouette.tree[drawing.silhouette.pixel(x, y)]);
      int around = 0;
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx)
          around += (dx || dy) && lines[static_cast<std::size_t>(120 * (y + dy) + x + dx)];
      EXPECT_LE(around, 4);
      ends += around == 1;
    }
  EXPECT_GT(pixels, 230);
  EXPECT_LT(pixels, 330);
  EXPECT_GE(ends, 2);  // the piece's; the triangle is closed (its corners may keep short ends)
  EXPECT_TRUE(thin(std::vector<std::uint8_t>(25, 0), 5, 5) == std::vector<std::uint8_t>(25, 0));
  EXPECT_EQ(std::accumulate(lines.begin(), lines.end(), 0) > 0, true);
  std::vector<std::uint8_t> dot(25, 0);
  dot[12] = 1;
  EXPECT_EQ(thin(dot, 5, 5), dot);
}

TEST(ImageSkeleton, finds_a_fork_with_its_radii) {
  const PlaneSkeleton s = skeletonise(test::drawn_fork().silhouette);
  EXPECT_EQ(tips(s).size(), 2u);
  EXPECT_NEAR(s.px[0].x(), 150, 1.5);
  EXPECT_NEAR(s.px[0].y(), 390, 2);
  for (const double y : {250.0, 300.0, 350.0}) {
    const std::size_t i = node_near(s, 150, y);
    EXPECT_NEAR(s.radius_px[i], 10, 0.5) << y;
    EXPECT_NEAR(s.px[i].x(), 150, 0.75) << y;
  }
  EXPECT_NEAR(s.radius_px[node_near(s, 102, 115)], 5.4, 0.4);
  EXPECT_TRUE(passes(s, node_near(s, 70, 60), 150, 300));
  for (std::size_t i = 1; i < s.size(); ++i) EXPECT_LT(s.parent[i], static_cast<std::int32_t>(i));
}

TEST(ImageSkeleton, measures_thin_lines_below_a_pixel) {
  Drawing drawing(200, 300);
  drawing.stroke(100, 290, 6, 100, 150, 6).stroke(100, 150, 4, 100, 20, 4);
  // A twig of 0.8 px radius, drawn by cover.
  Silhouette& s = drawing.silhouette;
  for (int x = 104; x < 180; ++x) {
    const std::array<float, 3> cover = {0.3f, 1.0f, 0.3f};
    for (int k = 0; k < 3; ++k) {
      s.tree[s.pixel(x, 99 + k)] = 1;
      s.cover[s.pixel(x, 99 + k)] = cover[static_cast<std::size_t>(k)];
    }
  }
  const PlaneSkeleton skeleton = skeletonise(s);
  EXPECT_NEAR(skeleton.radius_px[node_near(skeleton, 140, 100.5)], 0.8, 0.12);
}

TEST(ImageSkeleton, drops_spurs_and_keeps_twigs) {
  Drawing drawing = test::drawn_fork();
  drawing.stroke(155, 300, 2, 164, 300, 2);    // a bump on the bark
  drawing.stroke(155, 250, 2, 200, 240, 1.5);  // a twig
  const PlaneSkeleton s = skeletonise(drawing.silhouette);
  EXPECT_EQ(tips(s).size(), 3u);
  EXPECT_LT((s.px[node_near(s, 200, 240)] - Eigen::Vector2d(200, 240)).norm(), 3);
}

TEST(ImageSkeleton, joins_a_twig_over_a_gap_in_its_direction_only) {
  Drawing near = test::drawn_fork();
  near.erase(60, 95, 130, 102);  // 7 px, less than three radii
  const PlaneSkeleton joined = skeletonise(near.silhouette);
  EXPECT_EQ(joined.joined_pieces, 1u);
  EXPECT_EQ(joined.dropped_pieces, 0u);
  EXPECT_LT((joined.px[node_near(joined, 70, 60)] - Eigen::Vector2d(70, 60)).norm(), 6);
  EXPECT_EQ(std::count(joined.bridge.begin(), joined.bridge.end(), 1) > 0, true);
  Drawing aside = test::drawn_fork();
  aside.stroke(170, 320, 1, 200, 320, 1);  // ten pixels beside the stem, not going on from anything it has
  aside.stroke(30, 200, 2, 30, 150, 2);    // far off
  const PlaneSkeleton loose = skeletonise(aside.silhouette);
  EXPECT_GE(loose.dropped_pieces, 1u);
  EXPECT_GT(loose.dropped_share, 0);
}

TEST(ImageSkeleton, lets_branches_cross) {
  // Two boughs from a wide fork whose branches cross high up: each goes straight on.
  Drawing drawing(400, 500);
  drawing.stroke(200, 490, 12, 200, 400, 12);
  drawing.stroke(200, 400, 8, 100, 300, 6).stroke(200, 400, 8, 300, 300, 6);
  drawing.stroke(100, 300, 4, 280, 60, 3).stroke(300, 300, 4, 120, 60, 3);
  const PlaneSkeleton s = skeletonise(drawing.silhouette);
  EXPECT_EQ(s.crossings, 1u);
  EXPECT_EQ(tips(s).size(), 2u);
  EXPECT_TRUE(passes(s, node_near(s, 280, 60), 100, 300));
  EXPECT_FALSE(passes(s, node_near(s, 280, 60), 300, 300));
  EXPECT_TRUE(passes(s, node_near(s, 120, 60), 300, 300));
}

TEST(ImageSkeleton, cuts_loops_and_reaches_everything_once) {
  Drawing drawing(400, 500);
  drawing.stroke(200, 490, 12, 200, 400, 12);
  drawing.stroke(200, 400, 8, 100, 250, 6).stroke(200, 400, 8, 300, 250, 6);
  drawing.stroke(100, 250, 5, 200, 100, 3, false).stroke(300, 250, 5, 200, 100, 3);
  const PlaneSkeleton s = skeletonise(drawing.silhouette);
  EXPECT_LT((s.px[node_near(s, 150, 175)] - Eigen::Vector2d(150, 175)).norm(), 3);
  EXPECT_LT((s.px[node_near(s, 250, 175)] - Eigen::Vector2d(250, 175)).norm(), 3);
  EXPECT_EQ(s.dropped_pieces, 0u);
}

TEST(ImageSkeleton, stands_where_it_is_told) {
  const PlaneSkeleton s = skeletonise(test::drawn_fork().silhouette, {.root_px = Eigen::Vector2d(70, 60)});
  EXPECT_LT((s.px[0] - Eigen::Vector2d(70, 60)).norm(), 8);
}

TEST(ImageSkeleton, refuses_what_has_no_line) {
  Drawing empty(50, 50);
  EXPECT_THROW(skeletonise(empty.silhouette), SolverError);
  empty.stroke(25, 25, 0.6, 25, 25.5, 0.6);
  EXPECT_THROW(skeletonise(empty.silhouette), SolverError);
  EXPECT_THROW(skeletonise(test::drawn_fork().silhouette, {.gap_px = -1}), InputError);
}

}  // namespace
}  // namespace dendrofit
