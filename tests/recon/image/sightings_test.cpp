// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/image/sightings.h"

#include "recon/image/poses.h"
#include "recon/image/redundancy.h"
#include "recon/image/settle.h"
#include "recon/image/tips.h"
#include "tests/support/photo_render.h"
#include "tests/support/tiny_trees.h"

#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace dendrofit {
namespace {

struct Scene {
  std::vector<Camera> cameras;
  std::vector<Outline> outlines;
};

Scene scene(const Tree& tree, int views) {
  const ViewSet set = test::photograph_ring(tree, {.views = views,
                                                   .width = 400,
                                                   .height = 600,
                                                   .focal_px = 500,
                                                   .render = {.photograph = false, .threads = 1}});
  Scene s;
  for (const View& view : set.views) {
    s.cameras.push_back(view.camera);
    s.outlines.emplace_back(view.photo.mask, view.photo.width, view.photo.height);
  }
  return s;
}

/// Two posts on one foot, half a metre apart, in pieces of 0.2 m.
Tree two_posts() {
  Tree tree;
  std::int32_t last = -1;
  for (int i = 0; i < 10; ++i)
    last =
        tree.add({.start = {0, 0, 0.2 * i}, .end = {0, 0, 0.2 * (i + 1)}, .parent = i - 1, .radius = 0.05});
  last = 0;
  Vec3 at(0, 0, 0.2);
  for (int i = 0; i < 9; ++i) {
    const Vec3 next = i == 0 ? Vec3(0.5, 0, 0.4) : Vec3(0.5, 0, 0.4 + 0.2 * i);
    last = tree.add({.start = at, .end = next, .parent = last, .radius = 0.04, .axis = 1, .order = 1});
    at = next;
  }
  return tree;
}

TEST(Sightings, WidthsOfLonelyWoodAreItsRadius) {
  const Tree posts = two_posts();
  const Scene s = scene(posts, 8);
  const Sightings seen = sight_cylinders(posts, s.cameras, s.outlines, 3, 1);
  int clear = 0;
  for (std::size_t i = 3; i < 9; ++i)
    for (const Sighting& g : seen[i]) {
      if (!g.alone) continue;
      ++clear;
      EXPECT_NEAR(g.half_width_px / g.px_per_m, 0.05, 0.004);
      EXPECT_NEAR(g.offset_px, 0, 0.4);
    }
  EXPECT_GT(clear, 20);
  EXPECT_GE(support_of(seen[5]), 6);
}

TEST(Sightings, APhantomBetweenTwoPostsIsRemoved) {
  const Tree truth = two_posts();
  const Scene s = scene(truth, 8);
  Tree carved = truth;
  // Wood that is not there, standing between the posts where single views show one of them.
  std::int32_t last = 0;
  Vec3 at(0, 0, 0.2);
  for (int i = 0; i < 6; ++i) {
    const Vec3 next(0.25, 0.02, 0.4 + 0.2 * i);
    last = carved.add({.start = at, .end = next, .parent = last, .radius = 0.03, .axis = 2, .order = 1});
    at = next;
  }
  const Sightings seen = sight_cylinders(carved, s.cameras, s.outlines, 3, 1);
  const std::vector<char> keep = supported(carved, seen, 3);
  for (std::size_t i = 0; i < truth.size(); ++i) EXPECT_TRUE(keep[i]) << i;
  for (std::size_t i = truth.size() + 1; i < carved.size(); ++i) EXPECT_FALSE(keep[i]) << i;
}

TEST(Settle, CentresAndRadiiComeBackToTheWood) {
  const Tree truth = two_posts();
  const Scene s = scene(truth, 8);
  Tree moved = truth;
  for (std::size_t i = 0; i < moved.size(); ++i) {
    moved.start[i] += Vec3(0.01, -0.008, 0);
    moved.end[i] += Vec3(0.01, -0.008, 0);
    moved.radius[i] *= 1.3;
  }
  centre_on_views(moved, sight_cylinders(moved, s.cameras, s.outlines, 4, 1));
  settle_radii_from_views(moved, sight_cylinders(moved, s.cameras, s.outlines, 4, 1));
  for (std::size_t i = 3; i < 9; ++i) {
    EXPECT_LT((moved.end[i] - truth.end[i]).head<2>().norm(), 0.004) << i;
    EXPECT_NEAR(moved.radius[i], 0.05, 0.003) << i;
    EXPECT_EQ(moved.quality[i], RadiusQuality::measured);
  }
  moved.validate();
}

TEST(Settle, WhereTwoArmsPartNeitherIsMeasuredAsBoth) {
  Tree fork;
  std::int32_t last = -1;
  for (int i = 0; i < 5; ++i)
    last =
        fork.add({.start = {0, 0, 0.2 * i}, .end = {0, 0, 0.2 * (i + 1)}, .parent = i - 1, .radius = 0.06});
  const std::int32_t bearer = last;
  for (const double side : {-1.0, 1.0}) {
    Vec3 at(0, 0, 1);
    last = bearer;
    for (int i = 0; i < 8; ++i) {
      const Vec3 next = at + Vec3(0.025 * side, 0, 0.09);
      last = fork.add(
          {.start = at, .end = next, .parent = last, .radius = 0.04, .axis = side > 0, .order = side > 0});
      at = next;
    }
  }
  const Scene s = scene(fork, 8);
  Tree settled = fork;
  settle_radii_from_views(settled, sight_cylinders(settled, s.cameras, s.outlines, 2, 1));
  for (const std::size_t first : {5U, 13U}) {
    EXPECT_NE(settled.quality[first], RadiusQuality::measured);
    EXPECT_LT(settled.radius[first], 0.052) << first;  // both arms together are 0.06 and more
  }
}

TEST(Settle, WoodThatFewViewsShowIsNotCalledMeasured) {
  const Tree truth = two_posts();
  const Scene s = scene(truth, 8);
  Sightings seen = sight_cylinders(truth, s.cameras, s.outlines, 4, 1);
  for (std::size_t i = 14; i < truth.size(); ++i) seen[i].clear();
  Tree tree = truth;
  settle_radii_from_views(tree, seen);
  EXPECT_EQ(tree.quality[truth.size() - 1], RadiusQuality::extrapolated);
  for (std::size_t i = 0; i < tree.size(); ++i) EXPECT_GT(tree.radius[i], 0);
}

TEST(Poses, AShiftedAndTurnedCameraComesBack) {
  const Tree truth = test::small_tree();
  Tree fine;  // pieces short enough to give each view many sightings
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const Vec3 run = truth.end[i] - truth.start[i];
    std::int32_t parent = truth.parent[i] < 0 ? -1 : 10 * truth.parent[i] + 9;
    for (int k = 0; k < 10; ++k)
      parent = fine.add({.start = truth.start[i] + 0.1 * k * run,
                         .end = truth.start[i] + 0.1 * (k + 1) * run,
                         .parent = parent,
                         .radius = truth.radius[i],
                         .axis = truth.axis[i],
                         .order = truth.order[i]});
  }
  const Scene s = scene(fine, 6);
  std::vector<Camera> cameras = s.cameras;
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.002, Vec3(1, 2, 0.5).normalized()).toRotationMatrix();
  cameras[2].rotation = turn * cameras[2].rotation;
  cameras[2].translation = turn * cameras[2].translation + Vec3(0.01, 0, 0);
  const auto worst = [&](const std::vector<Camera>& c) {
    double most = 0;
    for (const Vec3& p : fine.end)
      most = std::max(most, (*c[2].project(p) - *s.cameras[2].project(p)).norm());
    return most;
  };
  const double before = worst(cameras);
  for (int k = 0; k < 3; ++k)
    cameras = refine_poses(fine, sight_cylinders(fine, cameras, s.outlines, 6, 1), cameras);
  EXPECT_GT(before, 1.8);
  EXPECT_LT(worst(cameras), 0.7);
}

