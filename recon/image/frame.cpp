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

constexpr double kEyeHeightError = 0.15;  // metres

/// How high above the tree its top is taken for, relative, and how well that is known.
struct Lead {
  double value = 0, error = 0;
};

/// `rise`: of the top above the eye, over the height. With spread s of the top fifth of height h at distance
/// D, the paraboloid's radius of curvature is R = 15 s^2 / h; a point y before its top is seen
/// rise y / D higher and lies y^2 / (2 R) lower, at most rise^2 R / (2 D^2) in all.
Lead lead_of_top(const PictureFrame& frame, double rise, const FrameOptions& options) {
  constexpr double widest = 0.2;  // beyond, the crown reaches the camera
  const double q = std::min(widest, std::abs(rise) * options.top_spread_px / frame.camera.fx);
  const double leaning = std::abs(rise) * options.crown_width_px / 6 / frame.camera.fx;
  return {7.5 * q * q, 0.6 * std::hypot(q, leaning)};
}

/// The lead that a told height and the eye height give together; `by_eye` what the eye height alone gives.
/// An eye height that contradicts the height (a camera on a slope or a pole) says nothing.
Lead joined(const Lead& lead, double by_eye, double eye_error) {
  const double open = std::hypot(lead.error, eye_error);
  if (!(std::abs(by_eye - lead.value) < 2 * open)) return lead;
  const double weight = std::pow(eye_error / open, 2);
  return {std::max(0.0, weight * lead.value + (1 - weight) * by_eye), lead.error * std::sqrt(weight)};
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

double PictureFrame::height_to(const Eigen::Vector2d& top_px) const {
  const auto top = point(top_px);
  return top ? (top->z() - foot.z()) / (1 + top_lead) : 0;
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
  Lead lead = lead_of_top(frame, (unit_height - below) / unit_height, options);
  double scale = (1 + lead.value) / unit_height;
  frame.scale_source = "none";
  if (options.height_m) {
    if ((frame.known_camera || options.horizon_px) && below > 0.02)
      lead = joined(lead, options.eye_height_m / below * unit_height / *options.height_m - 1,
                    kEyeHeightError / options.eye_height_m);
    scale = *options.height_m * (1 + lead.value) / unit_height;
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
    frame.scale_error = kEyeHeightError / options.eye_height_m;
  }
  frame.top_lead = lead.value;
  frame.top_lead_error = lead.error;
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
