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

/// What every stem's paths reach.
struct Territory {
  std::size_t points = 0;
  double low = 1e300, high = -1e300;
};

/// The stems that are high enough for a tree's, in groups, by their index.
std::vector<std::vector<std::size_t>> group_stems(const std::vector<Stem>& stems,
                                                  const std::vector<Territory>& territory) {
  constexpr double kStool_m = 0.4;
  constexpr double kLow = 1.0 / 3;  // of the highest: a post, a shrub
  double highest = 0;
  for (const Territory& t : territory) highest = std::max(highest, t.high - t.low);
  std::vector<std::vector<std::size_t>> groups;
  for (std::size_t i = 0; i < stems.size(); ++i) {
    if (territory[i].high - territory[i].low < kLow * highest) continue;
    std::vector<std::size_t> group = {i};
    for (auto& other : groups) {
      const bool near = std::any_of(other.begin(), other.end(), [&](std::size_t j) {
        const double a = stems[i].thickness_m, b = stems[j].thickness_m;
        const double axes = (stems[i].foot.position - stems[j].foot.position).head<2>().norm();
        return axes - 0.5 * (a + b) <= std::max({kStool_m, a, b});
      });
      if (!near) continue;
      group.insert(group.end(), other.begin(), other.end());
      other.clear();
    }
    std::erase_if(groups, [](const auto& other) { return other.empty(); });
    std::sort(group.begin(), group.end());
    groups.push_back(std::move(group));
  }
  return groups;
}

/// The group with the stem nearest to `at`.
std::size_t group_at(const Eigen::Vector2d& at, const std::vector<std::vector<std::size_t>>& groups,
                     const std::vector<Stem>& stems, const Vec3& origin_shift) {
  double nearest = 2.0;  // metres
  std::optional<std::size_t> found;
  std::ostringstream places;
  places << std::fixed << std::setprecision(2);
  for (std::size_t g = 0; g < groups.size(); ++g)
    for (const std::size_t i : groups[g]) {
      const Vec3 world = stems[i].foot.position + origin_shift;
      places << (places.tellp() > 0 ? "; " : "") << world.x() << ' ' << world.y();
      const double away = (stems[i].foot.position.head<2>() - at).norm();
      if (away > nearest) continue;
      nearest = away;
      found = g;
    }
  if (!found)
    throw SolverError("no stem stands within 2 m of the place asked for; stems stand at " + places.str());
  return *found;
}

}  // namespace

std::vector<Stem> tell_stems(const std::vector<Vec3>& points, const PointGraph& graph,
                             const std::vector<double>& height, const std::vector<Foot>& feet) {
  constexpr double kThinnest = 0.33;  // of the thickest stem's thickness
  if (feet.size() < 2) return {{feet.front(), feet.front().diameter_m}};
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
  std::vector<Stem> stems;
  for (std::size_t i = 0; i < feet.size(); ++i) {
    if (i > 0 && (thick[i] == 0 || thick[i] < kThinnest * thickest)) continue;
    stems.push_back({feet[i], thick[i] > 0 ? thick[i] : feet[i].diameter_m});
  }
  return stems;
}

KeptTree keep_tree(const std::vector<Vec3>& points, const PointGraph& graph,
                   const std::vector<Bridge>& bridges, const std::vector<Stem>& stems,
                   const std::optional<Eigen::Vector2d>& at, const Vec3& origin_shift,
                   std::vector<char>& open, Progress& progress) {
  std::vector<std::uint32_t> owner(points.size(), Paths::kNone), sources;
  for (std::size_t s = 0; s < stems.size(); ++s)
    for (const std::uint32_t p : stems[s].foot.points) {
      if (owner[p] != Paths::kNone) continue;
      owner[p] = static_cast<std::uint32_t>(s);
      sources.push_back(p);
    }
  const Paths paths = shortest_paths(points, graph, bridges, open, sources, progress);
  std::vector<Territory> territory(stems.size());
  for (const std::uint32_t p : paths.order) {
    if (paths.parent[p] != Paths::kNone) owner[p] = owner[paths.parent[p]];
    Territory& own = territory[owner[p]];
    ++own.points;
    own.low = std::min(own.low, points[p].z());
    own.high = std::max(own.high, points[p].z());
  }
  const auto groups = group_stems(stems, territory);
  if (groups.empty()) throw SolverError("no wood could be followed from the stem's foot upwards");
  std::vector<std::size_t> count(groups.size(), 0);
  for (std::size_t g = 0; g < groups.size(); ++g)
    for (const std::size_t i : groups[g]) count[g] += territory[i].points;
  const auto chosen =
      at ? group_at(*at, groups, stems, origin_shift)
         : static_cast<std::size_t>(std::max_element(count.begin(), count.end()) - count.begin());
  KeptTree kept;
  std::vector<char> own(stems.size(), 0);
  for (const std::size_t i : groups[chosen]) {
    kept.stool.push_back(stems[i].foot);
    own[i] = 1;
  }
  for (std::size_t g = 0; g < groups.size(); ++g)
    if (g != chosen) kept.other_trees.push_back(stems[groups[g].front()].foot);
  kept.other_points = paths.order.size() - count[chosen];
  for (const std::uint32_t p : paths.order)
    if (!own[owner[p]]) open[p] = 0;
  return kept;
}

std::vector<std::uint32_t> ring_of(const Stool& stool) {
  std::vector<std::uint32_t> ring;
  for (const Foot& foot : stool) ring.insert(ring.end(), foot.points.begin(), foot.points.end());
  std::sort(ring.begin(), ring.end());
  ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
  return ring;
}

}  // namespace dendrofit
