// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/cylinder_fit.h"

#include "recon/sectors.h"
#include "recon/select.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

namespace dendrofit {
namespace {

/// Points about a circle, column by column, so that roots and divisions are taken several at a time.
struct Columns {
  std::vector<double> px, py;         // the points
  std::vector<double> x, y;           // direction outward from the circle's middle; none in the middle itself
  std::vector<double> residual, off;  // distance from the circle, and its size
  std::vector<double> weight;

  void set(std::span<const Eigen::Vector2d> points) {
    const std::size_t n = points.size();
    for (std::vector<double>* column : {&px, &py, &x, &y, &residual, &off, &weight}) column->resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      px[i] = points[i].x();
      py[i] = points[i].y();
    }
  }

  void look_from(const CircleFit& circle) {
    const double cx = circle.centre.x(), cy = circle.centre.y(), radius = circle.radius;
    const std::size_t n = px.size();
    const double* __restrict from_x = px.data(), * __restrict from_y = py.data();
    double* __restrict to_x = x.data(), * __restrict to_y = y.data();
    double* __restrict left = residual.data(), * __restrict size = off.data();
    for (std::size_t i = 0; i < n; ++i) {
      const double dx = from_x[i] - cx, dy = from_y[i] - cy;
      const double distance = std::sqrt(dx * dx + dy * dy);
      const double per = 1 / (distance > 0 ? distance : 1);
      to_x[i] = dx * per;
      to_y[i] = dy * per;
      left[i] = distance - radius;
      size[i] = std::abs(left[i]);
    }
  }

  /// Tukey's weights for residuals of standard deviation `scale`.
  void weigh(double scale) {
    constexpr double kTukey = 4.685;
    const double per_limit = 1 / (kTukey * scale);
    const std::size_t n = px.size();
    const double* __restrict from = residual.data();
    double* __restrict to = weight.data();
    for (std::size_t i = 0; i < n; ++i) {
      const double u = from[i] * per_limit;
      const double left = 1 - u * u;
      to[i] = left > 0 ? left * left : 0;
    }
  }
};

}  // namespace

CircleFit taubin_circle(std::span<const Eigen::Vector2d> points) {
  CircleFit fit;
  const auto n = static_cast<double>(points.size());
  if (points.size() < 4) return fit;
  Eigen::Vector2d mean(0, 0);
  for (const auto& p : points) mean += p;
  mean /= n;
  double xx = 0, yy = 0, xy = 0, xz = 0, yz = 0, zz = 0;
  for (const auto& p : points) {
    const Eigen::Vector2d d = p - mean;
    const double z = d.squaredNorm();
    xx += d.x() * d.x();
    yy += d.y() * d.y();
    xy += d.x() * d.y();
    xz += d.x() * z;
    yz += d.y() * z;
    zz += z * z;
  }
  for (double* moment : {&xx, &yy, &xy, &xz, &yz, &zz}) *moment /= n;
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
  CircleFit fit = start;
  fit.ok = false;
  if (points.size() < 5 || !start.ok) return fit;
  thread_local Columns columns;
  columns.set(points);
  const std::size_t n = points.size();
  const std::vector<double>&x = columns.x, &y = columns.y, &residual = columns.residual;
  Eigen::Matrix3d normal = Eigen::Matrix3d::Identity();
  double weighted = 0, weights = 0;
  for (int iteration = 0; iteration < 8; ++iteration) {
    columns.look_from(fit);
    columns.weigh(std::max(noise_m, 1.4826 * kth_smallest(columns.off, n / 2)));
    double xx = 0, xy = 0, yy = 0, x1 = 0, y1 = 0;  // of the normal equations
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    weighted = weights = 0;
    fit.inliers = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const double w = columns.weight[i], wx = w * x[i], wy = w * y[i], off = w * residual[i];
      xx += wx * x[i];
      xy += wx * y[i];
      yy += wy * y[i];
      x1 += wx;
      y1 += wy;
      gradient -= off * Eigen::Vector3d(x[i], y[i], 1);
      weighted += off * residual[i];
      weights += w;
      fit.inliers += w > 0;
    }
    if (fit.inliers < 5) return fit;
    normal << xx, xy, x1, xy, yy, y1, x1, y1, weights;
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
