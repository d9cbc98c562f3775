// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/align_scans.h"

#include "recon/cylinder_fit.h"
#include "recon/scan_order.h"
#include "recon/thick_places.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Dense>

namespace dendrofit {
namespace {

/// Middle of the directions in which each scan's points face: whence it saw the tree.
std::vector<Vec3> views_of(const std::vector<Vec3>& points, const std::vector<std::uint16_t>& scan_of,
                           const std::vector<ThickPlace>& places, std::size_t scans) {
  std::vector<Vec3> view(scans, Vec3::Zero());
  for (const ThickPlace& place : places)
    for (const std::uint32_t p : place.node->points) {
      const Eigen::Vector2d d = place.across(points[p]);
      if (d.norm() > 0.5 * place.node->rough_radius_m)
        view[scan_of[p]] += place.point_weight() * (d.x() * place.u + d.y() * place.v).normalized();
    }
  for (Vec3& v : view) v.normalize();
  return view;
}

/// Gauss-Newton on the points' distances from the places' circles. Unknown in common: the scans' shifts, and
/// how much farther than it is thin wood seems to lie towards every scanner (beams that pass it in part
/// flatten its arcs as a shift would); at each place: its middle and radius.
class ShiftFit {
 public:
  ShiftFit(const std::vector<Vec3>& points, const std::vector<std::uint16_t>& scan_of,
           std::vector<ThickPlace> places, std::size_t scans, double noise)
      : points_(points),
        scan_of_(scan_of),
        places_(std::move(places)),
        view_(views_of(points, scan_of, places_, scans)),
        common_(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(3 * scans + 1))),
        thin_(kThinNoises * noise),
        scale_(3 * noise) {
    for (const ThickPlace& place : places_) circle_.emplace_back(0, 0, place.node->rough_radius_m);
  }

  std::vector<Vec3> solve() {
    for (int round = 0; round < kMostRounds && improve() > 1e-6; ++round) {
    }
    std::vector<Vec3> shift;
    for (std::size_t k = 0; k < view_.size(); ++k) shift.push_back(shift_of(k));
    return shift;
  }

 private:
  static constexpr int kMostRounds = 12;
  static constexpr double kTukey = 4.685;
  static constexpr double kRim = 0.8;  // of the radius; where beams graze wood their width sets points off it
  static constexpr double kThinNoises = 8;
  // What hardly any wood tells (shifts along a lone stem) stays near zero: metres, counted as so many points.
  static constexpr double kUsualShift = 0.005, kUsualWeight = 5;
  static constexpr double kOwn = 3;  // radii; keeps the middle of a place seen as a strip finite

  struct Own {
    Eigen::Matrix3d normal;
    Eigen::Vector3d gradient;
    Eigen::Matrix<double, 3, Eigen::Dynamic> with_common;
  };

  Vec3 shift_of(std::size_t scan) const { return common_.segment<3>(static_cast<Eigen::Index>(3 * scan)); }

  /// Equations of one place; what concerns the common unknowns alone is added to `normal` and `gradient`.
  Own equations(std::size_t i, Eigen::MatrixXd& normal, Eigen::VectorXd& gradient) {
    const ThickPlace& place = places_[i];
    const Eigen::Index rim = common_.size() - 1;
    const double radius = place.node->rough_radius_m;
    const double weight = place.point_weight();
    const double hold = weight * std::pow(scale_ / (kOwn * radius), 2);
    Own own{hold * Eigen::Matrix3d::Identity(), hold * (circle_[i] - Eigen::Vector3d(0, 0, radius)), {}};
    own.with_common.setZero(3, common_.size());
    std::vector<Eigen::Vector2d> toward;  // the scanners, seen along the wood
    for (const Vec3& view : view_)
      toward.push_back(Eigen::Vector2d(view.dot(place.u), view.dot(place.v)).normalized());
    for (const std::uint32_t p : place.node->points) {
      const std::size_t k = scan_of_[p];
      const Eigen::Vector2d seen = place.across(points_[p]);
      // Judged across the beam, where range noise moves nothing.
      if (seen.dot(toward[k]) <= 0 ||
          std::abs(seen.x() * toward[k].y() - seen.y() * toward[k].x()) > kRim * radius)
        continue;
      const bool thin = radius < thin_;
      Vec3 moved = points_[p] - shift_of(k);
      if (thin) moved -= common_[rim] * (toward[k].x() * place.u + toward[k].y() * place.v);
      const Eigen::Vector2d d = place.across(moved) - circle_[i].head<2>();
      const double distance = d.norm();
      if (distance <= 0) continue;
      const double residual = distance - circle_[i].z();
      off_.push_back(std::abs(residual));
      const double far = residual / (kTukey * scale_);
      if (std::abs(far) >= 1) continue;
      const double w = weight * (1 - far * far) * (1 - far * far);
      const Eigen::Vector3d by_own(-d.x() / distance, -d.y() / distance, -1);
      const Vec3 by_shift = by_own.x() * place.u + by_own.y() * place.v;
      const double by_rim = thin ? by_own.head<2>().dot(toward[k]) : 0;
      const auto at = static_cast<Eigen::Index>(3 * k);
      // Noise along the beam turns the outward direction as it lengthens the distance: what both are expected
      // to add up to is taken off, or every arc would seem to bulge towards its scanner.
      const Eigen::Vector2d out = d / distance;
      const double cosine = out.dot(toward[k]), variance = scale_ * scale_ / distance;
      const Eigen::Vector2d bulge =
          variance * (cosine * (toward[k] - cosine * out) + 0.5 * (1 - cosine * cosine) * out);
      const double swell = 0.5 * variance * (1 - cosine * cosine);
      own.normal += w * by_own * by_own.transpose();
      own.gradient += w * (residual * by_own + Eigen::Vector3d(bulge.x(), bulge.y(), swell));
      own.with_common.middleCols<3>(at) += w * by_own * by_shift.transpose();
      own.with_common.col(rim) += w * by_rim * by_own;
      normal.block<3, 3>(at, at) += w * by_shift * by_shift.transpose();
      normal.block<3, 1>(at, rim) += w * by_rim * by_shift;
      normal.block<1, 3>(rim, at) += w * by_rim * by_shift.transpose();
      normal(rim, rim) += w * by_rim * by_rim;
      gradient.segment<3>(at) += w * (residual * by_shift + bulge.x() * place.u + bulge.y() * place.v);
      if (thin) gradient[rim] += w * (residual * by_rim + bulge.dot(toward[k]));
    }
    return own;
  }

