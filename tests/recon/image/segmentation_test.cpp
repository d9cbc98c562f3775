// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/image/segmentation.h"

#include "core/errors.h"
#include "core/random.h"
#include "recon/image/pieces.h"
#include "recon/image/sky.h"
#include "tests/recon/image/drawn_silhouettes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dendrofit {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// A sky that darkens upwards and to one side, grass below `horizon`, and a drawing in bark's colour before
/// both.
Photograph painted(const Silhouette& tree, int horizon, std::array<int, 3> bark = {80, 70, 62}) {
  Photograph photo;
  photo.name = "painted";
  photo.width = tree.width;
  photo.height = tree.height;
  photo.rgb.resize(3 * tree.tree.size());
  Random noise(5);
  for (int y = 0; y < photo.height; ++y)
    for (int x = 0; x < photo.width; ++x) {
      const double up = 1 - static_cast<double>(y) / photo.height,
                   side = static_cast<double>(x) / photo.width;
      std::array<double, 3> c = {215 - 70 * up * up - 15 * side, 225 - 45 * up * up - 10 * side,
                                 245 - 25 * up - 20 * side};
      if (y >= horizon) c = {96, 118, 70};
      const std::size_t p = photo.pixel(x, y);
      for (std::size_t k = 0; k < 3; ++k) {
        const double value = tree.tree[p] ? bark[k] : c[k];
        photo.rgb[3 * p + k] = static_cast<std::uint8_t>(std::clamp(value + 2 * noise.normal(), 0.0, 255.0));
      }
    }
  return photo;
}

/// A stem with a crown of crossing branches, 300 px wide, 480 px tall, its foot at row 460.
test::Drawing bare_tree(int width = 400, double shift = 0, double scale = 1) {
  test::Drawing drawing(width, 500);
  const auto stroke = [&](double x0, double y0, double r0, double x1, double y1, double r1) {
    drawing.stroke(shift + scale * x0, 460 - scale * (460 - y0), scale * r0, shift + scale * x1,
                   460 - scale * (460 - y1), scale * r1);
  };
  stroke(200, 460, 9, 200, 260, 8);
  for (int k = 0; k < 9; ++k) {
    const double angle = (k - 4) * 0.33, length = 200 - 12 * std::abs(k - 4);
    stroke(200, 265, 4, 200 + length * std::sin(angle), 265 - length * std::cos(angle), 1);
    const double x = 200 + 0.6 * length * std::sin(angle), y = 265 - 0.6 * length * std::cos(angle);
    stroke(x, y, 1.6, x + 50 * std::sin(angle + 0.7), y - 50 * std::cos(angle + 0.7), 0.8);
    stroke(x, y, 1.6, x + 50 * std::sin(angle - 0.7), y - 50 * std::cos(angle - 0.7), 0.8);
  }
  return drawing;
}

struct Agreement {
  double precision, recall;
};

Agreement compare(const Silhouette& found, const Silhouette& truth) {
  double both = 0, all_found = 0, all_truth = 0;
  for (std::size_t p = 0; p < truth.tree.size(); ++p) {
    both += found.tree[p] && truth.tree[p];
    all_found += found.tree[p];
    all_truth += truth.tree[p];
  }
  return {both / all_found, both / all_truth};
}

TEST(Segmentation, finds_a_tree_before_an_uneven_sky_and_down_to_its_foot) {
  const Silhouette truth = bare_tree().silhouette;
  const Silhouette found = find_silhouette(painted(truth, 380));
  const Agreement agreement = compare(found, truth);
  EXPECT_GT(agreement.precision, 0.93);
  EXPECT_GT(agreement.recall, 0.95);
  int lowest = 0;
  for (int y = 0; y < found.height; ++y)
    for (int x = 0; x < found.width; ++x)
      if (found.tree[found.pixel(x, y)]) lowest = y;
  EXPECT_NEAR(lowest, 459, 6);
  EXPECT_NEAR(found.horizon_px.value_or(0), 380, 4);
  EXPECT_GT(found.confidence, 0.5);
  EXPECT_FALSE(found.leafy);
  EXPECT_TRUE(found.warnings.empty()) << found.warnings.front();
}

TEST(Segmentation, takes_a_mask_as_it_is) {
  Photograph photo = painted(bare_tree().silhouette, 380);
  photo.mask = bare_tree().silhouette.tree;
  const Silhouette found = find_silhouette(photo);
  EXPECT_TRUE(found.from_mask);
  EXPECT_EQ(found.tree, photo.mask);
}

