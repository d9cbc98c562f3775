// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/trunk_wood.h"

#include "recon/cylinder_fit.h"

#include <algorithm>
#include <cmath>

namespace dendrofit {
namespace {

constexpr double kSliceSpacings = 4;
constexpr double kShortestSlice_m = 0.15;
constexpr double kThickestPerHeight = 0.08;  // radius of the stoutest boles
constexpr double kLooksFromFoot_m = 1.5;     // up to here the circle must show for the first time
constexpr double kSearch = 1.8;              // radii about the axis in which points are looked at
constexpr double kChange = 0.35;             // relative, of the radius from slice to slice
constexpr double kShift = 0.8;               // of the axis from slice to slice, in radii
constexpr double kScatter = 0.25;  // of the radius: bark, a trunk's own shape; a filled disc has 0.35
constexpr double kCoverage = 0.3;
constexpr std::size_t kFewestPoints = 12;
constexpr int kCoast = 3;  // slices without a circle

/// Reached points by height.
struct Slices {
  double low = 0, depth = 0;
  std::vector<std::vector<std::uint32_t>> points;
  double middle(std::size_t k) const { return low + (static_cast<double>(k) + 0.5) * depth; }
};

Slices slices_of(const std::vector<Vec3>& points, const Paths& paths, double depth) {
  Slices slices;
  slices.depth = depth;
  double high = -1e300;
  slices.low = 1e300;
  for (const std::uint32_t u : paths.order) {
    slices.low = std::min(slices.low, points[u].z());
    high = std::max(high, points[u].z());
  }
  slices.points.resize(1 + static_cast<std::size_t>((high - slices.low) / depth));
  for (const std::uint32_t u : paths.order)
    slices.points[static_cast<std::size_t>((points[u].z() - slices.low) / depth)].push_back(u);
  return slices;
}

/// The bole's axis and radius at one height.
struct Ring {
  Eigen::Vector2d centre{0, 0}, slope{0, 0};
  double radius = 0;
};

/// Points of a slice within `reach` of the axis, seen along it.
struct Look {
  std::vector<Eigen::Vector2d> flat;
  std::vector<std::uint32_t> which;
};

Look look(const std::vector<Vec3>& points, const Slices& slices, std::size_t k, const Ring& ring,
          double reach) {
  Look seen;
  for (const std::uint32_t p : slices.points[k]) {
    const Eigen::Vector2d at =
        points[p].head<2>() - ring.centre - ring.slope * (points[p].z() - slices.middle(k));
    if (at.norm() > reach) continue;
    seen.flat.push_back(at);
    seen.which.push_back(p);
  }
  return seen;
}

bool is_sound(const CircleFit& fit, const Look& seen) {
  return fit.ok && fit.rms < kScatter * fit.radius && fit.coverage >= kCoverage &&
         4 * fit.inliers >= 3 * seen.flat.size();
}

/// The first slice above the sources whose points show a circle; `k` is its number, radius 0: none.
Ring first_ring(const std::vector<Vec3>& points, const Paths& paths, const Slices& slices, std::size_t& k) {
  Ring ring;
  Eigen::Vector2d sum(0, 0);
  double count = 0, spread = 0;
  for (const std::uint32_t u : paths.order)
    if (paths.parent[u] == Paths::kNone) {
      sum += points[u].head<2>();
      count += 1;
    }
  if (count == 0) return ring;
  ring.centre = sum / count;
  for (const std::uint32_t u : paths.order)
    if (paths.parent[u] == Paths::kNone)
      spread = std::max(spread, (points[u].head<2>() - ring.centre).norm());
  const double thickest = kThickestPerHeight * slices.depth * static_cast<double>(slices.points.size());
  for (k = 0; k < slices.points.size() && slices.middle(k) - slices.low < kLooksFromFoot_m; ++k) {
    const Look seen = look(points, slices, k, ring, std::min(2 * spread, 2 * thickest));
    if (seen.flat.size() < kFewestPoints) continue;
    const CircleFit start = taubin_circle(seen.flat);
    if (!start.ok || start.radius > thickest) continue;
    const CircleFit fit = robust_circle(seen.flat, start, 0.05 * start.radius);
    if (!is_sound(fit, seen) || fit.radius > thickest) continue;
    ring.centre += fit.centre;
    ring.radius = fit.radius;
    return ring;
  }
  return ring;
}

}  // namespace

void keep_round_bole(const std::vector<Vec3>& points, const Paths& paths, double spacing_m,
                     std::vector<char>& leaf) {
  if (paths.order.empty()) return;
  const Slices slices = slices_of(points, paths, std::max(kShortestSlice_m, kSliceSpacings * spacing_m));
  std::size_t first = 0;
  Ring ring = first_ring(points, paths, slices, first);
  if (!(ring.radius > 0)) return;
  int coasted = 0;
  for (std::size_t k = first; k < slices.points.size() && coasted <= kCoast; ++k) {
    if (k > first) ring.centre += ring.slope * slices.depth;
    ++coasted;
    const Look seen = look(points, slices, k, ring, kSearch * ring.radius);
    if (seen.flat.size() < kFewestPoints) continue;
    CircleFit start;
    start.ok = true;
    start.radius = ring.radius;
    const CircleFit fit = robust_circle(seen.flat, start, 0.05 * ring.radius);
    if (!is_sound(fit, seen) || std::abs(fit.radius - ring.radius) > kChange * ring.radius ||
        fit.centre.norm() > kShift * ring.radius)
      continue;
    const double reach = std::max(3 * fit.rms, 0.15 * fit.radius);
    for (std::size_t i = 0; i < seen.which.size(); ++i)
      if ((seen.flat[i] - fit.centre).norm() <= fit.radius + reach) leaf[seen.which[i]] = 0;
    // The slope follows slowly: a strip of the surface tells the axis badly.
    ring.slope += 0.3 * fit.centre / slices.depth;
    ring.centre += fit.centre;
    ring.radius = 0.5 * (ring.radius + fit.radius);
    coasted = 0;
  }
}

}  // namespace dendrofit
