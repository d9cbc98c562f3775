// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/align_scans.h"

#include "recon/cylinder_fit.h"
#include "recon/scan_order.h"
#include "recon/select.h"
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
           const std::vector<ThickPlace>& places, std::size_t scans, double noise)
      : scans_(scans),
        unknowns_(3 * scans + 1),
        common_(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(unknowns_))),
        scale_(3 * noise) {
    const std::vector<Vec3> views = views_of(points, scan_of, places, scans);
    for (const ThickPlace& place : places) add(place, points, scan_of, views, noise);
    settled_.resize(places_.size() * 3 * unknowns_);
  }

  std::vector<Vec3> solve() {
    for (int round = 0; round < kMostRounds && improve() > 1e-6; ++round) {
    }
    std::vector<Vec3> shift;
    for (std::size_t k = 0; k < scans_; ++k) shift.push_back(shift_of(k));
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

  /// A point that has a say, seen along its place's wood.
  struct Seen {
    Eigen::Vector2d at;
    std::size_t scan;
  };

  struct Place {
    Vec3 u, v;
    double radius = 0, weight = 0;
    bool thin = false;
    std::size_t first = 0, last = 0;                 // of seen_
    Eigen::Vector3d circle{0, 0, 0};                 // middle across and radius
    Eigen::Matrix3d root = Eigen::Matrix3d::Zero();  // Cholesky factor of its circle's normal equations
    Eigen::Vector3d settled{0, 0, 0};                // the root's inverse times their gradient
  };

  /// Sums over the points of one scan at one place: of the weights times one, the outward direction, its
  /// outer product with itself, and the gradients by the middle and by the radius.
  struct Sums {
    double weight = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0, by_x = 0, by_y = 0, by_radius = 0;
  };

  void add(const ThickPlace& thick, const std::vector<Vec3>& points,
           const std::vector<std::uint16_t>& scan_of, const std::vector<Vec3>& views, double noise) {
    const double radius = thick.node->rough_radius_m;
    Place place{.u = thick.u,
                .v = thick.v,
                .radius = radius,
                .weight = thick.point_weight(),
                .thin = radius < kThinNoises * noise,
                .first = seen_.size(),
                .circle = {0, 0, radius}};
    const std::size_t scanners = toward_.size();
    for (const Vec3& view : views)
      toward_.push_back(Eigen::Vector2d(view.dot(place.u), view.dot(place.v)).normalized());
    for (const std::uint32_t p : thick.node->points) {
      const std::size_t k = scan_of[p];
      const Eigen::Vector2d at = thick.across(points[p]), toward = toward_[scanners + k];
      // Judged across the beam, where range noise moves nothing.
      if (at.dot(toward) > 0 && std::abs(at.x() * toward.y() - at.y() * toward.x()) <= kRim * radius)
        seen_.push_back({at, k});
    }
    place.last = seen_.size();
    places_.push_back(place);
  }

  Vec3 shift_of(std::size_t scan) const { return common_.segment<3>(static_cast<Eigen::Index>(3 * scan)); }

  /// Sums of one place by scan.
  void gather(const Place& place, const Eigen::Vector2d* toward) {
    sums_.assign(scans_, {});
    offset_.clear();
    for (std::size_t k = 0; k < scans_; ++k) {
      const Vec3 shift = shift_of(k);
      Eigen::Vector2d offset(shift.dot(place.u), shift.dot(place.v));
      if (place.thin) offset += common_[common_.size() - 1] * toward[k];
      offset_.push_back(offset + place.circle.head<2>());
    }
    for (std::size_t i = place.first; i < place.last; ++i) {
      const std::size_t k = seen_[i].scan;
      const Eigen::Vector2d d = seen_[i].at - offset_[k];
      const double distance = d.norm();
      if (distance <= 0) continue;
      const double residual = distance - place.circle.z();
      off_.push_back(std::abs(residual));
      const double far = residual / (kTukey * scale_);
      if (std::abs(far) >= 1) continue;
      const double w = place.weight * (1 - far * far) * (1 - far * far);
      // Noise along the beam turns the outward direction as it lengthens the distance: what both are expected
      // to add up to is taken off, or every arc would seem to bulge towards its scanner.
      const Eigen::Vector2d out = d / distance;
      const double cosine = out.dot(toward[k]), variance = scale_ * scale_ / distance;
      const double swell = 0.5 * variance * (1 - cosine * cosine);
      const Eigen::Vector2d bulge = variance * cosine * (toward[k] - cosine * out) + swell * out;
      Sums& s = sums_[k];
      s.weight += w;
      s.x += w * out.x();
      s.y += w * out.y();
      s.xx += w * out.x() * out.x();
      s.xy += w * out.x() * out.y();
      s.yy += w * out.y() * out.y();
      s.by_x += w * (bulge.x() - residual * out.x());
      s.by_y += w * (bulge.y() - residual * out.y());
      s.by_radius += w * (swell - residual);
    }
  }

  /// Adds a place to the equations of the common unknowns, less what its own middle and radius take up (Schur
  /// complement). Of `normal` the lower triangle alone.
  void add_equations(std::size_t i, Eigen::MatrixXd& normal, Eigen::VectorXd& gradient) {
    Place& place = places_[i];
    const Eigen::Vector2d* toward = toward_.data() + i * scans_;
    gather(place, toward);
    const Eigen::Index rim = common_.size() - 1;
    const double hold = place.weight * std::pow(scale_ / (kOwn * place.radius), 2);
    Eigen::Matrix3d own = hold * Eigen::Matrix3d::Identity();
    Eigen::Vector3d own_gradient = hold * (place.circle - Eigen::Vector3d(0, 0, place.radius));
    Eigen::Matrix<double, 2, 3> across;
    across << place.u.transpose(), place.v.transpose();
    using Rows = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor>;
    Eigen::Map<Rows> with_common(settled_.data() + i * 3 * unknowns_, 3,
                                 static_cast<Eigen::Index>(unknowns_));
    with_common.setZero();
    for (std::size_t k = 0; k < scans_; ++k) {
      const Sums& s = sums_[k];
      if (!(s.weight > 0)) continue;
      Eigen::Matrix2d square;
      square << s.xx, s.xy, s.xy, s.yy;
      const Eigen::Vector2d out(s.x, s.y), by(s.by_x, s.by_y);
      own.topLeftCorner<2, 2>() += square;
      own.bottomLeftCorner<1, 2>() += out.transpose();
      own(2, 2) += s.weight;
      own_gradient += Eigen::Vector3d(s.by_x, s.by_y, s.by_radius);
      const auto at = static_cast<Eigen::Index>(3 * k);
      const Eigen::Matrix<double, 2, 3> moved = square * across;
      with_common.block<2, 3>(0, at) = moved;
      with_common.block<1, 3>(2, at) = out.transpose() * across;
      normal.block<3, 3>(at, at) += across.transpose() * moved;
      gradient.segment<3>(at) += across.transpose() * by;
      if (!place.thin) continue;
      const Eigen::Vector2d flattened = square * toward[k];
      with_common.col(rim) += Eigen::Vector3d(flattened.x(), flattened.y(), out.dot(toward[k]));
      normal.block<1, 3>(rim, at) += flattened.transpose() * across;
      normal(rim, rim) += flattened.dot(toward[k]);
      gradient[rim] += by.dot(toward[k]);
    }
    place.root = own.llt().matrixL();
    const auto root = place.root.triangularView<Eigen::Lower>();
    place.settled = root.solve(own_gradient);
    // Forward substitution, row by row.
    with_common.row(0) /= place.root(0, 0);
    with_common.row(1) = (with_common.row(1) - place.root(1, 0) * with_common.row(0)) / place.root(1, 1);
    with_common.row(2) =
        (with_common.row(2) - place.root(2, 0) * with_common.row(0) - place.root(2, 1) * with_common.row(1)) /
        place.root(2, 2);
    gradient -= with_common.transpose() * place.settled;
    for (Eigen::Index c = 0; c <= rim; ++c)
      for (Eigen::Index r = c; r <= rim; ++r)
        normal(r, c) -= with_common(0, r) * with_common(0, c) + with_common(1, r) * with_common(1, c) +
                        with_common(2, r) * with_common(2, c);
  }

  /// One step; returns its length.
  double improve() {
    const double hold = kUsualWeight * std::pow(scale_ / kUsualShift, 2);
    Eigen::MatrixXd normal = hold * Eigen::MatrixXd::Identity(common_.size(), common_.size());
    Eigen::VectorXd gradient = hold * common_;
    off_.clear();
    for (std::size_t i = 0; i < places_.size(); ++i) add_equations(i, normal, gradient);
    if (off_.empty()) return 0;
    const Eigen::VectorXd step = -normal.ldlt().solve(gradient);
    common_ += step;
    for (std::size_t i = 0; i < places_.size(); ++i) {
      using Rows = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor>;
      const Eigen::Map<const Rows> settled(settled_.data() + i * 3 * unknowns_, 3,
                                           static_cast<Eigen::Index>(unknowns_));
      Place& place = places_[i];
      const Eigen::Vector3d left = place.settled + settled * step;
      place.circle -= place.root.transpose().triangularView<Eigen::Upper>().solve(left);
    }
    scale_ = std::max(0.0005, 1.4826 * kth_smallest(off_, off_.size() / 2));
    return step.norm();
  }

  std::size_t scans_, unknowns_;
  std::vector<Place> places_;
  std::vector<Seen> seen_;               // place by place
  std::vector<Eigen::Vector2d> toward_;  // the scanners, seen along the wood, place by place
  std::vector<double> settled_;          // place by place: the root's inverse times its circle's rows
  Eigen::VectorXd common_;               // shifts scan by scan, then what thin wood seems nearer by
  std::vector<Sums> sums_;
  std::vector<Eigen::Vector2d> offset_;
  std::vector<double> off_;
  double scale_;
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
