// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/intervals.h"

#include "recon/cylinder_fit.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dendrofit {
namespace {

constexpr double k95 = 1.96;
constexpr double kAllRound = 0.8;       // share of the girth that an ellipse needs
constexpr double kCommonShare = 0.012;  // of every radius: sections are no circles
constexpr double kCommonNoise = 0.25;   // of the noise: what its correction may be off by

/// The points of a limb between `low` and `high` metres along `direction` from `middle`, seen along it.
std::vector<Eigen::Vector2d> flatten(const std::vector<Vec3>& points, const Limb& limb, const Vec3& middle,
                                     const Vec3& direction, double low, double high) {
  Vec3 u, v;
  plane_frame(direction, u, v);
  std::vector<Eigen::Vector2d> flat;
  for (const LimbNode& n : limb.nodes) {
    if (std::abs(n.centre.z() - middle.z()) > 0.5) continue;
    for (const std::uint32_t p : n.points) {
      const Vec3 d = points[p] - middle;
      const double along = d.dot(direction);
      if (along >= low && along <= high) flat.emplace_back(d.dot(u), d.dot(v));
    }
  }
  return flat;
}

/// How much the diameters of thin slices about a height disagree, once taper is taken off.
double slice_scatter(const std::vector<Vec3>& points, const Limb& limb, const Vec3& middle,
                     const Vec3& direction, const CircleFit& about, double noise) {
  constexpr int kSlices = 5;
  constexpr double kSlice_m = 0.12;
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0, syy = 0;
  for (int k = 0; k < kSlices; ++k) {
    const double x = (k - kSlices / 2) * kSlice_m;
    CircleFit start;
    start.ok = true;
    start.radius = about.radius;
    start.centre = about.centre;
    const CircleFit fit = robust_circle(
        flatten(points, limb, middle, direction, x - 0.5 * kSlice_m, x + 0.5 * kSlice_m), start, noise);
    if (!fit.ok || fit.inliers < 8 || std::abs(fit.radius - about.radius) > 0.3 * about.radius) continue;
    const double d = 2 * fit.radius;
    n += 1, sx += x, sy += d, sxx += x * x, sxy += x * d, syy += d * d;
  }
  if (n < 4) return 0;
  const double vx = sxx - sx * sx / n, cxy = sxy - sx * sy / n, vy = syy - sy * sy / n;
  return std::sqrt(std::max(0.0, vy - cxy * cxy / vx) / (n - 2));
}

std::optional<SliceDiameter> slice_of(const std::vector<Vec3>& points, const Limb& limb, double z,
                                      double noise) {
  std::size_t at = 0;
  double least = 1e300;
  for (std::size_t i = 0; i < limb.nodes.size(); ++i)
    if (std::abs(limb.nodes[i].centre.z() - z) < least) {
      least = std::abs(limb.nodes[i].centre.z() - z);
      at = i;
    }
  const LimbNode& node = limb.nodes[at];
  if (least > 0.3) return std::nullopt;
  const Vec3 direction = direction_at(limb, at);
  if (direction.z() < 0.3) return std::nullopt;
  const Vec3 middle = node.centre + direction * ((z - node.centre.z()) / direction.z());
  std::vector<Eigen::Vector2d> flat;
  for (double half = 0.1; half < 0.31 && flat.size() < 40; half += 0.1)
    flat = flatten(points, limb, middle, direction, -half, half);
  CircleFit start;
  start.ok = true;
  start.radius = node.radius_m;
  const double about = std::max(0.5 * noise, 0.02 * node.radius_m);
  CircleFit fit = robust_circle(flat, start, about);
  if (!fit.ok || fit.coverage < 0.3 || fit.inliers < 12 || 2 * fit.inliers < flat.size() ||
      std::abs(fit.radius - node.radius_m) > 0.3 * node.radius_m || fit.radius < 2 * noise)
    return std::nullopt;
  const double radius = fit.radius - std::min(fit.rms * fit.rms, noise * noise) / (2 * fit.radius);
  SliceDiameter slice{2 * radius, 2 * fit.radius_se, fit.coverage,
                      slice_scatter(points, limb, middle, direction, fit, about)};
  if (fit.coverage >= kAllRound) {
    const double near = 3 * std::max(about, fit.rms);
    std::erase_if(flat, [&](const Eigen::Vector2d& p) {
      return std::abs((p - fit.centre).norm() - fit.radius) > near;
    });
    slice.ellipse = fit_ellipse(flat);
  }
  return slice;
}

}  // namespace

std::optional<SliceDiameter> slice_diameter(const std::vector<Vec3>& points, const std::vector<Limb>& limbs,
                                            double z, double noise_m) {
  const Limb* thickest = nullptr;
  double most = 0;
  for (const Limb& limb : limbs)
    for (const LimbNode& n : limb.nodes)
      if (std::abs(n.centre.z() - z) < 0.1 && n.radius_m > most) {
        most = n.radius_m;
        thickest = &limb;
      }
  if (!thickest) return std::nullopt;
  return slice_of(points, *thickest, z, noise_m);
}

void estimate_intervals(const Tree& tree, const std::optional<SliceDiameter>& dbh, double noise_m,
                        double spacing_m, TreeMetrics& metrics) {
  const auto about = [](double value, double se) {
    return Interval{value, std::max(0.0, value - k95 * se), value + k95 * se};
  };
  if (metrics.dbh_m) {
    const double fit_se = dbh ? dbh->se_m / std::sqrt(std::max(0.1, dbh->coverage)) : 0.05 * *metrics.dbh_m;
    metrics.intervals["dbh_m"] =
        about(*metrics.dbh_m, std::hypot(fit_se, 0.3 * noise_m, 0.005 * *metrics.dbh_m));
  }
  metrics.intervals["height_m"] =
      about(metrics.height_m, 0.5 * std::hypot(0.03, 2 * (spacing_m + noise_m), 0.004 * metrics.height_m));
  double stem = 0, all = 0, stem_guess = 0, all_guess = 0;
  for (std::size_t i = 0; i < tree.size(); ++i) {
    const double per_radius = 2 * std::numbers::pi * tree.radius[i] * tree.length(i);
    const bool measured = tree.quality[i] == RadiusQuality::measured;
    const double common = per_radius * std::hypot(kCommonShare * tree.radius[i], kCommonNoise * noise_m);
    const double guess = measured || !std::isfinite(tree.radius_se[i])
                             ? 0
                             : per_radius * std::min(0.5 * tree.radius[i], tree.radius_se[i]);
    all += common;
    all_guess += guess;
    if (tree.order[i] > 0) continue;
    stem += common;
    stem_guess += guess;
  }
  metrics.intervals["stem_volume_m3"] = about(metrics.stem_volume_m3, std::hypot(stem, 0.5 * stem_guess));
  metrics.intervals["total_volume_m3"] = about(metrics.total_volume_m3, std::hypot(all, 0.5 * all_guess));
}

}  // namespace dendrofit