TEST(Redundancy, AnAxisThatOthersExplainIsDropped) {
  const Tree truth = two_posts();
  const Scene s = scene(truth, 8);
  Tree doubled = truth;
  std::int32_t last = 1;
  Vec3 at(0.02, 0, 0.4);
  for (int i = 0; i < 4; ++i) {  // runs within the first post
    last = doubled.add(
        {.start = at, .end = at + Vec3(0, 0, 0.2), .parent = last, .radius = 0.02, .axis = 2, .order = 1});
    at.z() += 0.2;
  }
  const std::vector<char> keep = needed_by_views(doubled, s.cameras, 1);
  for (std::size_t i = 0; i < doubled.size(); ++i) EXPECT_EQ(keep[i] != 0, i < truth.size()) << i;
}

/// Whether the tree's part beyond `from` nodes goes on from node `tip`, each cylinder from the last.
bool continues(const Tree& tree, std::size_t from, std::int32_t tip) {
  for (std::size_t i = from; i < tree.size(); ++i) {
    if (tree.parent[i] != (i == from ? tip : static_cast<std::int32_t>(i) - 1)) return false;
    if (tree.quality[i] != RadiusQuality::extrapolated) return false;
  }
  return true;
}

TEST(Tips, ATwigCutShortGoesOnAsFarAsTheViewsShowIt) {
  const Tree truth = two_posts();
  const Scene s = scene(truth, 8);
  Tree cut = truth;
  cut.end[9].z() = 1.85;  // of 2
  extend_tips(cut, s.cameras, s.outlines, 1);
  ASSERT_GT(cut.size(), truth.size());
  cut.validate();
  EXPECT_TRUE(continues(cut, truth.size(), 9));
  EXPECT_NEAR(cut.end.back().z(), 2, 0.02);
  EXPECT_EQ(cut.radius[truth.size()], cut.radius[9]);  // as all views show
}

TEST(Tips, AFewViewsMakeAThinTwigAndTwoMakeNone) {
  const Tree truth = two_posts();
  const Scene whole = scene(truth, 8);
  Tree cut = truth;
  cut.end[9].z() = 1.85;
  Scene some = scene(cut, 8);
  for (const std::size_t v : {0U, 3U}) some.outlines[v] = whole.outlines[v];
  Tree grown = cut;
  extend_tips(grown, some.cameras, some.outlines, 1);
  EXPECT_EQ(grown.size(), cut.size());
  some.outlines[5] = whole.outlines[5];
  extend_tips(grown, some.cameras, some.outlines, 1);
  ASSERT_GT(grown.size(), cut.size());
  EXPECT_TRUE(continues(grown, cut.size(), 9));
  EXPECT_NEAR(grown.end.back().z(), 2, 0.03);
  EXPECT_LT(grown.radius.back(), 0.01);
}

}  // namespace
}  // namespace dendrofit
