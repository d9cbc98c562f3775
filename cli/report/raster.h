// SPDX-License-Identifier: GPL-3.0-or-later
// A z-buffer: a scene seen along one direction, and its light.
#pragma once

#include "cli/report/image.h"
#include "cli/report/scene.h"

#include <cstdint>
#include <vector>

namespace dendrofit {

/// World to pixels. Depth is metres along `forward` from the eye's plane (which lies `distance` before
/// `centre`).
struct PictureView {
  Eigen::Vector3f right = Eigen::Vector3f::UnitX();
  Eigen::Vector3f up = Eigen::Vector3f::UnitZ();
  Eigen::Vector3f forward = Eigen::Vector3f::UnitY();
  Eigen::Vector3f centre = Eigen::Vector3f::Zero();  ///< shown at pixel (centre_x, centre_y)
  float centre_x = 0;
  float centre_y = 0;
  float scale = 100;     ///< pixels a metre in the centre's plane
  float distance = 100;  ///< metres from the eye('s plane) to the centre
  bool perspective = false;

  /// (x, y) in pixels, z the depth; false behind the eye.
  bool project(const Eigen::Vector3f& world, Eigen::Vector3f& pixel) const;
  Eigen::Vector3f unproject(float x, float y, float depth) const;
};

/// azimuth and elevation as in PictureCamera.
PictureView view_along(double azimuth_deg, double elevation_deg);

struct Shading {
  bool shadows = true;
  float point_size_m = 0.01f;
  Rgb background;
};

/// The scene as seen, `samples` x `samples` samples a pixel.
Image draw_scene(const Scene& scene, const PictureView& view, int width_px, int height_px, int samples,
                 const Shading& shading);

}  // namespace dendrofit
