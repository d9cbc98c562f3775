// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/stems.h"

#include "core/errors.h"
#include "recon/pieces.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

namespace dendrofit {
namespace {

using Level = std::vector<Piece>;

/// The pieces of the lowest three slices, and their common height.
struct Levels {
  double slice = 0;
  Level first, second, third;
};

Levels levels_of(const std::vector<Vec3>& points, const PointGraph& graph,
                 const std::vector<double>& height) {
  Levels levels;
  double top = 0;
  for (const double h : height) top = std::max(top, h);
  levels.slice = std::clamp(0.1 * top, 0.15, 1.6);
  levels.first = pieces_between(points, graph, height, 0, levels.slice);
  levels.second = pieces_between(points, graph, height, levels.slice, 2 * levels.slice);
  levels.third = pieces_between(points, graph, height, 2 * levels.slice, 3 * levels.slice);
  return levels;
}

/// The upright piece nearest to the line at its own middle height, none farther than `reach`.
const Piece* piece_on(const Level& level, const Foot& foot, double slice, double reach) {
  constexpr double kSpan = 0.6;  // share of the slice's height that a stem covers
  constexpr double kSteepest = 0.6;
  const Piece* best = nullptr;
  for (const Piece& piece : level) {
    if (piece.high - piece.low < kSpan * slice || piece.slope.norm() > kSteepest) continue;
    const double rise = piece.middle_z - foot.position.z();
    const Eigen::Vector2d from = piece.middle - foot.position.head<2>();
    const double off = std::min(from.norm(), (from - foot.slope * rise).norm());
    if (off > reach) continue;
    reach = off;
    best = &piece;
  }
  return best;
}

struct Thickness {
  double diameter = 0;  // 0: no stem
  bool rises = false;   // much the same one slice higher, and upright wood another slice above
};

Thickness stem_thickness(const Foot& foot, const Levels& levels, const std::vector<Vec3>& points,
                         const PointGraph& graph, const std::vector<double>& height) {
  constexpr double kWider = 1.5;  // than the slice below: a bough that meets its bearer, a crown
  const double reach = std::max(foot.diameter_m, 0.35 * levels.slice);
  const Piece* second = piece_on(levels.second, foot, levels.slice, reach);
  if (second && second->diameter <= kWider * foot.diameter_m &&
      piece_on(levels.third, foot, levels.slice, 2 * reach))
    return {std::min(foot.diameter_m, second->diameter), true};
  // The crown begins low: its surface must tell.
  const Piece* first = piece_on(levels.first, foot, levels.slice, foot.diameter_m);
  if (first && looks_like_wood(*first, points, graph, height, 0)) return {foot.diameter_m, false};
  return {};
}

}  // namespace

std::vector<Stool> tell_trees(const std::vector<Vec3>& points, const PointGraph& graph,
                              const std::vector<double>& height, const std::vector<Foot>& feet) {
  constexpr double kThinnest = 0.33;  // of the thickest stem's thickness
  constexpr double kStool_m = 0.4;
  if (feet.size() < 2) return {feet};
  const Levels levels = levels_of(points, graph, height);
  std::vector<double> thick(feet.size());
  double thickest = 0, thickest_rising = 0;
  for (std::size_t i = 0; i < feet.size(); ++i) {
    const Thickness t = stem_thickness(feet[i], levels, points, graph, height);
    thick[i] = t.diameter;
    thickest = std::max(thickest, t.diameter);
    if (t.rises) thickest_rising = std::max(thickest_rising, t.diameter);
  }
  if (thickest_rising > 0) thickest = thickest_rising;  // others may have undergrowth about them
  std::vector<Stool> trees;
  std::vector<std::size_t> tree_of(feet.size());  // of the stems that count, their index in trees
  std::vector<std::size_t> stems;
  for (std::size_t i = 0; i < feet.size(); ++i) {
    if (i > 0 && (thick[i] == 0 || thick[i] < kThinnest * thickest)) continue;
    if (thick[i] == 0) thick[i] = feet[i].diameter_m;
    tree_of[i] = trees.size();
    trees.emplace_back();
    for (const std::size_t j : stems) {
      const double apart =
          (feet[i].position - feet[j].position).head<2>().norm() - 0.5 * (thick[i] + thick[j]);
      if (apart > std::max({kStool_m, thick[i], thick[j]})) continue;
      const std::size_t from = std::max(tree_of[i], tree_of[j]), to = std::min(tree_of[i], tree_of[j]);
      for (std::size_t k = 0; k <= i; ++k)
        if (tree_of[k] == from) tree_of[k] = to;
    }
    stems.push_back(i);
  }
  for (const std::size_t i : stems) trees[tree_of[i]].push_back(feet[i]);
  std::erase_if(trees, [](const Stool& stool) { return stool.empty(); });
  return trees;
}

std::vector<Foot> stems_of(const std::vector<Stool>& trees) {
  std::vector<Foot> all;
  for (const Stool& stool : trees) all.insert(all.end(), stool.begin(), stool.end());
  return all;
}

KeptTree keep_tree(const std::vector<Vec3>& points, const PointGraph& graph,
                   const std::vector<Bridge>& bridges, const std::vector<Stool>& trees,
                   std::optional<std::size_t> wanted, std::vector<char>& open, Progress& progress) {
  std::vector<std::uint32_t> owner(points.size(), Paths::kNone), sources;
  for (std::size_t t = 0; t < trees.size(); ++t)
    for (const std::uint32_t p : ring_of(trees[t])) {
      if (owner[p] != Paths::kNone) continue;
      owner[p] = static_cast<std::uint32_t>(t);
      sources.push_back(p);
    }
  const Paths paths = shortest_paths(points, graph, bridges, open, sources, progress);
  constexpr double kLow = 1.0 / 3;  // of the tree's height: a post, a shrub
  std::vector<std::size_t> count(trees.size(), 0);
  std::vector<double> high(trees.size(), -1e300), low(trees.size(), 1e300);
  for (const std::uint32_t p : paths.order) {
    if (paths.parent[p] != Paths::kNone) owner[p] = owner[paths.parent[p]];
    ++count[owner[p]];
    high[owner[p]] = std::max(high[owner[p]], points[p].z());
    low[owner[p]] = std::min(low[owner[p]], points[p].z());
  }
  KeptTree kept;
  kept.tree =
      wanted.value_or(static_cast<std::size_t>(std::max_element(count.begin(), count.end()) - count.begin()));
  kept.other_points = paths.order.size() - count[kept.tree];
  for (std::size_t t = 0; t < trees.size(); ++t)
    if (t != kept.tree && high[t] - low[t] >= kLow * (high[kept.tree] - low[kept.tree]))
      kept.other_trees.push_back(t);
  for (const std::uint32_t p : paths.order)
    if (owner[p] != kept.tree) open[p] = 0;
  return kept;
}

std::size_t tree_nearest_to(const Eigen::Vector2d& at, const std::vector<Stool>& trees,
                            const Vec3& origin_shift) {
  constexpr double kReach_m = 2.0;
  double nearest = kReach_m;
  std::optional<std::size_t> found;
  std::ostringstream stems;
  stems << std::fixed << std::setprecision(2);
  for (std::size_t t = 0; t < trees.size(); ++t)
    for (const Foot& foot : trees[t]) {
      const Vec3 world = foot.position + origin_shift;
      stems << (stems.tellp() > 0 ? "; " : "") << world.x() << ' ' << world.y();
      const double away = (foot.position.head<2>() - at).norm();
      if (away > nearest) continue;
      nearest = away;
      found = t;
    }
  if (!found)
    throw SolverError("no stem stands within 2 m of the place asked for; stems stand at " + stems.str());
  return *found;
}

std::vector<std::uint32_t> ring_of(const Stool& stool) {
  std::vector<std::uint32_t> ring;
  for (const Foot& foot : stool) ring.insert(ring.end(), foot.points.begin(), foot.points.end());
  std::sort(ring.begin(), ring.end());
  ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
  return ring;
}

}  // namespace dendrofit
