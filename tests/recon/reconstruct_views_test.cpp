// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/reconstruct_views.h"

#include "core/errors.h"
#include "recon/image/scale.h"
#include "tests/support/photo_render.h"

#include <cmath>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dendrofit {
namespace {

using testing::HasSubstr;

test::RingOptions small_ring(int views) {
  return {.views = views,
          .width = 400,
          .height = 600,
          .focal_px = 500,
          .render = {.photograph = false, .threads = 1}};
}

/// A stem of 4 m with two rising branches of 1.5 m and a twig of 0.6 m.
Tree young_tree() {
  Tree tree;
  for (int i = 0; i < 8; ++i)
    tree.add(
        {.start = {0, 0, 0.5 * i}, .end = {0, 0, 0.5 * (i + 1)}, .parent = i - 1, .radius = 0.1 - 0.01 * i});
  const auto branch = [&](std::int32_t parent, Vec3 from, const Vec3& step, int pieces, double radius,
                          std::int32_t axis, std::int32_t order) {
    for (int k = 0; k < pieces; ++k, from += step)
      parent = tree.add({.start = from,
                         .end = from + step,
                         .parent = parent,
                         .radius = radius * (1 - 0.1 * k),
                         .axis = axis,
                         .order = order});
    return parent;
  };
  const std::int32_t first = branch(3, {0, 0, 1.8}, {0.22, 0.05, 0.2}, 5, 0.035, 1, 1);
  branch(5, {0, 0, 2.7}, {-0.1, -0.2, 0.2}, 5, 0.03, 2, 1);
  branch(first - 2, {0.66, 0.15, 2.4}, {-0.02, 0.14, 0.14}, 3, 0.018, 3, 2);
  return tree;
}

std::string message_of(const ViewSet& set) {
  try {
    reconstruct_views(set);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no InputError";
}

TEST(ReconstructViews, ASmallTreeComesBackWithItsMeasures) {
  const Tree truth = young_tree();
  ViewsOptions options;
  options.cloud.threads = 1;
  const ViewsReconstruction result = reconstruct_views(test::photograph_ring(truth, small_ring(10)), options);
  result.model.tree.validate();
  EXPECT_NEAR(result.model.metrics.height_m, 4, 0.04);
  ASSERT_TRUE(result.model.metrics.dbh_m.has_value());
  EXPECT_NEAR(*result.model.metrics.dbh_m, 2 * 0.079, 0.008);
  double branch = 0;
  for (std::size_t i = 0; i < result.model.tree.size(); ++i)
    if (result.model.tree.order[i] > 0) branch += result.model.tree.length(i);
  EXPECT_NEAR(branch, 1.5 + 1.5 + 0.6, 0.35);
  for (const ViewQuality& view : result.views) {
    EXPECT_TRUE(view.used);
    EXPECT_GT(view.explained_share, 0.9);
    EXPECT_GT(view.covered_share, 0.85);
    EXPECT_LT(view.offset_px, 0.7);
  }
  EXPECT_FALSE(result.poses_refined);
}

TEST(ReconstructViews, TheSameTreeForAnyNumberOfThreads) {
  const ViewSet set = test::photograph_ring(young_tree(), small_ring(5));
  ViewsOptions one, two;
  one.cloud.threads = 1;
  two.cloud.threads = 2;
  const Tree a = reconstruct_views(set, one).model.tree, b = reconstruct_views(set, two).model.tree;
  EXPECT_EQ(a.end, b.end);
  EXPECT_EQ(a.radius, b.radius);
  EXPECT_EQ(a.parent, b.parent);
}

TEST(ReconstructViews, AViewInTheWrongPlaceIsNamedAndLeftOut) {
  ViewSet set = test::photograph_ring(young_tree(), small_ring(8));
  set.views[3].camera.translation.x() += 0.4;
  ViewsOptions options;
  options.cloud.threads = 1;
  const ViewsReconstruction result = reconstruct_views(set, options);
  EXPECT_FALSE(result.views[3].used);
  EXPECT_TRUE(result.views[2].used);
  EXPECT_THAT(result.model.warnings, testing::Contains(HasSubstr("view 3 (view_03) contradicts the others")));
  EXPECT_NEAR(result.model.metrics.height_m, 4, 0.06);
}

TEST(ReconstructViews, AViewThatLostTheStemCostsNoHeight) {
  ViewSet set = test::photograph_ring(young_tree(), small_ring(10));
  for (const std::size_t lost : {2U, 7U}) {
    Photograph& photo = set.views[lost].photo;
    const auto from = static_cast<std::size_t>(0.7 * photo.height) * static_cast<std::size_t>(photo.width);
    std::fill(photo.mask.begin() + static_cast<std::ptrdiff_t>(from), photo.mask.end(), 0);
  }
  const ViewsReconstruction result = reconstruct_views(set, {.cloud = {.threads = 1}});
  EXPECT_NEAR(result.model.metrics.height_m, 4, 0.05);
  ASSERT_TRUE(result.model.metrics.dbh_m.has_value());
  EXPECT_NEAR(*result.model.metrics.dbh_m, 2 * 0.079, 0.008);
  EXPECT_TRUE(result.views[2].used);
  EXPECT_THAT(result.model.warnings,
              testing::Contains(testing::AllOf(HasSubstr("the stem is lost"), HasSubstr("view 2"),
                                               HasSubstr("view 7"), testing::Not(HasSubstr("view 3")))));
}

TEST(ReconstructViews, ViewsFromOnePlaceAreRefused) {
  ViewSet set = test::photograph_ring(young_tree(), small_ring(2));
  set.views[1] = set.views[0];
  EXPECT_THAT(message_of(set), HasSubstr("pictures from one place show no depth"));
}

TEST(ReconstructViews, OneViewAndNoScaleAreRefused) {
  ViewSet set = test::photograph_ring(young_tree(), small_ring(2));
  set.metric = false;
  EXPECT_THAT(message_of(set), HasSubstr("--height"));
  set.metric = true;
  set.views.resize(1);
  EXPECT_THAT(message_of(set), HasSubstr("at least 2"));
}

TEST(ReconstructViews, AHeightGivesTheScale) {
  ViewSet set = test::photograph_ring(young_tree(), small_ring(6));
  for (View& view : set.views) view.camera.translation *= 0.031;
  set.metric = false;
  scale_to_height(set, 4);
  EXPECT_TRUE(set.metric);
  ViewsOptions options;
  options.cloud.threads = 1;
  EXPECT_NEAR(reconstruct_views(set, options).model.metrics.height_m, 4, 0.06);
}

TEST(ReconstructViews, ABarAtTheStemGivesTheScale) {
  ViewSet set = test::photograph_ring(young_tree(), small_ring(6));
  const Camera first = set.views[0].camera;
  const ScaleBar bar{*first.project({0, 0, 0}), *first.project({0, 0, 1.5}), 1.5};
  for (View& view : set.views) view.camera.translation *= 0.031;
  set.metric = false;
  scale_to_bar(set, bar);
  EXPECT_TRUE(set.metric);
  EXPECT_NEAR(set.views[0].camera.translation.norm(), first.translation.norm(),
              0.02 * first.translation.norm());
}

}  // namespace
}  // namespace dendrofit
