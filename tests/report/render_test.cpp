// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/report/render.h"

#include "core/errors.h"
#include "tests/report/sample.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace dendrofit {
namespace {

/// Only the picture: nothing written on it, no light but the eye's.
RenderOptions bare() {
  RenderOptions options;
  options.panel_width_px = 300;
  options.height_px = 400;
  options.ground = options.scale_bar = options.height_marks = options.legend = options.shadows = false;
  options.threads = 1;
  return options;
}

Tree post(double radius, double length, const Vec3& along = Vec3::UnitZ(), const Vec3& foot = Vec3::Zero()) {
  Tree tree;
  tree.origin_shift = foot;
  TreeNode node;
  node.end = length * along;
  node.radius = radius;
  tree.add(node);
  return tree;
}

struct Silhouette {
  int left = 1 << 30, right = -1, top = 1 << 30, bottom = -1;
  int width() const { return right - left + 1; }
  int height() const { return bottom - top + 1; }
};

Silhouette silhouette(const Image& image, int from_x = 0, int to_x = 1 << 30,
                      Rgb background = {250, 250, 248}) {
  Silhouette s;
  for (int y = 0; y < image.height; ++y)
    for (int x = from_x; x < std::min(to_x, image.width); ++x)
      if (!(image.at(x, y) == background)) {
        s.left = std::min(s.left, x);
        s.right = std::max(s.right, x);
        s.top = std::min(s.top, y);
        s.bottom = std::max(s.bottom, y);
      }
  return s;
}

Image picture(const Tree& tree, const RenderOptions& options, bool smooth = false) {
  Panel panel;
  panel.tree = &tree;
  panel.smooth_wood = smooth;
  return render({&panel, 1}, options);
}

TEST(Render, KeepsProportions) {
  const Silhouette s = silhouette(picture(post(0.25, 2), bare()));
  EXPECT_NEAR(static_cast<double>(s.width()) / s.height(), 0.25, 0.02);
}

TEST(Render, TheLegendOfManyOrdersStaysInANarrowPanel) {
  Tree tree = post(0.02, 6);
  for (int order = 1; order <= 8; ++order) {
    TreeNode node;
    node.start = Vec3(0, 0, 0.6 * order);
    node.end = node.start + Vec3(0.05, 0, 0.05);
    node.radius = 0.003;
    node.parent = 0;
    node.axis = node.order = order;
    tree.add(node);
  }
  RenderOptions options = bare();
  options.legend = true;
  for (const int width : {160, 240, 400}) {
    options.panel_width_px = width;
    options.height_px = 700;
    Panel panel;
    panel.tree = &tree;
    panel.tree_colour = TreeColour::order;
    const Image image = render({&panel, 1}, options);
    ASSERT_LE(image.width, width);
    // Every order's swatch, whole, below the tree, and nothing at the picture's very edges.
    for (const Rgb& colour : kOrderColours) {
      int seen = 0;
      for (int y = image.height * 5 / 6; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) seen += image.at(x, y) == colour;
      EXPECT_GE(seen, 16) << width << ": " << hex(colour);
    }
    for (int y = image.height * 5 / 6; y < image.height; ++y)
      for (const int x : {0, image.width - 1}) EXPECT_TRUE(image.at(x, y) == options.background) << width;
  }
}

TEST(Render, EyeStandsWhereTheAngleSays) {
  Tree tree = post(0.05, 2);
  TreeNode east;
  east.start = {0, 0, 1};
  east.end = {1, 0, 1};
  east.radius = 0.05;
  east.parent = 0;
  east.axis = 1;
  east.order = 1;
  tree.add(east);
  RenderOptions options = bare();
  const auto arm = [&](double azimuth, double elevation) {
    options.camera.azimuth_deg = azimuth;
    options.camera.elevation_deg = elevation;
    options.camera.zoom_box = Bounds{{-1.2, -1.2, -0.2}, {1.2, 1.2, 2.2}};
    const Image image = picture(tree, options);
    const Silhouette s = silhouette(image);
    return std::pair{image.width / 2 - s.left, s.right - image.width / 2};
  };
  const auto [south_left, south_right] = arm(0, 0);
  EXPECT_GT(south_right, 4 * south_left);  // from the south, east is right
  const auto [north_left, north_right] = arm(180, 0);
  EXPECT_GT(north_left, 4 * north_right);
  const auto [east_left, east_right] = arm(90, 0);
  EXPECT_LT(std::max(east_left, east_right), south_right / 3);  // end on
  const auto [above_left, above_right] = arm(0, 90);
  EXPECT_GT(above_right, 4 * above_left);
}

TEST(Render, NearThingsHideFarOnes) {
  Tree tree = post(0.3, 1);
  tree.order[0] = 0;
  TreeNode behind;
  behind.start = {-0.6, 2, 0.5};
  behind.end = {0.6, 2, 0.5};
  behind.radius = 0.1;
  behind.parent = 0;
  behind.axis = 1;
  behind.order = 1;
  tree.add(behind);
  RenderOptions options = bare();
  options.camera.zoom_box = Bounds{{-0.7, -0.7, 0}, {0.7, 0.7, 1}};
  Panel panel;
  panel.tree = &tree;
  panel.tree_colour = TreeColour::order;
  const auto middle = [&](double azimuth) {
    options.camera.azimuth_deg = azimuth;
    const Image image = render({&panel, 1}, options);
    const Silhouette s = silhouette(image);
    return image.at(image.width / 2, (s.top + s.bottom) / 2);
  };
  const Rgb front = middle(0);
  EXPECT_GT(front.b, front.r);  // the stem's blue
  const Rgb back = middle(180);
  EXPECT_GT(back.r, back.b);  // the branch's orange
}

TEST(Render, WhatStandsAboutIsSeenThroughAndNeverWidensThePicture) {
  const Tree tree = post(0.1, 2);
  const Image alone = picture(tree, bare());
  const auto with_wall = [&](double y) {  // before the tree where y < 0
    TriangleMesh wall;
    wall.vertices = {{-9, y, -9}, {9, y, -9}, {9, y, 9}, {-9, y, 9}};
    wall.triangles = {{0, 1, 2}, {0, 2, 3}};
    Panel panel;
    panel.tree = &tree;
    panel.smooth_wood = false;
    panel.surroundings = &wall;
    return render({&panel, 1}, bare());
  };
  const Image before = with_wall(-1), behind = with_wall(1);
  ASSERT_EQ(before.width, alone.width);
  ASSERT_EQ(before.height, alone.height);
  const int x = alone.width / 2, y = alone.height / 2;  // wood
  EXPECT_EQ(behind.at(x, y), alone.at(x, y));
  EXPECT_FALSE(before.at(x, y) == alone.at(x, y));
  EXPECT_FALSE(before.at(x, y) == before.at(2, y));  // the tree still parts from the wall
  EXPECT_EQ(before.at(2, y), behind.at(2, y));
  EXPECT_FALSE(before.at(2, y) == alone.at(2, y));
}

TEST(Render, GeoreferencedTreesLookTheSame) {
  RenderOptions options = bare();
  options.shadows = true;
  const Tree here = test::branching_tree(3, 4);
  const Tree there = test::branching_tree(3, 4, {486000.125, 5432000.5, 412.75});
  EXPECT_EQ(picture(here, options, true).rgb, picture(there, options, true).rgb);
}

TEST(Render, ThreadsChangeNoByte) {
  const test::Sample sample(4000, 200);
  RenderOptions options;
  options.panel_width_px = 240;
  options.height_px = 300;
  options.threads = 1;
  const SideBySide content{&sample.scan, &sample.model, &sample.regrown, &sample.foliage, false};
  const Image one = side_by_side(content, options);
  options.threads = 3;
  EXPECT_EQ(one.rgb, side_by_side(content, options).rgb);
}

TEST(Render, EmptyAndTinyContentsGiveAPicture) {
  const Tree none;
  const PointCloud empty;
  PointCloud single;
  single.points.push_back({0, 0, 0});
  const Foliage bald;
  const Tree one = post(0.01, 0.02);
  std::vector<Panel> panels(6);
  panels[1].tree = &none;
  panels[2].cloud = &empty;
  panels[3].cloud = &single;
  panels[4].foliage = &bald;
  panels[5].tree = &one;
  for (const Panel& panel : panels)
    for (bool perspective : {false, true})
      for (double elevation : {-30.0, 0.0, 90.0}) {
        RenderOptions options;
        options.panel_width_px = 200;
        options.height_px = 200;
        options.camera.elevation_deg = elevation;
        if (perspective) options.camera.perspective_fov_deg = 60;
        const Image image = render({&panel, 1}, options);
        EXPECT_GE(image.width, 100);
        EXPECT_EQ(image.rgb.size(),
                  3u * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
      }
}

TEST(Render, RefusesWhatCannotBe) {
  EXPECT_THROW(render({}, {}), InputError);
  Panel panel;
  RenderOptions options;
  options.camera.elevation_deg = 91;
  EXPECT_THROW(render({&panel, 1}, options), InputError);
  options = {};
  options.panel_width_px = 3;
  EXPECT_THROW(render({&panel, 1}, options), InputError);
  options = {};
  options.camera.zoom_box = Bounds{};
  EXPECT_THROW(render({&panel, 1}, options), InputError);
  options = {};
  options.point_size_m = 0;
  EXPECT_THROW(render({&panel, 1}, options), InputError);
}

TEST(SideBySide, DrawsAllAtOneScaleOnOneGroundLine) {
  const Tree tall = post(0.1, 4);
  const Tree half = post(0.1, 2, Vec3::UnitZ(), {1000, 2000, 30});
  RenderOptions options = bare();
  const Image image = side_by_side({nullptr, &tall, &half, nullptr, false}, options);
  // Below the titles (which are dark) only wood is drawn.
  const auto wood = [&](int from, int to) {
    Image below(image.width, image.height - 36, options.background);
    below.paste(image, 0, -36);
    return silhouette(below, from, to);
  };
  const Silhouette left = wood(0, image.width / 2);
  const Silhouette right = wood(image.width / 2, image.width);
  EXPECT_NEAR(left.height(), 2 * right.height(), 3);
  EXPECT_NEAR(left.width(), right.width(), 1);
  EXPECT_EQ(left.bottom, right.bottom);
}

TEST(SideBySide, LeavesOutWhatIsNotThere) {
  const Tree tree = post(0.1, 2);
  const Image one = side_by_side({nullptr, &tree, nullptr, nullptr, false}, bare());
  const Image two = side_by_side({nullptr, &tree, &tree, nullptr, false}, bare());
  EXPECT_EQ(two.width, 2 * one.width);
  EXPECT_THROW(side_by_side({}, bare()), InputError);
}

TEST(Render, ScanSplatsCoverTheTreeTheyCameFrom) {
  const Tree tree = post(0.2, 2);
  const PointCloud cloud = test::scattered_scan(tree, 20000);
  RenderOptions options = bare();
  options.camera.zoom_box = Bounds{{-0.5, -0.5, 0}, {0.5, 0.5, 2}};
  Panel wood;
  wood.tree = &tree;
  Panel points;
  points.cloud = &cloud;
  points.anchor = Vec3::Zero();
  const Silhouette a = silhouette(render({&wood, 1}, options));
  const Silhouette b = silhouette(render({&points, 1}, options));
  EXPECT_NEAR(a.left, b.left, 3);
  EXPECT_NEAR(a.right, b.right, 3);
  EXPECT_NEAR(a.top, b.top, 4);
  EXPECT_NEAR(a.bottom, b.bottom, 4);
}

TEST(Render, places_beyond_what_single_precision_holds_leave_the_picture_whole) {
  PointCloud cloud;
  cloud.points = {{0, 0, 0}, {0, 0, 1}, {1e200, 0, 0}, {0, -1e39, 1e30}};
  Panel panel;
  panel.cloud = &cloud;
  RenderOptions options = bare();
  options.shadows = true;
  const Image image = render(std::vector<Panel>{panel}, options);
  EXPECT_GT(image.width, 0);
}

}  // namespace
}  // namespace dendrofit
