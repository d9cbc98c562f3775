// SPDX-License-Identifier: GPL-3.0-or-later
// Circles and cylinders through points that lie on wood, with how far they can be trusted.
#pragma once

#include "core/types.h"

#include <cstdint>
#include <span>
#include <vector>

namespace dendrofit {

/// A circle in the plane.
struct CircleFit {
  bool ok = false;  ///< false: too few points, or no finite circle
  Eigen::Vector2d centre{0, 0};
  double radius = 0;
  double rms = 0;        ///< of the inliers' distances from the circle
  double radius_se = 0;  ///< standard error of the radius
  double coverage = 0;   ///< share of 24 sectors of the circle that hold points
  std::size_t inliers = 0;
};

/// Least-squares circle (Taubin 1991), algebraic: quick, and nearly unbiased on short arcs.
CircleFit algebraic_circle(std::span<const Eigen::Vector2d> points);

/// The same circle without its rms, radius_se and coverage (left 0): enough to start from.
CircleFit taubin_circle(std::span<const Eigen::Vector2d> points);

/// Geometric fit from `start`: Gauss-Newton on the distances with Tukey's weights at a scale from the median
/// absolute residual, never below `noise_m`.
CircleFit robust_circle(std::span<const Eigen::Vector2d> points, const CircleFit& start, double noise_m);

/// Two unit vectors that complete `direction` (unit) to a frame; a continuous function of it away from its
/// poles.
void plane_frame(const Vec3& direction, Vec3& u, Vec3& v);

/// Algebraic circle of the points `members` seen along `direction` about `middle`; `centre` of the result
/// lies in the plane through `middle` and is returned in space.
struct SpaceCircle {
  CircleFit fit;
  Vec3 centre = Vec3::Zero();
};
SpaceCircle circle_along(const std::vector<Vec3>& points, std::span<const std::uint32_t> members,
                         const Vec3& middle, const Vec3& direction);

}  // namespace dendrofit
