// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/sights.h"

#include "core/parallel.h"
#include "recon/select.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Dense>

namespace dendrofit {
namespace {

constexpr double kShortestWindow = 0.03;  // half the length along which points are seen together, metres
constexpr double kLongestWindow = 0.10;   // more where wood is thick: its taper and bends are slow
constexpr double kLongestRadii = 3;
constexpr std::size_t kEnoughPoints = 14;
constexpr std::size_t kFewestPoints = 6;
constexpr double kArcOnly = 4;  // radii in noises: thicker wood is judged by circles alone
constexpr double kUnseen = std::numeric_limits<double>::infinity();

/// A limb's points, node by node, each relative to its node and without its part along the line there: the
/// line's own bends do not widen the wood.
struct Offsets {
  std::vector<std::size_t> first;  // of each node's, then of all
  std::vector<Vec3> across;

  void set(const std::vector<Vec3>& points, const Limb& limb) {
    first.assign(1, 0);
    across.clear();
    for (std::size_t j = 0; j < limb.nodes.size(); ++j) {
      const LimbNode& n = limb.nodes[j];
      const Vec3 direction = direction_at(limb, j);
      for (const std::uint32_t p : n.points) {
        Vec3 d = points[p] - n.centre;
        d -= direction * d.dot(direction);
        across.push_back(d);
      }
      first.push_back(across.size());
    }
  }
};

/// The points about one node, seen along the centre line.
struct View {
  std::vector<Eigen::Vector2d> flat;
  Vec3 u, v;
};

/// Looks through a window that is half as wide again until enough points are seen, or it is `longest` or
/// more.
void look(const Limb& limb, const Offsets& offsets, std::size_t node, double half_window, double longest,
          View& view) {
  const double here = limb.nodes[node].along_m;
  std::size_t begin = node, end = node + 1;
  for (;; half_window *= 1.5) {
    while (begin > 0 && here - limb.nodes[begin - 1].along_m <= half_window) --begin;
    while (end < limb.nodes.size() && limb.nodes[end].along_m - here <= half_window) ++end;
    if (offsets.first[end] - offsets.first[begin] >= kEnoughPoints || half_window >= longest) break;
  }
  view.flat.clear();
  plane_frame(direction_at(limb, node), view.u, view.v);
  const auto add = [&](std::size_t j) {
    for (std::size_t k = offsets.first[j]; k < offsets.first[j + 1]; ++k)
      view.flat.emplace_back(offsets.across[k].dot(view.u), offsets.across[k].dot(view.v));
  };
  add(node);
  for (std::size_t j = node; j-- > begin;) add(j);
  for (std::size_t j = node + 1; j < end; ++j) add(j);
}

Spread spread_of(const std::vector<Eigen::Vector2d>& flat) {
  constexpr double kFarthest = 6;  // medians of the squared distance; noise alone leaves 2 % beyond
  constexpr double kMiddle = 3;    // a twig's base pulls the middle from nearer
  Spread spread;
  if (flat.size() < kFewestPoints) return spread;
  thread_local std::vector<double> square, order;
  square.resize(flat.size());
  const auto set_squares = [&] {
    for (std::size_t i = 0; i < flat.size(); ++i) square[i] = (flat[i] - spread.middle).squaredNorm();
  };
  set_squares();
  double limit = 1e300, half = 0;
  for (int pass = 0; pass < 4; ++pass) {
    Eigen::Vector2d sum(0, 0);
    std::size_t count = 0;
    double squares = 0;
    for (std::size_t i = 0; i < flat.size(); ++i) {
      if (square[i] > limit) continue;
      sum += flat[i];
      squares += square[i];
      ++count;
    }
    if (count < 3) break;
    spread.count = count;
    spread.square = squares / static_cast<double>(count);
    if (pass == 3) break;  // about the last pass's middle
    const Eigen::Vector2d middle = sum / static_cast<double>(count);
    if (pass == 0 || middle != spread.middle) {  // else the same points had a say as before
      spread.middle = middle;
      set_squares();
      order = square;
      half = kth_smallest(order, order.size() / 2);
    }
    limit = (pass < 2 ? kMiddle : kFarthest) * half;
  }
  const auto n = static_cast<double>(spread.count);
  spread.square *= n / (n - 1);
  return spread;
}

/// A circle that describes the points well enough to replace their spread.
CircleFit sound_circle(const View& view, const LimbNode& node, double apparent, double noise) {
  if (node.rough_radius_m < 2 * noise || view.flat.size() < kEnoughPoints) return {};
  CircleFit fit = taubin_circle(view.flat);
  if (!fit.ok || fit.radius > 2.5 * std::max(apparent, node.rough_radius_m)) return {};
  fit = robust_circle(view.flat, fit, noise);
  const bool sound = fit.ok && fit.coverage >= 0.3 && fit.radius > 2.5 * noise &&
                     fit.rms < std::max(1.5 * noise, 0.3 * fit.radius) &&
                     2 * fit.inliers >= view.flat.size() && fit.radius < 2.2 * node.rough_radius_m + noise;
  return sound ? fit : CircleFit{};
}

}  // namespace

Sights look_at_limbs(const std::vector<Vec3>& points, const std::vector<Limb>& limbs,
                     const SightOptions& options, Progress& progress) {
  return look_at_some_limbs(points, limbs, std::vector<char>(limbs.size(), 1), options, progress);
}

Sights look_at_some_limbs(const std::vector<Vec3>& points, const std::vector<Limb>& limbs,
                          const std::vector<char>& wanted, const SightOptions& options, Progress& progress) {
  Sights sights(limbs.size());
  parallel_blocks(limbs.size(), 64, options.threads, [&](std::size_t first, std::size_t last) {
    progress.check();
    View view;
    Offsets offsets;
    for (std::size_t l = first; l < last; ++l) {
      if (!wanted[l]) continue;
      const Limb& limb = limbs[l];
      sights[l].assign(limb.nodes.size(), {});
      offsets.set(points, limb);
      for (std::size_t i = 0; i < limb.nodes.size(); ++i) {
        const LimbNode& node = limb.nodes[i];
        Sight& sight = sights[l][i];
        sight.centre = node.centre;
        sight.centre_se = kUnseen;
        const double longest = std::max(kLongestWindow, kLongestRadii * node.rough_radius_m);
        look(limb, offsets, i, std::max(kShortestWindow, 0.6 * node.rough_radius_m), longest, view);
        sight.spread = spread_of(view.flat);
        if (sight.spread.count == 0) continue;
        const double apparent = std::sqrt(sight.spread.square);
        sight.circle = sound_circle(view, node, apparent, options.noise_m);
        if (!sight.circle.ok && node.rough_radius_m > kArcOnly * options.noise_m) {
          // A strip of thick wood's surface tells neither its middle nor its width: the sections' course
          // holds.
          sight.spread = {};
          sight.centre_se = 0.3 * node.rough_radius_m;
          continue;
        }
        const Eigen::Vector2d off = sight.circle.ok ? sight.circle.centre : sight.spread.middle;
        sight.centre = node.centre + off.x() * view.u + off.y() * view.v;
        // A cluster seen from one side has its middle off the axis by about half its radius.
        sight.centre_se = sight.circle.ok ? 1.5 * sight.circle.radius_se + 0.1 * options.noise_m
                                          : apparent / std::sqrt(static_cast<double>(sight.spread.count)) +
                                                0.25 * std::max(0.0, node.rough_radius_m - options.noise_m);
      }
    }
  });
  return sights;
}

void centre_limbs(std::vector<Limb>& limbs, const Sights& sights, const SightOptions& options) {
  std::vector<Vec3> next;
  for (std::size_t l = 0; l < limbs.size(); ++l) {
    if (sights[l].empty()) continue;
    Limb& limb = limbs[l];
    const std::size_t n = limb.nodes.size();
    next.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      // Local line through the seen centres about this place, weighted by nearness and certainty.
      const double here = limb.nodes[i].along_m;
      const double reach = std::clamp(1.5 * limb.nodes[i].rough_radius_m, 0.05, 0.25);
      double w0 = 0, w1 = 0, w2 = 0;
      Vec3 p0 = Vec3::Zero(), p1 = Vec3::Zero();
      const auto add = [&](std::size_t j) {
        const double t = limb.nodes[j].along_m - here;
        const double far = std::abs(t) / reach;
        const Sight& s = sights[l][j];
        if (far >= 1) return false;
        // Points that coincide seen along the wood leave no spread at all: never certain beyond a micrometre.
        const double se =
            std::max(1e-6, std::min(s.centre_se, 2 * limb.nodes[j].rough_radius_m + options.noise_m));
        const double near = 1 - far * far * far;
        const double w = near * near * near / (se * se);
        w0 += w;
        w1 += w * t;
        w2 += w * t * t;
        p0 += w * s.centre;
        p1 += w * t * s.centre;
        return true;
      };
      add(i);
      for (std::size_t j = i; j-- > 0 && add(j);) {
      }
      for (std::size_t j = i + 1; j < n && add(j); ++j) {
      }
      const double det = w0 * w2 - w1 * w1;
      next[i] = det > 1e-6 * w0 * w0 * reach * reach ? Vec3((w2 * p0 - w1 * p1) / det) : Vec3(p0 / w0);
    }
    for (std::size_t i = 0; i < n; ++i) {
      LimbNode& node = limb.nodes[i];
      if (i + 1 < n) node.centre = next[i];
      const Sight& s = sights[l][i];
      if (s.circle.ok)
        node.rough_radius_m = s.circle.radius;
      else if (s.spread.count > 0)
        node.rough_radius_m =
            std::min(node.rough_radius_m,
                     std::sqrt(std::max(s.spread.square - 2 * options.noise_m * options.noise_m, 4e-6)));
    }
    for (std::size_t i = 1; i < n; ++i)
      limb.nodes[i].rough_radius_m =
          std::min(limb.nodes[i].rough_radius_m, 1.1 * limb.nodes[i - 1].rough_radius_m);
  }
  measure_lengths(limbs);
}

}  // namespace dendrofit
