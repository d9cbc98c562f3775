// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/point_cloud.h"
#include "recon/graph.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace dendrofit {
namespace {

constexpr std::uint32_t kFewestPoints = 3;  // a smaller part is a stray, not wood, once a gap lies before it
constexpr std::size_t kBridgesPerPlace = 3;
constexpr std::size_t kBridgesPerPart = 24;
constexpr double kPlaceShare = 0.5;  // of a gap's width: bridges nearer to each other cross at one place
constexpr std::size_t kMostCandidates = 2048;  // the nearest; gaps are crossed where they are narrow
constexpr std::size_t kFirstLooks = 500, kMostLooks = 50'000;  // points of a group that look across gaps
constexpr double kGapSpacings = 4;
constexpr double kGapShare = 1.0;  // of a loose part's extent

/// Union-find with path halving.
struct Union {
  std::vector<std::uint32_t> up;
  explicit Union(std::size_t n) : up(n) { std::iota(up.begin(), up.end(), 0U); }
  std::uint32_t root(std::uint32_t i) {
    while (up[i] != i) i = up[i] = up[up[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = root(a);
    b = root(b);
    up[std::max(a, b)] = std::min(a, b);
  }
};

/// Direction of the wood about a point: from the centre of its linked neighbourhood (two links deep) to the
/// point.
Vec3 outward(const std::vector<Vec3>& points, const PointGraph& graph, std::uint32_t p) {
  Vec3 sum = Vec3::Zero();
  double weight = 0;
  for (const std::uint32_t a : graph.of(p))
    for (const std::uint32_t b : graph.of(a)) {
      sum += points[b];
      weight += 1;
    }
  if (weight == 0) return Vec3::Zero();
  const Vec3 run = points[p] - sum / weight;
  const double length = run.norm();
  return length > 0.3 * graph.typical_spacing_m ? Vec3(run / length) : Vec3::Zero();
}

/// A gap's cost: its width, up to doubled at each end where it does not go on as the wood there does.
double gap_cost(const std::vector<Vec3>& points, const PointGraph& graph, std::uint32_t a, std::uint32_t b) {
  const Vec3 gap = points[b] - points[a];
  const double width = gap.norm();
  if (width == 0) return 0;
  const auto bend = [&](const Vec3& wood, const Vec3& way) {
    return wood.isZero() ? 0.5 : 0.5 * (1 - wood.dot(way) / width);
  };
  // Only the loose part's own direction counts in full: its neighbour may be met anywhere along a branch.
  return width * (1 + bend(outward(points, graph, a), gap) + 0.5 * bend(outward(points, graph, b), -gap));
}

/// Leaves the cheapest few bridges of each place: where a slab of a scan is missing, every stem that it cuts
/// crosses on its own. `candidates` are sorted by cost.
void keep_places(const std::vector<Vec3>& points, std::vector<Bridge>& candidates) {
  std::vector<Bridge> kept;
  for (const Bridge& c : candidates) {
    std::size_t here = 0;
    for (const Bridge& k : kept)
      here += (points[k.a] - points[c.a]).norm() < kPlaceShare * std::max(k.gap_m, c.gap_m);
    if (here < kBridgesPerPlace) kept.push_back(c);
    if (kept.size() == kBridgesPerPart) break;
  }
  candidates = std::move(kept);
}

}  // namespace

std::vector<Bridge> bridge_gaps(const std::vector<Vec3>& points, const PointGraph& graph, const Parts& parts,
                                const GraphOptions& options, Progress& progress) {
  std::vector<Bridge> bridges;
  const std::size_t part_count = parts.points.size();
  if (part_count < 2) return bridges;
  progress.begin("gaps", static_cast<double>(part_count), "parts");
  const auto small = [&](std::uint32_t part) { return parts.points[part] < kFewestPoints; };
  Union groups(part_count);
  std::vector<std::uint32_t> group(points.size(), Paths::kNone);  // none: closed, or a stray
  std::vector<std::uint64_t> hopeless(part_count, 0);  // size at which a group found nothing within its reach

  for (int round = 0; round < 12; ++round) {
    // Points by group, all but the largest group look for their nearest neighbours elsewhere.
    std::vector<std::uint64_t> size(part_count, 0);
    for (std::uint32_t p = 0; p < part_count; ++p)
      if (!small(p)) size[groups.root(p)] += parts.points[p];
    const auto largest =
        static_cast<std::uint32_t>(std::max_element(size.begin(), size.end()) - size.begin());
    std::vector<std::vector<std::uint32_t>> members(part_count);
    std::vector<Bounds> extent(part_count);
    for (std::uint32_t i = 0; i < points.size(); ++i) {
      const std::uint32_t part = parts.part[i];
      if (part == Paths::kNone || small(part)) continue;
      group[i] = groups.root(part);
      if (group[i] != largest) members[group[i]].push_back(i);
      extent[group[i]].add(points[i]);
    }
    bool joined = false;
    std::vector<Bridge> fresh;
    for (std::uint32_t g = 0; g < part_count; ++g) {
      if (members[g].empty() || hopeless[g] == size[g]) continue;
      progress.check();
      // Wood that is seen for a few centimetres only does not vouch for a gap of decimetres.
      const double widest = std::min(
          options.max_gap_m, kGapSpacings * graph.typical_spacing_m + kGapShare * extent[g].size().norm());
      // Each point looks for its nearest neighbour of another group, first few to learn how far to look, then
      // all: points in the middle of thick wood see across a gap later than thin wood beside them.
      std::vector<Bridge> candidates;
      double reach = widest;
      for (const std::size_t looks : {kFirstLooks, kMostLooks}) {
        const std::size_t stride = 1 + members[g].size() / looks;
        for (std::size_t m = 0; m < members[g].size(); m += stride) {
          const std::uint32_t p = members[g][m];
          const auto found = graph.index->nearest_where(
              points[p], reach, [&](std::uint32_t i) { return group[i] != g && group[i] != Paths::kNone; });
          if (!found) continue;
          const double gap = std::sqrt(found->distance_squared);
          candidates.push_back({p, found->index, gap, gap});
          reach = std::min(reach, 2 * gap + 2 * graph.typical_spacing_m);
        }
        if (stride == 1) break;
      }
      if (candidates.empty()) {
        hopeless[g] = size[g];
        continue;
      }
      std::sort(candidates.begin(), candidates.end(), [](const Bridge& x, const Bridge& y) {
        return x.gap_m != y.gap_m ? x.gap_m < y.gap_m : (x.a != y.a ? x.a < y.a : x.b < y.b);
      });
      candidates.erase(std::unique(candidates.begin(), candidates.end(),
                                   [](const Bridge& x, const Bridge& y) { return x.a == y.a && x.b == y.b; }),
                       candidates.end());
      while (candidates.back().gap_m > reach) candidates.pop_back();
      if (candidates.size() > kMostCandidates) candidates.resize(kMostCandidates);
      for (Bridge& c : candidates)
        c.cost_m = step_cost(gap_cost(points, graph, c.a, c.b), graph.typical_spacing_m);
      std::sort(candidates.begin(), candidates.end(), [](const Bridge& x, const Bridge& y) {
        return x.cost_m != y.cost_m ? x.cost_m < y.cost_m : (x.a != y.a ? x.a < y.a : x.b < y.b);
      });
      keep_places(points, candidates);
      fresh.insert(fresh.end(), candidates.begin(), candidates.end());
    }
    for (const Bridge& b : fresh) {
      const std::uint32_t x = groups.root(parts.part[b.a]), y = groups.root(parts.part[b.b]);
      if (x != y) {
        groups.join(x, y);
        joined = true;
      }
      bridges.push_back(b);
    }
    if (!joined) break;
  }
  progress.end();
  return bridges;
}

}  // namespace dendrofit
