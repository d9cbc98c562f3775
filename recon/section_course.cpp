// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/section_course.h"

#include "recon/cylinder_fit.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

namespace dendrofit {
namespace {

/// Points seen along a section's axis, the axis at zero.
struct Ahead {
  std::vector<Eigen::Vector2d> flat;
};

/// Members as a circle of their own. Not ok: an arc, a cluster, several limbs, or no thinner than the wood.
CircleFit whole_circle(const Ahead& ahead, double radius, double noise) {
  constexpr double kThinner = 0.85;  // else the forecast knows better
  constexpr double kCoverage = 0.6;  // less is an arc
  constexpr double kScatter = 0.15;  // of its radius
  constexpr std::size_t kFewest = 12;
  const auto whole = [&](const CircleFit& fit, double scatter) {
    return fit.ok && fit.coverage >= kCoverage && fit.rms < scatter * fit.radius &&
           fit.radius < kThinner * radius && fit.centre.norm() < radius &&
           2 * fit.inliers > ahead.flat.size();
  };
  if (ahead.flat.size() < kFewest) return {};
  const CircleFit start = algebraic_circle(ahead.flat);
  if (!whole(start, 1.3 * kScatter)) return {};
  const CircleFit fit = robust_circle(ahead.flat, start, noise);
  return whole(fit, kScatter) ? fit : CircleFit{};
}

/// The circle (centre, radius) that points and forecast make most likely; radius 0: the points lie off it.
Eigen::Vector3d foretold_circle(const Ahead& ahead, double radius, double noise) {
  constexpr double kShift = 0.06, kChange = 0.06;  // standard deviations a section, in radii
  constexpr double kTukey = 4.685;
  constexpr std::size_t kFewest = 5;
  const double shift_weight = std::pow(noise / (kShift * radius), 2);
  const double change_weight = std::pow(noise / (kChange * radius), 2);
  Eigen::Vector3d circle(0, 0, radius);
  std::size_t inliers = 0;
  for (int iteration = 0; iteration < 8; ++iteration) {
    Eigen::Matrix3d normal = Eigen::Vector3d(shift_weight, shift_weight, change_weight).asDiagonal();
    Eigen::Vector3d gradient(shift_weight * circle.x(), shift_weight * circle.y(),
                             change_weight * (circle.z() - radius));
    inliers = 0;
    for (const Eigen::Vector2d& p : ahead.flat) {
      const Eigen::Vector2d d = p - circle.head<2>();
      const double distance = d.norm();
      const double residual = distance - circle.z();
      const double off = residual / (kTukey * noise);
      if (std::abs(off) >= 1 || distance <= 0) continue;
      const double w = (1 - off * off) * (1 - off * off);
      const Eigen::Vector3d row(-d.x() / distance, -d.y() / distance, -1);
      normal += w * row * row.transpose();
      gradient += w * residual * row;
      inliers += std::abs(residual) < 2 * noise;
    }
    const Eigen::Vector3d change = normal.ldlt().solve(gradient);
    circle -= change;
    if (change.norm() < 1e-6) break;
  }
  if (inliers < kFewest || circle.z() < 0.65 * radius || circle.z() > 1.12 * radius ||
      circle.head<2>().norm() > 0.4 * radius)
    return Eigen::Vector3d::Zero();
  return circle;
}

}  // namespace

std::optional<CoursePlace> next_on_course(const std::vector<Vec3>& points,
                                          std::span<const std::uint32_t> members, const Section& from,
                                          double spacing_m) {
  constexpr double kFewestNear = 5;
  const double radius = from.radius_m;
  // What points scatter about the surface: bark and noise, never as much as the radius itself.
  const double noise = std::min(std::max(0.25 * spacing_m, 0.05 * radius), 0.12 * radius);
  Vec3 u, v;
  plane_frame(from.direction, u, v);
  Ahead ahead;
  double along = 0, near = 0, all = 0;
  for (const std::uint32_t p : members) {
    const Vec3 d = points[p] - from.centre;
    ahead.flat.emplace_back(d.dot(u), d.dot(v));
    all += d.dot(from.direction) / static_cast<double>(members.size());
    if (std::abs(ahead.flat.back().norm() - radius) > 3 * noise) continue;
    along += d.dot(from.direction);
    near += 1;
  }
  Eigen::Vector3d circle = Eigen::Vector3d::Zero();
  if (const CircleFit own = whole_circle(ahead, radius, noise); own.ok && all > 0) {
    circle << own.centre, own.radius;
    along = all;
  } else if (near >= kFewestNear && along > 0) {
    circle = foretold_circle(ahead, radius, noise);
    along /= near;
  }
  if (!(circle.z() > 0)) return std::nullopt;
  CoursePlace place;
  place.centre = from.centre + along * from.direction + circle.x() * u + circle.y() * v;
  place.radius_m = circle.z();
  const Vec3 step = place.centre - from.centre;
  const double share = step.norm() / (step.norm() + 2 * radius);
  place.direction = ((1 - share) * from.direction + share * step.normalized()).normalized();
  return place;
}

}  // namespace dendrofit