TEST(Segmentation, says_where_there_is_no_tree) {
  test::Drawing nothing(400, 500);
  EXPECT_THAT([&] { find_silhouette(painted(nothing.silhouette, 380)); },
              ThrowsMessage<SolverError>(HasSubstr("no tree found: nothing darker than the sky")));
  // Dry grass: dark in blue, bright to the eye.
  test::Drawing grass(400, 500);
  for (int k = 0; k < 15; ++k) grass.stroke(20 + 25 * k, 470, 4, 60 + 25 * k, 200 + 7 * k, 2);
  EXPECT_THAT(
      [&] {
        find_silhouette(painted(grass.silhouette, 380, {225, 190, 90}));
      },
      ThrowsMessage<SolverError>(HasSubstr("no tree found")));
  Photograph black = painted(nothing.silhouette, 0);
  std::fill(black.rgb.begin(), black.rgb.end(), 0);
  EXPECT_THROW(find_silhouette(black), SolverError);
}

TEST(Segmentation, counts_trees_and_takes_the_one_asked_for) {
  test::Drawing two = bare_tree(900, 0);
  const test::Drawing second = bare_tree(900, 560, 0.8);
  for (std::size_t p = 0; p < two.silhouette.tree.size(); ++p)
    if (second.silhouette.tree[p]) two.silhouette.tree[p] = 1;
  const Photograph photo = painted(two.silhouette, 380);
  const Silhouette larger = find_silhouette(photo);
  EXPECT_EQ(larger.tree_count, 2);
  EXPECT_THAT(larger.warnings, Contains(HasSubstr("2 trees: using the one at 200")));
  EXPECT_GT(compare(larger, bare_tree(900, 0).silhouette).recall, 0.9);
  const Silhouette other = find_silhouette(photo, {.root_px = Eigen::Vector2d(720, 455)});
  EXPECT_GT(compare(other, second.silhouette).recall, 0.85);  // its twigs are half a pixel thick
  EXPECT_GT(compare(other, second.silhouette).precision, 0.9);
}

TEST(Segmentation, tells_a_leafy_crown_and_borders) {
  test::Drawing leafy(400, 500);
  leafy.stroke(200, 460, 8, 200, 220, 8).stroke(200, 230, 110, 200, 200, 110);
  const Silhouette found = find_silhouette(painted(leafy.silhouette, 380));
  EXPECT_TRUE(found.leafy);
  EXPECT_THAT(found.warnings, Contains(HasSubstr("crown looks leafy")));
  test::Drawing tall(400, 500);
  tall.stroke(200, 460, 8, 200, -20, 4).stroke(200, 300, 4, 420, 100, 2).stroke(200, 300, 4, 80, 100, 2);
  Photograph photo = painted(tall.silhouette, 380);
  photo.mask = tall.silhouette.tree;
  const Silhouette cut = find_silhouette(photo);
  EXPECT_TRUE(cut.touches_top);
  EXPECT_TRUE(cut.touches_side);
  EXPECT_THAT(cut.warnings, Contains(HasSubstr("tree touches the top border: height is a lower bound")));
  EXPECT_THAT(cut.warnings, Contains(HasSubstr("right border")));
}

TEST(Segmentation, refuses_broken_photographs_and_options) {
  Photograph photo;
  EXPECT_THROW(find_silhouette(photo), InputError);
  const Photograph fine = painted(bare_tree().silhouette, 380);
  EXPECT_THROW(find_silhouette(fine, {.seed_ratio = 0.95}), InputError);
}

TEST(Sky, fits_through_a_tree_and_finds_the_horizon) {
  const auto sky = find_sky(painted(bare_tree().silhouette, 380));
  ASSERT_TRUE(sky);
  EXPECT_NEAR(sky->median_horizon, 380, 3);
  EXPECT_GT(sky->horizon_share, 0.9);
  double worst = 0;
  for (int y = 5; y < 370; y += 20)
    for (int x = 5; x < 60; x += 10)
      worst = std::max(worst, std::abs(sky->ratio[static_cast<std::size_t>(400 * y + x)] - 1.0));
  EXPECT_LT(worst, 0.05);
}

TEST(Pieces, are_grouped_over_gaps) {
  test::Drawing drawing(200, 100);
  drawing.stroke(10, 50, 2, 60, 50, 2, false)
      .stroke(64, 50, 2, 120, 50, 2, false)
      .stroke(150, 20, 2, 150, 80, 2, false);
  std::vector<std::int32_t> group;
  const auto groups = group_pieces(drawing.silhouette.tree, 200, 100, 6, group);
  ASSERT_EQ(groups.size(), 2u);
  EXPECT_GT(groups[0].pixels, groups[1].pixels);
  EXPECT_EQ(group[drawing.silhouette.pixel(20, 50)], group[drawing.silhouette.pixel(100, 50)]);
  EXPECT_EQ(group[drawing.silhouette.pixel(150, 50)], 1);
  EXPECT_EQ(group[0], -1);
}

}  // namespace
}  // namespace dendrofit
