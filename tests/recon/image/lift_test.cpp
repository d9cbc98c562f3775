// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/image/lift.h"

#include "core/errors.h"
#include "core/tree_topology.h"
#include "recon/image/frame.h"
#include "tests/recon/image/drawn_silhouettes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dendrofit {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// A stem with sixteen branches to both sides, in a picture of 600 x 900.
PlaneSkeleton ladder() {
  test::Drawing drawing(600, 900);
  drawing.stroke(300, 880, 14, 300, 80, 3);
  for (int k = 0; k < 8; ++k) {
    const double y = 700 - 70 * k, reach = 180 - 15 * k;
    drawing.stroke(300, y, 4, 300 - reach, y - 0.8 * reach, 2);
    drawing.stroke(300, y - 30, 4, 300 + reach, y - 30 - 0.6 * reach, 2);
  }
  return skeletonise(drawing.silhouette);
}

FrameOptions of_height(double metres) {
  FrameOptions options;
  options.height_m = metres;
  return options;
}

/// A camera 6 m south of the origin at 1.7 m, pitched up by `pitch`, rolled by nothing.
Camera camera_before(double pitch) {
  Camera camera;
  camera.width = 600;
  camera.height = 900;
  camera.fx = camera.fy = 700;
  camera.cx = 300;
  camera.cy = 450;
  camera.k1 = -0.04;
  const double c = std::cos(pitch), s = std::sin(pitch);
  camera.rotation << 1, 0, 0, 0, s, -c, 0, c, s;
  camera.translation = -(camera.rotation * Vec3(0, -6, 1.7));
  return camera;
}

TEST(Frame, gives_the_tree_the_height_it_is_told) {
  const PictureFrame frame = frame_tree(600, 900, {300, 880}, {310, 80}, 10, of_height(8));
  EXPECT_EQ(frame.scale_source, "height");
  EXPECT_NEAR(frame.point({310, 80})->z() - frame.foot.z(), 8, 1e-9);
  EXPECT_LT(frame.foot.norm(), 1e-9);
  EXPECT_LT((*frame.camera.project(*frame.point({200, 300}, 0.7)) - Eigen::Vector2d(200, 300)).norm(), 1e-9);
}

TEST(Frame, takes_a_scale_bar_or_tree_heights) {
  FrameOptions bar;
  bar.scale_bar = ScaleBar{{320, 880}, {320, 680}, 2.0};
  const PictureFrame by_bar = frame_tree(600, 900, {300, 880}, {310, 80}, 10, bar);
  EXPECT_NEAR((*by_bar.point({320, 880}) - *by_bar.point({320, 680})).norm(), 2, 1e-9);
  EXPECT_GT(by_bar.scale_error, 0.005);
  const PictureFrame none = frame_tree(600, 900, {300, 880}, {310, 80}, 10, {});
  EXPECT_EQ(none.scale_source, "none");
  EXPECT_NEAR(none.point({310, 80})->z(), 1, 1e-9);
}

TEST(Frame, takes_the_eye_height_of_a_metric_camera) {
  FrameOptions options;
  options.camera = camera_before(0.1);
  options.metric_camera = true;
  options.eye_height_m = 1.7;
  const Vec3 foot(0.2, 0, 0), top(0.2, 0, 5);
  const PictureFrame frame =
      frame_tree(600, 900, *options.camera->project(foot), *options.camera->project(top), 0, options);
  EXPECT_LT((frame.foot - foot).norm(), 1e-6);
  EXPECT_NEAR(frame.point(*options.camera->project(top))->z(), 5, 1e-6);
}

TEST(Frame, takes_the_stems_middle_where_the_picture_shows_its_near_rim) {
  FrameOptions options;
  options.camera = camera_before(0.1);
  options.metric_camera = true;
  options.eye_height_m = 1.7;
  const Vec3 rim(0, -0.2, 0), top(0, 0, 5);
  const double half_width = 700 * 0.2 / options.camera->depth(rim);
  const PictureFrame frame =
      frame_tree(600, 900, *options.camera->project(rim), *options.camera->project(top), half_width, options);
  EXPECT_NEAR(frame.distance_m, 6, 0.02);
  EXPECT_NEAR(frame.foot.z(), 0, 1e-6);
  EXPECT_NEAR(frame.point(*options.camera->project(top))->z() - frame.foot.z(), 5, 0.02);
}

