// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/wood_leaf.h"

#include "core/errors.h"
#include "core/neighbors.h"
#include "recon/cell_maxima.h"
#include "recon/path_evidence.h"
#include "recon/trunk_wood.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Eigenvalues>

namespace dendrofit {
namespace {

constexpr double kWindowSpacings = 6;   // a straightness needs as many steps as this
constexpr double kLessStraight = 0.04;  // than the trunk's paths, and still wood
constexpr double kStraightest = 0.93, kCrookedest = 0.75;
constexpr double kLinear = 0.65;            // linearity of twigs (Demantke et al. 2011)
constexpr std::size_t kSamples = 20'000;    // points on which the verdict rests
constexpr double kDiameterPerReach = 0.02;  // of wood: ample
constexpr double kWidest_m = 0.08;          // from the nearest path on thick wood
constexpr double kDiameterPerSpread = 3;    // of half a mantle about its line, with some to spare

/// How straight wood's paths are in this scan: noise and spacing make them all zigzag.
double straight_as_wood(const PathEvidence& evidence, const Paths& paths) {
  float longest = 0;
  for (const std::uint32_t u : paths.order) longest = std::max(longest, evidence.reach[u]);
  std::vector<float> trunk;
  for (const std::uint32_t u : paths.order)
    if (evidence.reach[u] > 0.4f * longest && evidence.straight[u] > 0) trunk.push_back(evidence.straight[u]);
  if (trunk.empty()) return kStraightest;
  const auto middle = trunk.begin() + static_cast<std::ptrdiff_t>(trunk.size() / 2);
  std::nth_element(trunk.begin(), middle, trunk.end());
  return std::clamp(*middle - kLessStraight, kCrookedest, kStraightest);
}

/// Whether the points linked with `seed` within `radius` of it form a line.
bool on_a_line(const std::vector<Vec3>& points, const PointGraph& graph, std::uint32_t seed, double radius,
               std::vector<std::uint32_t>& members, std::vector<std::uint32_t>& seen_by) {
  members.assign(1, seed);
  seen_by[seed] = seed;
  Vec3 sum = Vec3::Zero();
  Eigen::Matrix3d square = Eigen::Matrix3d::Zero();
  for (std::size_t m = 0; m < members.size(); ++m) {
    const Vec3 d = points[members[m]] - points[seed];
    sum += d;
    square += d * d.transpose();
    for (const std::uint32_t v : graph.of(members[m]))
      if (seen_by[v] != seed && (points[v] - points[seed]).squaredNorm() <= radius * radius) {
        seen_by[v] = seed;
        members.push_back(v);
      }
  }
  if (members.size() < 5) return true;  // too little to call it anything else
  const auto n = static_cast<double>(members.size());
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(square / n - (sum / n) * (sum / n).transpose(), Eigen::EigenvaluesOnly);
  const Vec3 l = solver.eigenvalues();
  return l[2] - l[1] >= kLinear * l[2];
}

double share_of_straight(const Paths& paths, const PathEvidence& evidence, double straight_enough) {
  std::size_t bear = 0, straight = 0;
  for (const std::uint32_t u : paths.order) {
    if (evidence.reach[u] < 1.5 * evidence.window_m) continue;
    ++bear;
    straight += evidence.straight[u] >= straight_enough;
  }
  return bear > 0 ? static_cast<double>(straight) / static_cast<double>(bear) : 1;
}

double share_of_leafy_places(const std::vector<Vec3>& points, const PointGraph& graph, const Paths& paths,
                             const PathEvidence& evidence) {
  const double spacing = graph.typical_spacing_m;
  CellMaxima bearers(std::max(0.015, 1.1 * spacing));
  for (const std::uint32_t u : paths.order)
    if (evidence.reach[u] >= 1.5 * evidence.window_m) bearers.raise(points[u], evidence.reach[u]);
  const std::size_t stride = 1 + paths.order.size() / kSamples;
  std::vector<std::uint32_t> members, seen_by(points.size(), Paths::kNone);
  std::size_t leafy = 0, all = 0;
  for (std::size_t k = 0; k < paths.order.size(); k += stride, ++all) {
    const std::uint32_t u = paths.order[k];
    leafy += bearers.about(points[u]) <= 0 &&
             !on_a_line(points, graph, u, std::max(0.05, 3 * spacing), members, seen_by);
  }
  return all > 0 ? static_cast<double>(leafy) / static_cast<double>(all) : 0;
}

/// Points on straight paths that bear enough, all points those paths pass on their way to the foot, and their
/// last piece out to the tip.
std::vector<std::uint32_t> points_on_wood(const Paths& paths, const PathEvidence& evidence, double bearing,
                                          double straight_enough) {
  std::vector<char> on(evidence.reach.size(), 0);
  std::vector<std::uint32_t> wood;
  for (std::size_t k = paths.order.size(); k-- > 0;) {
    const std::uint32_t u = paths.order[k];
    if (!on[u] && (evidence.reach[u] < bearing || evidence.straight[u] < straight_enough)) continue;
    on[u] = 1;
    wood.push_back(u);
    if (paths.parent[u] != Paths::kNone) on[paths.parent[u]] = 1;
  }
  for (std::size_t k = 0, bearers = wood.size(); k < bearers; ++k)
    for (std::uint32_t u = evidence.onward[wood[k]]; u != Paths::kNone && !on[u]; u = evidence.onward[u]) {
      if (evidence.reach[u] >= evidence.window_m && evidence.straight[u] < straight_enough) break;
      on[u] = 1;
      wood.push_back(u);
    }
  return wood;
}

/// How far the paths on wood lie apart across it: root mean square distance from their line, sidewards, of
/// those within `radius` (the middle eigenvalue of their covariance). One answer for all places of a cell.
std::vector<float> spread_across(const std::vector<Vec3>& places, const Neighbors& index, double radius) {
  using Cell = std::array<int, 3>;
  std::vector<std::pair<Cell, std::uint32_t>> sorted;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Vec3 at = places[i] / (0.5 * radius);
    sorted.push_back({{static_cast<int>(std::floor(at.x())), static_cast<int>(std::floor(at.y())),
                       static_cast<int>(std::floor(at.z()))},
                      static_cast<std::uint32_t>(i)});
  }
  std::sort(sorted.begin(), sorted.end());
  std::vector<float> spread(places.size(), 0);
  std::vector<Neighbor> found;
  for (std::size_t first = 0, last = 0; first < sorted.size(); first = last) {
    Vec3 middle = Vec3::Zero();
    for (; last < sorted.size() && sorted[last].first == sorted[first].first; ++last)
      middle += places[sorted[last].second];
    index.within(middle / static_cast<double>(last - first), radius, found);
    if (found.size() < 4) continue;
    Vec3 mean = Vec3::Zero();
    for (const Neighbor& f : found) mean += places[f.index] / static_cast<double>(found.size());
    Eigen::Matrix3d square = Eigen::Matrix3d::Zero();
    for (const Neighbor& f : found) square += (places[f.index] - mean) * (places[f.index] - mean).transpose();
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
    solver.computeDirect(square / static_cast<double>(found.size() - 1), Eigen::EigenvaluesOnly);
    const auto across = static_cast<float>(std::sqrt(std::max(0.0, solver.eigenvalues()[1])));
    for (std::size_t k = first; k < last; ++k) spread[sorted[k].second] = across;
  }
  return spread;
}

}  // namespace

