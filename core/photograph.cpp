// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/photograph.h"

#include "core/errors.h"

#include <algorithm>
#include <cmath>

namespace dendrofit {
namespace {

/// Radial stretch at normalised squared radius r2.
double stretch(const Camera& camera, double r2) {
  return 1 + r2 * (camera.k1 + r2 * camera.k2);
}

/// Derivative of r * stretch(r^2) in r: not positive where the distortion folds back.
double slope(const Camera& camera, double r2) {
  return 1 + r2 * (3 * camera.k1 + 5 * r2 * camera.k2);
}

}  // namespace

void Photograph::validate() const {
  require(width > 0, "width", width, "must be positive");
  require(height > 0, "height", height, "must be positive");
  const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  require(rgb.size() == 3 * pixels, "rgb", static_cast<double>(rgb.size()), "must hold three bytes a pixel");
  require(mask.empty() || mask.size() == pixels, "mask", static_cast<double>(mask.size()),
          "must hold one byte a pixel");
}

std::optional<Eigen::Vector2d> Camera::project(const Vec3& world) const {
  const Vec3 p = rotation * world + translation;
  if (!(p.z() > 1e-9)) return std::nullopt;
  const double x = p.x() / p.z(), y = p.y() / p.z(), r2 = x * x + y * y;
  if (slope(*this, r2) <= 0) return std::nullopt;
  const double s = stretch(*this, r2);
  return Eigen::Vector2d(fx * x * s + cx, fy * y * s + cy);
}

Vec3 Camera::ray(const Eigen::Vector2d& pixel) const {
  const double xd = (pixel.x() - cx) / fx, yd = (pixel.y() - cy) / fy;
  const double rd = std::hypot(xd, yd);
  double r = rd;  // undistorted radius, by Newton on r * stretch(r^2) = rd
  for (int i = 0; i < 20; ++i) {
    const double step = (r * stretch(*this, r * r) - rd) / std::max(0.1, slope(*this, r * r));
    r -= step;
    if (std::abs(step) < 1e-14 * (1 + rd)) break;
  }
  const double back = rd > 0 ? r / rd : 1;
  return (rotation.transpose() * Vec3(xd * back, yd * back, 1)).normalized();
}

void Camera::validate() const {
  require(width > 0, "width", width, "must be positive");
  require(height > 0, "height", height, "must be positive");
  require(std::isfinite(fx) && fx > 0, "fx", fx, "must be positive");
  require(std::isfinite(fy) && fy > 0, "fy", fy, "must be positive");
  for (const double value : {cx, cy, k1, k2, translation.x(), translation.y(), translation.z()})
    require(std::isfinite(value), "camera", value, "must be finite");
  const double twist = (rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  require(std::abs(rotation.determinant() - 1) < 1e-3 && twist < 1e-3, "rotation", rotation.determinant(),
          "must be a rotation (determinant 1, not mirrored)");
}

}  // namespace dendrofit