  /// One step; returns its length.
  double improve() {
    const double hold = kUsualWeight * std::pow(scale_ / kUsualShift, 2);
    Eigen::MatrixXd normal = hold * Eigen::MatrixXd::Identity(common_.size(), common_.size());
    Eigen::VectorXd gradient = hold * common_;
    std::vector<Own> own;
    off_.clear();
    for (std::size_t i = 0; i < places_.size(); ++i) {
      own.push_back(equations(i, normal, gradient));
      // What is left for the rest once the place's own middle and radius are settled (Schur complement).
      const Eigen::Matrix<double, 3, Eigen::Dynamic> settled =
          own.back().normal.ldlt().solve(own.back().with_common);
      normal -= own.back().with_common.transpose() * settled;
      gradient -= settled.transpose() * own.back().gradient;
    }
    if (off_.empty()) return 0;
    const Eigen::VectorXd step = -normal.ldlt().solve(gradient);
    common_ += step;
    for (std::size_t i = 0; i < places_.size(); ++i)
      circle_[i] -= own[i].normal.ldlt().solve(own[i].gradient + own[i].with_common * step);
    const auto half = off_.begin() + static_cast<std::ptrdiff_t>(off_.size() / 2);
    std::nth_element(off_.begin(), half, off_.end());
    scale_ = std::max(0.0005, 1.4826 * *half);
    return step.norm();
  }

  const std::vector<Vec3>& points_;
  const std::vector<std::uint16_t>& scan_of_;
  std::vector<ThickPlace> places_;
  std::vector<Vec3> view_;
  Eigen::VectorXd common_;               // shifts scan by scan, then what thin wood seems nearer by
  std::vector<Eigen::Vector3d> circle_;  // middle across and radius, by place
  std::vector<double> off_;
  double thin_, scale_;
};

/// Whether places that had no say in the shifts are rounder with them: the scatter about each one's own
/// circle falls, by more than three standard errors of the mean over the places that several scans saw.
bool rounder_with(const std::vector<Vec3>& points, const std::vector<std::uint16_t>& scan_of,
                  const std::vector<ThickPlace>& places, const std::vector<Vec3>& shift, double noise) {
  double count = 0, sum = 0, square = 0;
  std::vector<Eigen::Vector2d> as_stored, moved;
  for (const ThickPlace& place : places) {
    as_stored.clear();
    moved.clear();
    bool several = false;
    for (const std::uint32_t p : place.node->points) {
      as_stored.push_back(place.across(points[p]));
      moved.push_back(place.across(points[p] - shift[scan_of[p]]));
      several = several || scan_of[p] != scan_of[place.node->points.front()];
    }
    if (!several) continue;
    const CircleFit before = robust_circle(as_stored, taubin_circle(as_stored), noise);
    const CircleFit after = robust_circle(moved, taubin_circle(moved), noise);
    if (!before.ok || !after.ok || !(before.rms > 0) || !(after.rms > 0)) continue;
    const double gain = std::log(before.rms / after.rms);
    count += 1;
    sum += gain;
    square += gain * gain;
  }
  return sum > 3 * std::sqrt(square - sum * sum / std::max(count, 1.0)) && count > 1;
}

}  // namespace

std::vector<Vec3> scan_shifts(const std::vector<Vec3>& points, const std::vector<std::uint16_t>& scan_of,
                              const std::vector<Limb>& limbs, double noise_m) {
  constexpr std::size_t kFewestPlaces = 20;
  const std::size_t scans = *std::max_element(scan_of.begin(), scan_of.end()) + std::size_t{1};
  if (scans < 2) return {};
  const std::vector<ThickPlace> places = thick_places(limbs, noise_m);
  if (places.size() < kFewestPlaces) return {};
  const auto fit = [&](const std::vector<ThickPlace>& some) {
    return ShiftFit(points, scan_of, some, scans, noise_m).solve();
  };
  std::array<std::vector<ThickPlace>, 2> half;
  for (std::size_t i = 0; i < places.size(); ++i) half[i % 2].push_back(places[i]);
  for (std::size_t h = 0; h < 2; ++h)
    if (!rounder_with(points, scan_of, half[1 - h], fit(half[h]), noise_m)) return {};
  return fit(places);
}

std::vector<Vec3> align_scans(std::vector<Vec3>& points, const std::vector<std::uint32_t>& stored,
                              const std::vector<Limb>& limbs, double noise_m) {
  const std::vector<std::uint16_t> scan_of = scans_by_order(points, stored, limbs, noise_m);
  const std::vector<Vec3> shift = scan_shifts(points, scan_of, limbs, noise_m);
  if (!shift.empty())
    for (std::size_t i = 0; i < points.size(); ++i) points[i] -= shift[scan_of[i]];
  return shift;
}

}  // namespace dendrofit
