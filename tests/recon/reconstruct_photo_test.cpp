// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/reconstruct_photo.h"

#include "core/errors.h"
#include "io/read_cameras.h"
#include "io/read_image.h"
#include "tests/recon/image/drawn_silhouettes.h"
#include "tests/support/shared_data.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dendrofit {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

Photograph masked(const Silhouette& silhouette) {
  Photograph photo;
  photo.name = "drawn";
  photo.width = silhouette.width;
  photo.height = silhouette.height;
  photo.rgb.assign(3 * silhouette.tree.size(), 200);
  photo.mask = silhouette.tree;
  return photo;
}

TEST(ReconstructPhoto, measures_what_a_drawing_holds) {
  // From row 390 to row 55: at 3.35 m a pixel is a centimetre.
  // Drawn flat: as from far away.
  ReconstructPhotoOptions options;
  options.height_m = 3.35;
  const Photograph photo = masked(test::drawn_fork().silhouette);
  Camera far;
  far.width = photo.width;
  far.height = photo.height;
  far.fx = far.fy = 20000;
  far.cx = 0.5 * photo.width;
  far.cy = 0.5 * photo.height;
  far.rotation << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  options.camera = far;
  const PhotoReconstruction r = reconstruct_photo(photo, options);
  ASSERT_TRUE(r.has_tree);
  EXPECT_NEAR(r.metrics.height_m, 3.35, 1e-6);
  EXPECT_NEAR(r.outline.width, 1.7, 0.05);
  ASSERT_TRUE(r.metrics.dbh_m);
  EXPECT_NEAR(*r.metrics.dbh_m, 0.2, 0.012);
  const Interval dbh = r.metrics.intervals.at("dbh_m");
  EXPECT_LT(dbh.lo, 0.2);
  EXPECT_GT(dbh.hi, 0.2);
  EXPECT_THAT(r.warnings, Contains(HasSubstr("Depth is invented")));
  EXPECT_NEAR(r.outline.lean_deg, 0, 3);
}

TEST(ReconstructPhoto, says_when_there_is_no_scale) {
  const PhotoReconstruction r = reconstruct_photo(masked(test::drawn_fork().silhouette));
  EXPECT_FALSE(r.metric);
  EXPECT_NEAR(r.outline.height, 1, 1e-6);
  EXPECT_FALSE(r.metrics.dbh_m);
  EXPECT_THAT(r.warnings, Contains("no scale: lengths in tree heights"));
}

TEST(ReconstructPhoto, gives_a_leafy_crown_its_outline_only) {
  test::Drawing leafy(400, 500);
  leafy.stroke(200, 460, 8, 200, 220, 8).stroke(200, 230, 110, 200, 200, 110);
  ReconstructPhotoOptions options;
  options.height_m = 10;
  const PhotoReconstruction r = reconstruct_photo(masked(leafy.silhouette), options);
  EXPECT_FALSE(r.has_tree);
  EXPECT_TRUE(r.tree.empty());
  EXPECT_NEAR(r.outline.height, 10, 1e-6);
  EXPECT_NEAR(r.outline.width, 10 * 220 / 370.0, 0.3);
  EXPECT_THAT(r.warnings, Contains(HasSubstr("crown looks leafy")));
}

TEST(ReconstructPhoto, holds_on_the_rendered_apple_with_mask_and_without) {
  const auto file = test::shared_data("images/p3_apple/v1/cameras.json");
  DENDROFIT_NEED(file);
  const ViewSet set = read_cameras_json(file);
  for (const bool mask : {true, false}) {
    View view = set.views.front();
    if (!mask) view.photo.mask.clear();
    ReconstructPhotoOptions options;
    options.camera = view.camera;
    options.metric_camera = true;
    const PhotoReconstruction r = reconstruct_photo(view.photo, options);
    ASSERT_TRUE(r.has_tree);
    // True height 6.317 m from 1.3 heights away: the interval covers.
    EXPECT_NEAR(r.metrics.height_m, 6.317, 0.07 * 6.317);
    EXPECT_LT(r.metrics.intervals.at("height_m").lo, 6.317);
    EXPECT_GT(r.metrics.intervals.at("height_m").hi, 6.317);
    ASSERT_TRUE(r.metrics.dbh_m);
    EXPECT_NEAR(*r.metrics.dbh_m, 0.186, 0.15 * 0.186);
    EXPECT_LT(r.metrics.intervals.at("dbh_m").lo, 0.186);
    EXPECT_GT(r.metrics.intervals.at("dbh_m").hi, 0.186);
    const Vec3 foot = set.origin_shift + r.tree.origin_shift;
    EXPECT_LT((foot - Vec3(1034.5, 2210.25, 64.1)).norm(), 0.6);
    double worst = 0;
    for (std::size_t i = 0; i < r.tree.size(); ++i)
      worst = std::max(
          worst, (*view.camera.project(r.tree.origin_shift + r.tree.end[i]) - r.skeleton.px[i + 1]).norm());
    EXPECT_LT(worst, 0.5);
    const PhotoReconstruction again = reconstruct_photo(view.photo, options);
    ASSERT_EQ(again.tree.size(), r.tree.size());
    for (std::size_t i = 0; i < r.tree.size(); ++i) ASSERT_EQ(again.tree.end[i], r.tree.end[i]);
  }
}

TEST(ReconstructPhoto, refuses_real_pictures_without_a_tree_and_warns_of_leaves) {
  const auto folder = test::shared_data("images/real");
  DENDROFIT_NEED(folder);
  for (const char* name : {"neg_storm_no_tree.jpg", "neg_dune_grass_no_tree.jpg"})
    EXPECT_THROW(reconstruct_photo(read_photograph(folder / name).photo), SolverError) << name;
  const PhotoReconstruction r = reconstruct_photo(read_photograph(folder / "trees_swellendam.png").photo);
  EXPECT_FALSE(r.has_tree);
  EXPECT_THAT(r.warnings, Contains(HasSubstr("2 trees")));
  EXPECT_THAT(r.warnings, Contains(HasSubstr("crown looks leafy")));
}

}  // namespace
}  // namespace dendrofit
