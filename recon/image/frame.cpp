// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/image/frame.h"

#include "core/errors.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dendrofit {
namespace {

/// Focal length of a phone's main camera (26 mm on 36 mm film) over the longer side.
constexpr double kPhoneFocal = 0.72;

/// An upright camera at the origin that looks along +y, pitched so that the horizon is on its row.
Camera assumed_camera(int width, int height, const std::optional<double>& horizon_px) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = camera.fy = kPhoneFocal * std::max(width, height);
  camera.cx = 0.5 * width;
  camera.cy = 0.5 * height;
  const double pitch =
      horizon_px ? std::clamp(std::atan((*horizon_px - camera.cy) / camera.fy), -0.5, 0.5) : 0.0;
  const double c = std::cos(pitch), s = std::sin(pitch);
  camera.rotation << 1, 0, 0, 0, s, -c, 0, c, s;
  return camera;
}

/// Metres from `a` to `b` on the plane, if the camera stands one metre from it.
double unit_length(const PictureFrame& unit, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const auto p = unit.point(a), q = unit.point(b);
  return p && q ? (*p - *q).norm() : 0;
}

}  // namespace

void FrameOptions::validate() const {
  if (height_m)
    require(std::isfinite(*height_m) && *height_m > 0 && *height_m < 200, "height_m", *height_m,
            "must be above 0 and below 200");
  require(std::isfinite(eye_height_m) && eye_height_m > 0, "eye_height_m", eye_height_m, "must be positive");
  if (scale_bar) {
    require(std::isfinite(scale_bar->length_m) && scale_bar->length_m > 0, "scale_bar.length_m",
            scale_bar->length_m, "must be positive");
    require((scale_bar->to - scale_bar->from).norm() >= 5, "scale bar (pixels)",
            (scale_bar->to - scale_bar->from).norm(), "must be at least 5 pixels long");
  }
}

std::optional<Vec3> PictureFrame::point(const Eigen::Vector2d& pixel, double depth_m) const {
  const Vec3 ray = camera.ray(pixel);
  const double forward = ray.dot(away);
  if (forward < 0.02) return std::nullopt;
  return camera.centre() + ray * ((distance_m + depth_m) / forward);
}

double PictureFrame::metres_per_pixel(const Vec3& at) const {
  return camera.depth(at) / camera.fx;
}

PictureFrame frame_tree(int width, int height, const Eigen::Vector2d& foot_px, const Eigen::Vector2d& top_px,
                        double foot_radius_px, const FrameOptions& options) {
  options.validate();
  PictureFrame frame;
  frame.known_camera = options.camera.has_value();
  frame.camera = options.camera ? *options.camera : assumed_camera(width, height, options.horizon_px);
  const Vec3 centre = frame.camera.centre();
  const Vec3 ray = frame.camera.ray(foot_px);
  const Vec3 level(ray.x(), ray.y(), 0);
  if (level.norm() < 0.2)
    throw InputError("the camera looks straight down at the tree's foot: one such view shows no height");
  frame.away = level.normalized();
  frame.distance_m = 1;

  // The picture shows the foot's near rim, one radius before its centre.
  const double below = (centre.z() - frame.point(foot_px)->z()) * (1 - foot_radius_px / frame.camera.fx);
  const auto top = frame.point(top_px);
  const double unit_height = top ? top->z() - centre.z() + below : 0;
  if (!(unit_height > 0))
    throw InputError("the tree's top is not above its foot in the picture: choose the foot with --root");
  double scale = 1 / unit_height;
  frame.scale_source = "none";
  if (options.height_m) {
    scale = *options.height_m / unit_height;
    frame.scale_source = "height";
    frame.scale_error = 0.01;
  } else if (options.scale_bar) {
    const double bar = unit_length(frame, options.scale_bar->from, options.scale_bar->to);
    if (!(bar > 0)) throw InputError("the scale bar lies above the horizon of a camera that looks up");
    scale = options.scale_bar->length_m / bar;
    frame.scale_source = "scale bar";
    frame.scale_error = 1.5 / (options.scale_bar->to - options.scale_bar->from).norm();
  } else if (options.metric_camera) {
    if (!(below > 0.02))
      throw InputError(
          "the tree's foot is not below the camera, so the camera's height gives no scale: give --height");
    scale = options.eye_height_m / below;
    frame.scale_source = "eye height";
    frame.scale_error = 0.15 / options.eye_height_m;
  }
  frame.distance_m = scale;
  if (!frame.known_camera || !options.metric_camera) {
    // The foot is the origin of a world whose camera is free.
    frame.camera.translation = Vec3::Zero();
    const Vec3 at(frame.away.x() * scale, frame.away.y() * scale, -below * scale);
    frame.camera.translation = frame.camera.rotation * at;
  }
  frame.foot = *frame.point(foot_px);
  frame.foot.z() = frame.camera.centre().z() - below * scale;
  return frame;
}

}  // namespace dendrofit
