// SPDX-License-Identifier: GPL-3.0-or-later
// Photographs and the cameras that took them, as values.
#pragma once

#include "core/types.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

namespace dendrofit {

/// Invariants: rgb holds 3 * width * height bytes, rows from the top; mask is empty or holds width * height.
struct Photograph {
  std::string name;  ///< for messages
  int width = 0;
  int height = 0;
  int halvings = 0;  ///< of the picture as stored: a pixel here is 2^halvings wide there
  std::vector<std::uint8_t> rgb;
  std::vector<std::uint8_t> mask;  ///< non-zero: tree. Empty: not given

  bool empty() const { return width == 0 || height == 0; }
  std::size_t pixel(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column);
  }
  /// Throws InputError at the first broken invariant.
  void validate() const;
};

/// A pinhole with radial distortion at a pose. Camera axes: x right, y down, z forward. Pixel coordinates
/// have their origin at the image's upper left corner: the centre of the first pixel is (0.5, 0.5).
struct Camera {
  int width = 0;
  int height = 0;
  double fx = 0, fy = 0;  ///< pixels
  double cx = 0, cy = 0;  ///< pixels
  double k1 = 0, k2 = 0;  ///< u = fx x (1 + k1 r^2 + k2 r^4) + cx for normalised x, y
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  ///< camera from world
  Vec3 translation = Vec3::Zero();  ///< camera = rotation * world + translation, metres

  Vec3 centre() const { return -(rotation.transpose() * translation); }
  double depth(const Vec3& world) const { return rotation.row(2).dot(world) + translation.z(); }
  /// Pixel of a point (local world coordinates); none behind the camera or where the distortion folds back.
  std::optional<Eigen::Vector2d> project(const Vec3& world) const;
  /// Unit vector, in world axes, from centre() through a pixel.
  Vec3 ray(const Eigen::Vector2d& pixel) const;
  /// Throws InputError naming field, value and limit (a rotation that is not one, focal lengths, sizes).
  void validate() const;
};

/// A photograph with its camera; world = the owning set's origin_shift + local.
struct View {
  Photograph photo;
  Camera camera;
};

/// Views of one tree with known cameras.
struct ViewSet {
  Vec3 origin_shift = Vec3::Zero();  ///< world = origin_shift + local
  Vec3 up = Vec3::UnitZ();           ///< unit; readers turn the world so that this is +z
  bool metric = true;                ///< false: lengths have no unit yet (scale from a height or a bar)
  std::optional<double> pose_error_px;
  std::vector<View> views;
  std::vector<std::string> warnings;  ///< what the reader noticed, for the user
};

}  // namespace dendrofit