TEST(Frame, pitches_an_unknown_camera_by_the_horizon) {
  FrameOptions options = of_height(5);
  options.horizon_px = 520;
  const PictureFrame frame = frame_tree(600, 900, {300, 800}, {300, 100}, 10, options);
  const Vec3 level = frame.camera.ray({300, 520});
  EXPECT_NEAR(level.z(), 0, 1e-9);
}

/// What a camera on the level sees of a dome-shaped crown of wood, 6 m tall and 2 m in radius, from
/// `distance` away: foot, highest point, and the spread and width of its silhouette.
struct Dome {
  Eigen::Vector2d foot, top{0, 1e9};
  FrameOptions options;
  explicit Dome(double distance) {
    Camera camera = camera_before(0);
    camera.width = 3000;
    camera.height = 3000;
    camera.cx = camera.cy = 1500;
    camera.fx = camera.fy = 1500;
    camera.k1 = 0;
    camera.translation = -(camera.rotation * Vec3(0, -distance, 1.7));
    foot = *camera.project(Vec3::Zero());
    std::vector<Eigen::Vector2d> seen;
    for (double x = -2; x <= 2; x += 0.02)
      for (double y = -2; y <= 2; y += 0.02)
        for (double z = 6 - (x * x + y * y) / 4; z > 4; z -= 0.1)
          if (x * x + y * y < 4) seen.push_back(*camera.project({x, y, z}));
    double left = 1e9, right = 0, sum = 0, count = 0;
    for (const auto& p : seen) {
      if (p.y() < top.y()) top = p;
      left = std::min(left, p.x());
      right = std::max(right, p.x());
    }
    for (const auto& p : seen)
      if (p.y() < top.y() + 0.2 * (foot.y() - top.y())) sum += std::pow(p.x() - foot.x(), 2), ++count;
    options.camera = camera;
    options.crown_width_px = right - left;
    options.top_spread_px = std::sqrt(sum / count);
  }
};

TEST(Frame, knows_that_the_highest_wood_seen_leans_to_the_camera) {
  for (const double distance : {7.0, 9.0, 13.0}) {
    Dome dome(distance);
    dome.options.height_m = 6;
    dome.options.eye_height_m = 5;  // unlikely: nothing but the crown's shape tells
    const PictureFrame frame = frame_tree(3000, 3000, dome.foot, dome.top, 0, dome.options);
    EXPECT_NEAR(frame.height_to(dome.top), 6, 1e-9);
    // Taken to stand in the stem's plane the top would be seen this much too high.
    const double lead = (1.7 + (6 - 1.7) * (1 + 4.3 / distance / distance)) / 6 - 1;
    EXPECT_GT(frame.top_lead, 0.5 * lead) << distance;
    EXPECT_LT(frame.top_lead, 1.2 * lead) << distance;
    EXPECT_LT(std::abs(frame.distance_m / distance - 1), frame.top_lead_error);
  }
}

TEST(Frame, lets_a_likely_eye_height_count_beside_a_told_height_and_an_unlikely_one_not) {
  Dome dome(8);
  const auto distance = [&](double height, double eye) {
    dome.options.height_m = height;
    dome.options.eye_height_m = eye;
    return frame_tree(3000, 3000, dome.foot, dome.top, 0, dome.options).distance_m;
  };
  // The camera stands 1.7 m above the foot; the height is told 4 % too low.
  const double unlikely = distance(5.76, 4), likely = distance(5.76, 1.7);
  EXPECT_LT(unlikely, likely);
  EXPECT_LT(likely, 8);
  EXPECT_DOUBLE_EQ(unlikely, distance(5.76, 0.5));
}

TEST(Lift, bends_a_stem_to_the_camera_where_its_top_would_stand_too_high) {
  const PlaneSkeleton skeleton = ladder();
  FrameOptions options = of_height(7);
  options.top_spread_px = 60;
  options.crown_width_px = 360;
  const PictureFrame frame = frame_tree(600, 900, skeleton.px[0], skeleton.px.back(), 14, options);
  ASSERT_GT(frame.top_lead, 0.01);
  const Tree tree = lift(skeleton, frame);
  double highest = 0;
  for (std::size_t i = 0; i < tree.size(); ++i) {
    highest = std::max(highest, tree.end[i].z());
    EXPECT_LT((*frame.camera.project(tree.origin_shift + tree.end[i]) - skeleton.px[i + 1]).norm(), 1e-6);
    if (tree.order[i] != 0) continue;
    const double depth = tree.end[i].dot(frame.away);
    EXPECT_LE(depth, 1e-9);
    EXPECT_TRUE(tree.end[i].z() > 1.4 || depth > -0.02) << depth;
  }
  double flat = 0;
  for (const auto& px : skeleton.px) flat = std::max(flat, frame.point(px)->z() - frame.foot.z());
  EXPECT_NEAR(highest, flat / (1 + frame.top_lead), 0.01);
}

