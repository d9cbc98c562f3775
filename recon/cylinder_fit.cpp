// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/cylinder_fit.h"

#include "recon/sectors.h"
#include "recon/select.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

namespace dendrofit {
CircleFit taubin_circle(std::span<const Eigen::Vector2d> points) {
  CircleFit fit;
  const auto n = static_cast<double>(points.size());
  if (points.size() < 4) return fit;
  Eigen::Vector2d mean(0, 0);
  for (const auto& p : points) mean += p / n;
  double xx = 0, yy = 0, xy = 0, xz = 0, yz = 0, zz = 0;
  for (const auto& p : points) {
    const Eigen::Vector2d d = p - mean;
    const double z = d.squaredNorm();
    xx += d.x() * d.x() / n;
    yy += d.y() * d.y() / n;
    xy += d.x() * d.y() / n;
    xz += d.x() * z / n;
    yz += d.y() * z / n;
    zz += z * z / n;
  }
  // Taubin's constraint leads to the smallest root of a cubic in eta, found by Newton's method from zero.
  const double z = xx + yy, cov = xx * yy - xy * xy;
  const double a3 = 4 * z, a2 = -3 * z * z - zz;
  const double a1 = (zz - z * z) * z + 4 * cov * z - xz * xz - yz * yz;
  const double a0 = xz * (xz * yy - yz * xy) + yz * (yz * xx - xz * xy) - (zz - z * z) * cov;
  double eta = 0, value = a0;
  for (int i = 0; i < 30; ++i) {
    const double slope = a1 + eta * (2 * a2 + 3 * eta * a3);
    if (slope == 0) break;
    const double next = eta - value / slope;
    if (!std::isfinite(next) || next == eta) break;
    const double next_value = a0 + next * (a1 + next * (a2 + next * a3));
    if (std::abs(next_value) >= std::abs(value)) break;
    eta = next;
    value = next_value;
  }
  const double det = eta * eta - eta * z + cov;
  if (!(std::abs(det) > 1e-18)) return fit;
  const Eigen::Vector2d shift((xz * (yy - eta) - yz * xy) / det / 2, (yz * (xx - eta) - xz * xy) / det / 2);
  const double squared = shift.squaredNorm() + z;
  if (!shift.allFinite() || !(squared > 0)) return fit;
  fit.centre = mean + shift;
  fit.radius = std::sqrt(squared);
  fit.inliers = points.size();
  fit.ok = true;
  return fit;
}

CircleFit algebraic_circle(std::span<const Eigen::Vector2d> points) {
  CircleFit fit = taubin_circle(points);
  if (!fit.ok) return fit;
  const auto n = static_cast<double>(points.size());
  double sum = 0;
  Sectors seen;
  for (const auto& p : points) {
    const Eigen::Vector2d d = p - fit.centre;
    const double r = d.norm() - fit.radius;
    sum += r * r;
    seen.add(d);
  }
  fit.rms = std::sqrt(sum / n);
  fit.radius_se = fit.rms / std::sqrt(std::max(1.0, n - 3));
  fit.coverage = seen.share();
  return fit;
}

CircleFit robust_circle(std::span<const Eigen::Vector2d> points, const CircleFit& start, double noise_m) {
  constexpr double kTukey = 4.685;
  CircleFit fit = start;
  fit.ok = false;
  if (points.size() < 5 || !start.ok) return fit;
  thread_local std::vector<double> distance, residual, sorted;
  const std::size_t n = points.size();
  distance.resize(n);
  residual.resize(n);
  sorted.resize(n);
  Eigen::Matrix3d normal = Eigen::Matrix3d::Identity();
  double weighted = 0, weights = 0;
  for (int iteration = 0; iteration < 8; ++iteration) {
    for (std::size_t i = 0; i < n; ++i) {
      const double x = points[i].x() - fit.centre.x(), y = points[i].y() - fit.centre.y();
      distance[i] = std::sqrt(x * x + y * y);
      residual[i] = distance[i] - fit.radius;
      sorted[i] = std::abs(residual[i]);
    }
    const double scale = kTukey * std::max(noise_m, 1.4826 * kth_smallest(sorted, n / 2));
    double xx = 0, xy = 0, yx = 0, yy = 0, x1 = 0, y1 = 0;  // of the normal equations
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    weighted = weights = 0;
    fit.inliers = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const double u = residual[i] / scale;
      if (std::abs(u) >= 1 || distance[i] <= 0) continue;
      const double w = (1 - u * u) * (1 - u * u);
      const double x = -(points[i].x() - fit.centre.x()) / distance[i];
      const double y = -(points[i].y() - fit.centre.y()) / distance[i];
      const double wx = w * x, wy = w * y;
      xx += wx * x;
      xy += wx * y;
      yx += wy * x;
      yy += wy * y;
      x1 -= wx;
      y1 -= wy;
      gradient += residual[i] * Eigen::Vector3d(wx, wy, -w);
      weighted += w * residual[i] * residual[i];
      weights += w;
      ++fit.inliers;
    }
    if (fit.inliers < 5) return fit;
    normal << xx, xy, x1, yx, yy, y1, x1, y1, weights;
    const Eigen::Vector3d change = normal.ldlt().solve(gradient);
    if (!change.allFinite()) return fit;
    fit.centre -= change.head<2>();
    fit.radius -= change.z();
    if (!(fit.radius > 0) || fit.radius > 3 * start.radius + noise_m) return fit;
    if (change.norm() < 1e-6) break;
  }
  fit.rms = std::sqrt(weighted / weights);
  const double variance = weighted / std::max(1.0, weights - 3);
  const Eigen::Matrix3d covariance = normal.inverse() * variance;
  fit.radius_se = std::sqrt(std::max(0.0, covariance(2, 2)));
  if (!std::isfinite(fit.radius_se)) return fit;
  Sectors seen;
  for (std::size_t i = 0; i < n; ++i)
    if (std::abs(residual[i]) <= 3 * std::max(noise_m, fit.rms)) seen.add(points[i] - fit.centre);
  fit.coverage = seen.share();
  fit.ok = true;
  return fit;
}

void plane_frame(const Vec3& direction, Vec3& u, Vec3& v) {
  const Vec3 other = std::abs(direction.x()) < 0.7 ? Vec3::UnitX() : Vec3::UnitY();
  u = direction.cross(other).normalized();
  v = direction.cross(u);
}

SpaceCircle circle_along(const std::vector<Vec3>& points, std::span<const std::uint32_t> members,
                         const Vec3& middle, const Vec3& direction) {
  Vec3 u, v;
  plane_frame(direction, u, v);
  std::vector<Eigen::Vector2d> flat;
  flat.reserve(members.size());
  for (const std::uint32_t p : members) {
    const Vec3 d = points[p] - middle;
    flat.emplace_back(d.dot(u), d.dot(v));
  }
  SpaceCircle circle;
  circle.fit = algebraic_circle(flat);
  circle.centre = middle + circle.fit.centre.x() * u + circle.fit.centre.y() * v;
  return circle;
}

}  // namespace dendrofit
