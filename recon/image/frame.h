// SPDX-License-Identifier: GPL-3.0-or-later
// Where a photographed tree stands before its camera, and how long a pixel is there.
#pragma once

#include "core/photograph.h"
#include "core/types.h"

#include <optional>
#include <string>
#include <vector>

namespace dendrofit {

/// Two pixels a known length apart, at the tree's distance (a pole at the stem).
struct ScaleBar {
  Eigen::Vector2d from = Eigen::Vector2d::Zero();
  Eigen::Vector2d to = Eigen::Vector2d::Zero();
  double length_m = 0;
};

struct FrameOptions {
  std::optional<double> height_m = std::nullopt;  ///< of the tree
  std::optional<ScaleBar> scale_bar = std::nullopt;
  std::optional<Camera> camera = std::nullopt;  ///< pose and focal length, local coordinates, z up
  bool metric_camera = false;                   ///< its translation is in metres
  double eye_height_m = 1.6;  ///< of the camera over the tree's foot, where that has to give the scale
  std::optional<double> horizon_px =
      std::nullopt;           ///< row of the horizon, for the pitch of an unknown camera
  double top_spread_px = 0;   ///< rms distance of the wood in the top fifth from the foot's column
  double crown_width_px = 0;  ///< of the silhouette
  void validate() const;
};

/// The vertical plane through the foot that faces the camera, in the camera's world.
struct PictureFrame {
  Camera camera;
  Vec3 foot = Vec3::Zero();   ///< on the ground, in the stem's middle
  Vec3 away = Vec3::UnitY();  ///< horizontal unit vector from the camera to the foot
  double distance_m = 1;      ///< horizontal, camera to foot
  std::string scale_source;   ///< "height", "scale bar", "eye height" or "none"
  double scale_error = 0;     ///< relative, one standard deviation
  double top_lead = 0;  ///< how much higher, relative, the top's pixel lies on the plane than the tree is
  double top_lead_error = 0;  ///< one standard deviation
  bool known_camera = false;

  /// The point on a pixel's ray that lies `depth_m` behind the plane; none where the ray does not meet it.
  std::optional<Vec3> point(const Eigen::Vector2d& pixel, double depth_m = 0) const;
  /// Height of the tree whose top is seen at a pixel.
  double height_to(const Eigen::Vector2d& top_px) const;
  /// Metres a pixel spans across the view at a point.
  double metres_per_pixel(const Vec3& point) const;
};

/// The frame for a tree between two pixels: the lowest of its foot, whose half-width is told, and its top.
/// Without a camera: a phone's field of view (focal length 0.72 of the longer side), no roll, pitch from the
/// horizon where it is known. Scale, in this order: the tree's height, the scale bar, a metric camera held
/// eye_height_m above the foot; otherwise the tree is 1 high. The highest wood in the picture stands nearer
/// than the stem more often than not and so looks higher than the tree is (top_lead): by 7.5 q^2, as of a
/// paraboloid of revolution whose top fifth is seen as wide as the tree's, q its rms half-width over the
/// distance times the rise from the eye over the height. Where the height is told and a level is known (a
/// camera's or the horizon), what the eye height says of the scale counts as well, by the errors of both.
/// Throws InputError where these contradict the picture (a top below the foot, a camera below it).
PictureFrame frame_tree(int width, int height, const Eigen::Vector2d& foot_px, const Eigen::Vector2d& top_px,
                        double foot_radius_px, const FrameOptions& options);

}  // namespace dendrofit