TEST(Frame, refuses_what_contradicts_the_picture) {
  EXPECT_THAT(
      [] {
        frame_tree(600, 900, {300, 80}, {310, 880}, 10, of_height(8));
      },
      ThrowsMessage<InputError>(HasSubstr("--root")));
  EXPECT_THROW(frame_tree(600, 900, {300, 880}, {310, 80}, 10, of_height(-1)), InputError);
  FrameOptions metric;
  metric.camera = camera_before(0);
  metric.metric_camera = true;
  EXPECT_THAT(
      [&] {
        frame_tree(600, 900, {300, 400}, {310, 80}, 10, metric);
      },
      ThrowsMessage<InputError>(HasSubstr("--height")));
}

TEST(Lift, puts_nothing_above_the_top_in_the_picture) {
  const PlaneSkeleton skeleton = ladder();
  EXPECT_NEAR(foot_radius_px(skeleton), 14, 1);
  FrameOptions options = of_height(7);
  options.camera = camera_before(0.35);  // near, and looking up: depth moves wood up and down
  const PictureFrame frame =
      frame_tree(600, 900, skeleton.px.front(), {300, 80}, foot_radius_px(skeleton), options);
  const Tree tree = lift(skeleton, frame, {});
  double flat = -1e9, highest = -1e9;
  for (std::size_t i = 0; i < tree.size(); ++i) {
    flat = std::max(flat, frame.point(skeleton.px[i + 1])->z());
    highest = std::max(highest, tree.end[i].z() + tree.origin_shift.z());
  }
  EXPECT_LT(highest, flat + 1e-6);
}

TEST(Lift, keeps_every_node_on_its_pixel) {
  const PlaneSkeleton skeleton = ladder();
  for (const bool known : {false, true}) {
    FrameOptions options = of_height(7);
    if (known) options.camera = camera_before(0.15);
    const PictureFrame frame = frame_tree(600, 900, skeleton.px[0], {300, 80}, 14, options);
    const Tree tree = lift(skeleton, frame);
    tree.validate();
    ASSERT_EQ(tree.size() + 1, skeleton.size());
    double worst = 0;
    for (std::size_t i = 0; i < tree.size(); ++i)
      worst = std::max(worst,
                       (*frame.camera.project(tree.origin_shift + tree.end[i]) - skeleton.px[i + 1]).norm());
    EXPECT_LT(worst, 1e-6) << known;
  }
}

TEST(Lift, spreads_branches_before_and_behind_the_stem) {
  const PlaneSkeleton skeleton = ladder();
  const PictureFrame frame = frame_tree(600, 900, skeleton.px[0], {300, 80}, 14, of_height(7));
  const Tree tree = lift(skeleton, frame);
  double nearest = 0, farthest = 0;
  for (std::size_t i = 0; i < tree.size(); ++i) {
    const double depth = (tree.end[i] - tree.start[0]).dot(frame.away);
    if (tree.order[i] == 0) {
      EXPECT_NEAR(depth, 0, 1e-9);
      EXPECT_EQ(tree.quality[i], RadiusQuality::measured);
    } else {
      EXPECT_EQ(tree.quality[i], RadiusQuality::extrapolated);
    }
    nearest = std::min(nearest, depth);
    farthest = std::max(farthest, depth);
  }
  EXPECT_LT(nearest, -0.1);
  EXPECT_GT(farthest, 0.1);
  EXPECT_EQ(axes_of(tree).size(), 17u);
  EXPECT_LT(std::max(-nearest, farthest), 2.0);  // the crown is 3.2 m wide
}

TEST(Lift, gives_the_same_tree_for_the_same_seed) {
  const PlaneSkeleton skeleton = ladder();
  const PictureFrame frame = frame_tree(600, 900, skeleton.px[0], {300, 80}, 14, of_height(7));
  const Tree one = lift(skeleton, frame, {.seed = 4}), two = lift(skeleton, frame, {.seed = 4});
  for (std::size_t i = 0; i < one.size(); ++i) ASSERT_EQ(one.end[i], two.end[i]);
  EXPECT_THROW(lift({}, frame), InputError);
  EXPECT_THROW(lift(skeleton, frame, {.opening_angle_deg = 0}), InputError);
}

}  // namespace
}  // namespace dendrofit
