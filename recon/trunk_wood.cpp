// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/trunk_wood.h"

#include "recon/cylinder_fit.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace dendrofit {
namespace {

constexpr double kReachShare = 0.35;       // of the longest: what bears as much is thick
constexpr double kDiameterPerReach = 0.1;  // of the stoutest wood
constexpr double kSliceSpacings = 5;       // length of a slice
constexpr double kShortestSlice_m = 0.15;
constexpr std::size_t kFewestPoints = 12;
constexpr double kScatter = 0.15;  // of a radius: bark, and a trunk's own shape
constexpr double kCoverage = 0.3;

/// Paths that pass a level of the tree side by side along one piece of wood.
struct Bundle {
  std::vector<std::uint32_t> members;  // positions in `wood`
  std::vector<std::uint32_t> about;    // reached points nearest to one of them
};

/// Splits the paths that pass one level into those of separate pieces of wood: single linkage.
std::vector<Bundle> bundles_of(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& wood,
                               const std::vector<std::uint32_t>& level, double link) {
  std::vector<Bundle> bundles;
  std::vector<char> taken(level.size(), 0);
  for (std::size_t seed = 0; seed < level.size(); ++seed) {
    if (taken[seed]) continue;
    taken[seed] = 1;
    Bundle bundle;
    bundle.members.push_back(level[seed]);
    for (std::size_t m = 0; m < bundle.members.size(); ++m)
      for (std::size_t k = 0; k < level.size(); ++k)
        if (!taken[k] &&
            (points[wood[level[k]]] - points[wood[bundle.members[m]]]).squaredNorm() < link * link) {
          taken[k] = 1;
          bundle.members.push_back(level[k]);
        }
    bundles.push_back(std::move(bundle));
  }
  return bundles;
}

/// Where the bundle's paths run: mean of their chords a slice back and ahead.
Vec3 direction_of(const std::vector<Vec3>& points, const Paths& paths, const PathEvidence& evidence,
                  const std::vector<std::uint32_t>& wood, const Bundle& bundle, double slice) {
  Vec3 sum = Vec3::Zero();
  const auto walk = [&](std::uint32_t from, const std::vector<std::uint32_t>& next) {
    std::uint32_t at = from;
    while (next[at] != Paths::kNone && std::abs(paths.length[at] - paths.length[from]) < slice) at = next[at];
    return at;
  };
  for (const std::uint32_t m : bundle.members)
    sum += points[walk(wood[m], evidence.onward)] - points[walk(wood[m], paths.parent)];
  const double length = sum.norm();
  return length > 0 ? Vec3(sum / length) : Vec3::UnitZ();
}

/// Clears `leaf` on the circle that the bundle's surroundings lie on, if they do.
void keep_circle(const std::vector<Vec3>& points, const Bundle& bundle, const Vec3& middle,
                 const Vec3& direction, double widest, std::vector<char>& leaf) {
  Vec3 u, v;
  plane_frame(direction, u, v);
  std::vector<Eigen::Vector2d> flat;
  std::vector<std::uint32_t> which;
  for (const std::uint32_t p : bundle.about) {
    const Vec3 d = points[p] - middle;
    const Eigen::Vector2d at(d.dot(u), d.dot(v));
    if (at.norm() > widest) continue;
    flat.push_back(at);
    which.push_back(p);
  }
  if (flat.size() < kFewestPoints) return;
  const CircleFit start = algebraic_circle(flat);
  if (!start.ok || 2 * start.radius > widest) return;
  const CircleFit fit = robust_circle(flat, start, 0.05 * start.radius);
  if (!fit.ok || 2 * fit.radius > widest || fit.rms > kScatter * fit.radius || fit.coverage < kCoverage ||
      4 * fit.inliers < 3 * flat.size())
    return;
  const double reach = std::max(3 * fit.rms, 0.1 * fit.radius);
  for (std::size_t k = 0; k < which.size(); ++k)
    if (std::abs((flat[k] - fit.centre).norm() - fit.radius) <= reach) leaf[which[k]] = 0;
}

}  // namespace

void keep_round_wood(const std::vector<Vec3>& points, const Paths& paths, const PathEvidence& evidence,
                     const std::vector<std::uint32_t>& wood, const std::vector<std::uint32_t>& nearest,
                     double spacing_m, std::vector<char>& leaf) {
  float longest = 0;
  for (const std::uint32_t u : wood) longest = std::max(longest, evidence.reach[u]);
  const double slice = std::max(kShortestSlice_m, kSliceSpacings * spacing_m);
  const auto level_of = [&](std::uint32_t w) {
    return static_cast<std::size_t>(static_cast<double>(paths.length[wood[w]]) / slice);
  };
  std::vector<std::vector<std::uint32_t>> levels;
  for (std::uint32_t w = 0; w < wood.size(); ++w) {
    if (evidence.reach[wood[w]] < kReachShare * longest) continue;
    if (levels.size() <= level_of(w)) levels.resize(level_of(w) + 1);
    levels[level_of(w)].push_back(w);
  }
  std::vector<std::uint32_t> bundle_of(wood.size(), Paths::kNone);
  std::vector<Bundle> bundles;
  for (const auto& level : levels)
    for (Bundle& bundle : bundles_of(points, wood, level, std::max(0.1, 3 * spacing_m))) {
      for (const std::uint32_t m : bundle.members) bundle_of[m] = static_cast<std::uint32_t>(bundles.size());
      bundles.push_back(std::move(bundle));
    }
  for (const std::uint32_t u : paths.order)
    if (nearest[u] != Paths::kNone && bundle_of[nearest[u]] != Paths::kNone)
      bundles[bundle_of[nearest[u]]].about.push_back(u);
  for (const Bundle& bundle : bundles) {
    Vec3 middle = Vec3::Zero();
    double reach = 0;
    for (const std::uint32_t m : bundle.members) {
      middle += points[wood[m]] / static_cast<double>(bundle.members.size());
      reach = std::max(reach, double(evidence.reach[wood[m]]));
    }
    keep_circle(points, bundle, middle, direction_of(points, paths, evidence, wood, bundle, slice),
                kDiameterPerReach * reach, leaf);
  }
}

}  // namespace dendrofit
