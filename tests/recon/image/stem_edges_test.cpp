// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/image/stem_edges.h"

#include "core/random.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

/// A stem that tapers and leans, its left half lit almost as brightly as the mottled grass beside it; from
/// row 100 to 160 what is behind has the bark's colours. A branch as thick as a third of the stem runs
/// beside its right edge, six pixels away.
struct Scene {
  Photograph photo;
  static double left(int row) { return 140 - 0.05 * row - 0.02 * row; }
  static double right(int row) { return 180 - 0.05 * row + 0.02 * row; }

  Scene() {
    photo.name = "scene";
    photo.width = 400;
    photo.height = 400;
    photo.rgb.resize(3 * 400 * 400);
    Random random(3);
    for (int y = 0; y < 400; ++y)
      for (int x = 0; x < 400; ++x) {
        const double middle = 0.5 * (left(y) + right(y));
        const bool branch = x >= right(y) + 6 && x < right(y) + 20 && y > 250;
        const bool stem = (x + 0.5 >= left(y) && x + 0.5 < right(y)) || branch || (y >= 100 && y < 160);
        const bool lit = stem && x < middle;
        const Eigen::Vector3d colour = lit    ? Eigen::Vector3d(176, 170, 164)
                                       : stem ? Eigen::Vector3d(120, 114, 108)
                                              : Eigen::Vector3d(164, 176, 146);
        for (std::size_t k = 0; k < 3; ++k)
          photo.rgb[3 * photo.pixel(x, y) + k] = static_cast<std::uint8_t>(
              std::clamp(colour[static_cast<Eigen::Index>(k)] + 3 * random.normal(), 0.0, 255.0));
      }
  }
};

TEST(StemEdges, are_found_where_half_the_stem_is_lit_like_the_grass) {
  const Scene scene;
  const StemSurroundings surroundings(scene.photo, 0, 400, 0, 400);
  // As GrabCut leaves them: half of what is lit is lost.
  std::vector<StemRow> rows;
  for (int y = 0; y < 400; ++y)
    rows.push_back({y, static_cast<int>(0.5 * (Scene::left(y) + Scene::right(y))) - 12,
                    static_cast<int>(Scene::right(y)) - 1});
  surroundings.settle(rows);
  ASSERT_EQ(rows.size(), 400u);
  double worst = 0;
  for (const StemRow& row : rows) {
    if (row.row > 90 && row.row < 170) continue;  // nothing tells them apart there
    worst = std::max(
        {worst, std::abs(row.first - Scene::left(row.row)), std::abs(row.last + 1 - Scene::right(row.row))});
  }
  EXPECT_LT(worst, 2.5);
}

TEST(StemEdges, say_nothing_where_what_is_behind_looks_alike) {
  const Scene scene;
  const StemSurroundings surroundings(scene.photo, 0, 400, 0, 400);
  const auto seen = surroundings.row_of(50, 158, 40);
  ASSERT_TRUE(seen);
  EXPECT_NEAR(seen->first, Scene::left(50), 2.5);
  EXPECT_NEAR(seen->last + 1, Scene::right(50), 2.5);
  EXPECT_FALSE(surroundings.row_of(130, 153, 40));
  EXPECT_FALSE(surroundings.row_of(399, 500, 40));
  std::vector<StemRow> none;
  surroundings.settle(none);
  EXPECT_TRUE(none.empty());
}

}  // namespace
}  // namespace dendrofit
