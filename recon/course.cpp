// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/course.h"

#include "recon/cylinder_fit.h"
#include "recon/sectors.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

namespace dendrofit {

int surface_sectors(const std::vector<Vec3>& points, std::span<const std::uint32_t> members, const Section& s,
                    double noise_m) {
  Vec3 u, v;
  plane_frame(s.direction, u, v);
  const double reach = std::max(2 * noise_m, 0.2 * s.radius_m);
  Sectors seen;
  for (const std::uint32_t p : members) {
    const Vec3 d = points[p] - s.centre;
    const double x = d.dot(u), y = d.dot(v);
    if (std::abs(std::hypot(x, y) - s.radius_m) > reach) continue;
    seen.add({x, y});
  }
  return seen.count();
}

bool follow_course(const std::vector<Vec3>& points, std::span<const std::uint32_t> members,
                   const Section& parent, double spacing_m, Section& s) {
  constexpr double kShift = 0.06, kChange = 0.06;  // standard deviations a section, in radii
  constexpr std::size_t kFewest = 5;
  constexpr double kTukey = 4.685;
  constexpr double kInterior = 0.35;  // radii below the surface, where wood has no points but twigs do
  // What points scatter about the surface: bark and noise, never as much as the radius itself.
  const double noise = std::min(std::max(0.25 * spacing_m, 0.05 * parent.radius_m), 0.12 * parent.radius_m);
  Vec3 u, v;
  plane_frame(parent.direction, u, v);
  std::vector<Eigen::Vector2d> flat;
  double along = 0, near = 0;
  for (const std::uint32_t p : members) {
    const Vec3 d = points[p] - parent.centre;
    flat.emplace_back(d.dot(u), d.dot(v));
    if (std::abs(flat.back().norm() - parent.radius_m) > 3 * noise) continue;
    along += d.dot(parent.direction);
    near += 1;
  }
  if (near < static_cast<double>(kFewest) || along <= 0) return false;
  along /= near;
  const double shift_weight = std::pow(noise / (kShift * parent.radius_m), 2);
  const double change_weight = std::pow(noise / (kChange * parent.radius_m), 2);
  Eigen::Vector3d circle(0, 0, parent.radius_m);  // centre and radius
  std::size_t inliers = 0, interior = 0;
  for (int iteration = 0; iteration < 8; ++iteration) {
    Eigen::Matrix3d normal = Eigen::Vector3d(shift_weight, shift_weight, change_weight).asDiagonal();
    Eigen::Vector3d gradient(shift_weight * circle.x(), shift_weight * circle.y(),
                             change_weight * (circle.z() - parent.radius_m));
    inliers = interior = 0;
    for (const Eigen::Vector2d& p : flat) {
      const Eigen::Vector2d d = p - circle.head<2>();
      const double distance = d.norm();
      const double residual = distance - circle.z();
      interior += residual < -std::max(3 * noise, kInterior * circle.z());
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
  if (inliers < kFewest || interior > 2 * inliers || circle.z() < 0.65 * parent.radius_m ||
      circle.z() > 1.12 * parent.radius_m || circle.head<2>().norm() > 0.4 * parent.radius_m)
    return false;
  s.centre = parent.centre + along * parent.direction + circle.x() * u + circle.y() * v;
  s.radius_m = circle.z();
  const Vec3 ahead = s.centre - parent.centre;
  const double share = ahead.norm() / (ahead.norm() + 2 * parent.radius_m);
  s.direction = ((1 - share) * parent.direction + share * ahead.normalized()).normalized();
  return true;
}

}  // namespace dendrofit