void WoodLeafOptions::validate() const {
  require(std::isfinite(window_m) && window_m > 0 && window_m < 2, "window_m", window_m,
          "must lie between 0 and 2 m");
  require(std::isfinite(shortest_wood_m) && shortest_wood_m >= 0, "shortest_wood_m", shortest_wood_m,
          "must not be negative");
  require(leaf_on_share >= 0 && leaf_on_share <= 1, "leaf_on_share", leaf_on_share,
          "must lie between 0 and 1");
  require(doubtful_share >= 0 && doubtful_share <= leaf_on_share, "doubtful_share", doubtful_share,
          "must lie between 0 and leaf_on_share");
  require(straight_share >= 0 && straight_share <= 1, "straight_share", straight_share,
          "must lie between 0 and 1");
}

WoodLeaf separate_leaves(const std::vector<Vec3>& points, const PointGraph& graph, const Paths& paths,
                         const WoodLeafOptions& options, Progress& progress) {
  options.validate();
  WoodLeaf result;
  result.leaf.assign(points.size(), 0);
  const double spacing = graph.typical_spacing_m;
  const double window = std::max(options.window_m, kWindowSpacings * spacing);
  const PathEvidence evidence = weigh_paths(points, paths, window);
  progress.check();
  result.leafy_share = share_of_leafy_places(points, graph, paths, evidence);
  const double straight_enough = straight_as_wood(evidence, paths);
  result.straight_share = share_of_straight(paths, evidence, straight_enough - 0.5 * kLessStraight);
  result.leaves_present =
      result.leafy_share > options.leaf_on_share ||
      (result.leafy_share > options.doubtful_share && result.straight_share < options.straight_share);
  if (!result.leaves_present) return result;

  const std::vector<std::uint32_t> wood =
      points_on_wood(paths, evidence, std::max(options.shortest_wood_m, 2 * window), straight_enough);
  progress.check();
  std::vector<Vec3> places;
  CellMaxima borne(0.05);
  for (const std::uint32_t u : wood) {
    places.push_back(points[u]);
    borne.raise(points[u], evidence.reach[u]);
  }
  const Neighbors nearest_path(places);
  const std::vector<float> spread = spread_across(places, nearest_path, std::max(0.06, 3 * spacing));
  const double least = std::max(0.006, 0.4 * spacing);
  std::vector<Neighbor> found;
  for (const std::uint32_t u : paths.order) {
    if (paths.parent[u] == Paths::kNone) continue;  // the foot itself
    result.leaf[u] = 1;
    const double reach = borne.about(points[u]);
    if (!(reach > 0)) continue;
    nearest_path.nearest(points[u], 1, found);
    const double widest =
        std::min(kDiameterPerReach * reach, least + kDiameterPerSpread * double(spread[found.front().index]));
    const double within = std::clamp(widest, least, std::max(least, kWidest_m));
    if (found.front().distance_squared <= within * within) result.leaf[u] = 0;
  }
  keep_round_bole(points, paths, spacing, result.leaf);
  return result;
}

std::vector<std::uint32_t> take_out_leaves(CleanScan& scan, const Paths& paths, const WoodLeaf& verdict,
                                           std::vector<Foot>& feet) {
  std::vector<std::uint32_t> leaves;
  std::vector<char> wood(scan.points.size(), 0);
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    if (!std::isfinite(paths.length[i])) continue;
    if (verdict.leaf[i])
      leaves.push_back(scan.source[i]);
    else
      wood[i] = 1;
  }
  keep_points(scan, wood, feet);
  return leaves;
}

}  // namespace dendrofit
