// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/align_scans.h"

#include "recon/cylinder_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Dense>

namespace dendrofit {
namespace {

constexpr double kThinnest = 0.012;       // radius of wood whose sides can be told apart, metres,
constexpr double kThinnestNoises = 4;     // ... and in noises
constexpr std::size_t kFewestPoints = 8;  // of one place on a limb

/// One place on thick wood: a short cylinder and the points about it.
struct Place {
  const LimbNode* node;
  Vec3 u, v;  // across
};

std::vector<Place> thick_places(const std::vector<Limb>& limbs, double noise) {
  std::vector<Place> places;
  for (const Limb& limb : limbs) {
    if (limb.nodes.size() < 2) continue;
    for (std::size_t i = 0; i < limb.nodes.size(); ++i) {
      const LimbNode& node = limb.nodes[i];
      if (node.rough_radius_m < std::max(kThinnest, kThinnestNoises * noise) ||
          node.points.size() < kFewestPoints)
        continue;
      Place place{&node, {}, {}};
      plane_frame(direction_at(limb, i), place.u, place.v);
      places.push_back(place);
    }
  }
  return places;
}

Eigen::Vector2d across(const Place& place, const Vec3& point) {
  const Vec3 d = point - place.node->centre;
  return {d.dot(place.u), d.dot(place.v)};
}

/// Thick stems have most points and are the least round: a place counts as so many points at most.
double place_weight(std::size_t points) {
  constexpr double kMost = 20;
  return std::min(1.0, kMost / static_cast<double>(points));
}

/// Middle of the directions in which each scan's points face: whence it saw the tree.
std::vector<Vec3> views_of(const std::vector<Vec3>& points, const std::vector<std::uint16_t>& scan_of,
                           const std::vector<Place>& places, std::size_t scans) {
  std::vector<Vec3> view(scans, Vec3::Zero());
  for (const Place& place : places)
    for (const std::uint32_t p : place.node->points) {
      const Eigen::Vector2d d = across(place, points[p]);
      if (d.norm() > 0.5 * place.node->rough_radius_m)
        view[scan_of[p]] +=
            place_weight(place.node->points.size()) * (d.x() * place.u + d.y() * place.v).normalized();
    }
  for (Vec3& v : view) v.normalize();
  return view;
}

/// A stretch of the file's points, with the sums of their outward directions.
struct Stretch {
  std::uint32_t first = 0;  // place in the file of its first point
  double weight = 0;
  Vec3 out = Vec3::Zero();
};

struct Facing {
  std::uint32_t stored;
  double weight;
  Vec3 out;
};

/// Stretches of equal weight in the file's order.
std::vector<Stretch> stretches_of(std::vector<Facing>& facings, std::size_t most) {
  std::sort(facings.begin(), facings.end(),
            [](const Facing& a, const Facing& b) { return a.stored < b.stored; });
  double total = 0;
  for (const Facing& f : facings) total += f.weight;
  std::vector<Stretch> stretches;
  double before = 0;
  for (const Facing& f : facings) {
    if (before >= total * static_cast<double>(stretches.size()) / static_cast<double>(most)) {
      stretches.emplace_back();
      stretches.back().first = f.stored;
    }
    Stretch& s = stretches.back();
    s.weight += f.weight;
    s.out += f.weight * f.out;
    before += f.weight;
  }
  return stretches;
}

/// Ends of `count` runs of stretches whose outward directions agree best within each run, for every count up
/// to `most` (dynamic programming).
std::vector<std::vector<std::size_t>> best_runs(const std::vector<Stretch>& stretches, std::size_t most) {
  const std::size_t n = stretches.size();
  std::vector<double> weight(n + 1, 0);
  std::vector<Vec3> out(n + 1, Vec3::Zero());
  for (std::size_t i = 0; i < n; ++i) {
    weight[i + 1] = weight[i] + stretches[i].weight;
    out[i + 1] = out[i] + stretches[i].out;
  }
  const auto cost = [&](std::size_t a, std::size_t b) {  // spread of the directions of stretches a..b-1
    const double w = weight[b] - weight[a];
    return w - (out[b] - out[a]).squaredNorm() / w;
  };
  std::vector<std::vector<std::size_t>> from(most, std::vector<std::size_t>(n + 1, 0));
  std::vector<double> least(n + 1, 0), next(n + 1);
  for (std::size_t b = 1; b <= n; ++b) least[b] = cost(0, b);
  std::vector<std::vector<std::size_t>> ends = {{n}};
  for (std::size_t k = 1; k < most && k < n; ++k) {
    next.assign(n + 1, std::numeric_limits<double>::infinity());
    for (std::size_t b = k + 1; b <= n; ++b)
      for (std::size_t a = k; a < b; ++a)
        if (const double c = least[a] + cost(a, b); c < next[b]) {
          next[b] = c;
          from[k][b] = a;
        }
    least.swap(next);
    std::vector<std::size_t> runs(k + 1);
    runs[k] = n;
    for (std::size_t j = k; j > 0; --j) runs[j - 1] = from[j][runs[j]];
    ends.push_back(std::move(runs));
  }
  return ends;
}

}  // namespace

std::vector<std::uint16_t> scans_by_order(const std::vector<Vec3>& points,
                                          const std::vector<std::uint32_t>& stored,
                                          const std::vector<Limb>& limbs, double noise_m) {
  constexpr std::size_t kStretches = 512;
  constexpr std::size_t kMostScans = 16;
  constexpr double kAround = -0.1;       // cosine to the middle direction: a scan sees no farther around
  constexpr double kBeyond = 0.055;      // share of points that noise puts there all the same
  constexpr std::size_t kFewest = 2000;  // points
  std::vector<std::uint16_t> scan_of(points.size(), 0);
  std::vector<Facing> facings;
  for (const Place& place : thick_places(limbs, noise_m))
    for (const std::uint32_t p : place.node->points) {
      const Eigen::Vector2d d = across(place, points[p]);
      if (std::abs(d.norm() - place.node->rough_radius_m) > 0.5 * place.node->rough_radius_m) continue;
      facings.push_back({stored[p], place_weight(place.node->points.size()),
                         (d.x() * place.u + d.y() * place.v).normalized()});
    }
  if (facings.size() < kFewest) return scan_of;
  const std::vector<Stretch> stretches = stretches_of(facings, kStretches);
  for (const std::vector<std::size_t>& ends : best_runs(stretches, kMostScans)) {
    bool one_sided = true;
    std::size_t begin = 0, f = 0;
    for (const std::size_t end : ends) {
      Vec3 middle = Vec3::Zero();
      for (std::size_t s = begin; s < end; ++s) middle += stretches[s].out;
      middle.normalize();
      double all = 0, beyond = 0;
      for (; f < facings.size() && (end == stretches.size() || facings[f].stored < stretches[end].first);
           ++f) {
        all += facings[f].weight;
        if (facings[f].out.dot(middle) < kAround) beyond += facings[f].weight;
      }
      one_sided = one_sided && beyond <= kBeyond * all;
      begin = end;
    }
    if (!one_sided) continue;
    for (std::size_t i = 0; i < points.size(); ++i)
      for (std::size_t k = 0; k + 1 < ends.size(); ++k)
        if (stored[i] >= stretches[ends[k]].first) scan_of[i] = static_cast<std::uint16_t>(k + 1);
    break;
  }
  return scan_of;
}

std::vector<Vec3> scan_shifts(const std::vector<Vec3>& points, const std::vector<std::uint16_t>& scan_of,
                              const std::vector<Limb>& limbs, double noise_m) {
  constexpr int kRounds = 12;
  constexpr double kTukey = 4.685;
  constexpr double kSteep = 0.6;        // cosine; where beams graze the wood their width sets points off it
  constexpr double kUsualShift = 0.01;  // metres; holds shifts that no wood tells at zero
  constexpr double kOwn = 0.3;          // in radii: a place's middle and radius are that far off at the start
  const std::size_t scans = *std::max_element(scan_of.begin(), scan_of.end()) + std::size_t{1};
  std::vector<Vec3> shift(scans, Vec3::Zero());
  if (scans < 2) return {};
  const std::vector<Place> places = thick_places(limbs, noise_m);
  const std::vector<Vec3> view = views_of(points, scan_of, places, scans);
  std::vector<Eigen::Vector3d> circle(places.size());  // middle across, radius
  for (std::size_t i = 0; i < places.size(); ++i)
    circle[i] = Eigen::Vector3d(0, 0, places[i].node->rough_radius_m);
  const auto size = static_cast<Eigen::Index>(3 * scans);
  double scale = 3 * noise_m;
  std::vector<double> off;
  for (int round = 0; round < kRounds; ++round) {
    Eigen::MatrixXd normal = Eigen::MatrixXd::Identity(size, size) * std::pow(scale / kUsualShift, 2);
    Eigen::VectorXd gradient(size);
    for (std::size_t k = 0; k < scans; ++k)
      gradient.segment<3>(static_cast<Eigen::Index>(3 * k)) = shift[k] * std::pow(scale / kUsualShift, 2);
    struct Own {
      Eigen::Matrix3d normal;
      Eigen::Vector3d gradient;
      Eigen::Matrix<double, 3, Eigen::Dynamic> with_shifts;
    };
    std::vector<Own> own(places.size());
    off.clear();
    for (std::size_t i = 0; i < places.size(); ++i) {
      const Place& place = places[i];
      const double weight = place_weight(place.node->points.size());
      const double hold = weight * std::pow(scale / (kOwn * place.node->rough_radius_m), 2);
      Own& o = own[i];
      o.normal = hold * Eigen::Matrix3d::Identity();
      o.gradient = hold * (circle[i] - Eigen::Vector3d(0, 0, place.node->rough_radius_m));
      o.with_shifts.setZero(3, size);
      std::vector<Eigen::Vector2d> toward(scans);  // the scans, seen along the wood
      for (std::size_t k = 0; k < scans; ++k)
        toward[k] = Eigen::Vector2d(view[k].dot(place.u), view[k].dot(place.v)).normalized();
      for (const std::uint32_t p : place.node->points) {
        const auto at = static_cast<Eigen::Index>(3 * scan_of[p]);
        const Eigen::Vector2d d = across(place, points[p] - shift[scan_of[p]]) - circle[i].head<2>();
        const double distance = d.norm();
        if (distance <= 0 || d.dot(toward[scan_of[p]]) < kSteep * distance) continue;
        const double residual = distance - circle[i].z();
        off.push_back(std::abs(residual));
        const double far = residual / (kTukey * scale);
        if (std::abs(far) >= 1) continue;
        const double w = weight * (1 - far * far) * (1 - far * far);
        const Eigen::Vector3d by_own(-d.x() / distance, -d.y() / distance, -1);
        const Vec3 by_shift = by_own.x() * place.u + by_own.y() * place.v;
        o.normal += w * by_own * by_own.transpose();
        o.gradient += w * residual * by_own;
        o.with_shifts.middleCols<3>(at) += w * by_own * by_shift.transpose();
        normal.block<3, 3>(at, at) += w * by_shift * by_shift.transpose();
        gradient.segment<3>(at) += w * residual * by_shift;
      }
      // What is left for the shifts once the place's own middle and radius are settled (Schur complement).
      const Eigen::Matrix<double, 3, Eigen::Dynamic> settled = o.normal.ldlt().solve(o.with_shifts);
      normal -= o.with_shifts.transpose() * settled;
      gradient -= settled.transpose() * o.gradient;
    }
    const Eigen::VectorXd step = -normal.ldlt().solve(gradient);
    for (std::size_t k = 0; k < scans; ++k) shift[k] += step.segment<3>(static_cast<Eigen::Index>(3 * k));
    for (std::size_t i = 0; i < places.size(); ++i)
      circle[i] -= own[i].normal.ldlt().solve(own[i].gradient + own[i].with_shifts * step);
    if (off.empty()) break;
    const auto half = off.begin() + static_cast<std::ptrdiff_t>(off.size() / 2);
    std::nth_element(off.begin(), half, off.end());
    scale = std::max(0.0005, 1.4826 * *half);
    if (step.norm() < 1e-6) break;
  }
  return shift;
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
