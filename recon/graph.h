// SPDX-License-Identifier: GPL-3.0-or-later
// The neighbour graph of a scan's points, its connected parts, and the shortest paths from a tree's foot.
#pragma once

#include "core/neighbors.h"
#include "core/progress.h"
#include "core/types.h"

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace dendrofit {

struct GraphOptions {
  int neighbors = 10;      ///< nearest points each point is linked with
  double max_gap_m = 1.5;  ///< widest gap in the scan that wood is believed to cross
  int threads = 0;
  void validate() const;
};

/// Undirected links between points (compressed rows, each link once a row), none longer than a few times the
/// points' spacing.
struct PointGraph {
  std::vector<std::size_t> first;          ///< size() + 1 row starts
  std::vector<std::uint32_t> to;           ///< linked points, row by row
  std::vector<float> spacing;              ///< distance of each point's fourth neighbour, metres
  double typical_spacing_m = 0;            ///< median of spacing
  std::shared_ptr<const Neighbors> index;  ///< that found them
  std::size_t size() const { return spacing.size(); }
  std::span<const std::uint32_t> of(std::size_t i) const {
    return {to.data() + first[i], first[i + 1] - first[i]};
  }
};

/// One pass over the points' nearest neighbours.
PointGraph neighbor_graph(const std::vector<Vec3>& points, const GraphOptions& options = {},
                          Progress& = no_progress());

/// What a step costs the paths: long ones more than many short ones, so that they keep to the wood.
double step_cost(double length_m, double spacing_m);

/// A link across a gap.
struct Bridge {
  std::uint32_t a = 0;
  std::uint32_t b = 0;
  double gap_m = 0;
  double cost_m =
      0;  ///< of crossing it, see step_cost(); more where it bends away from the wood on either side
};

/// Connected parts of the graph over its open points (open[i] != 0).
struct Parts {
  std::vector<std::uint32_t> part;    ///< of each point; Paths::kNone for a closed one
  std::vector<std::uint32_t> points;  ///< number of points of each part
};
Parts connected_parts(const PointGraph& graph, const std::vector<char>& open);

/// Links across the gaps between the graph's parts: every part within max_gap_m of the rest gets its cheapest
/// ones, round by round until all are one or no gap is narrow enough.
std::vector<Bridge> bridge_gaps(const std::vector<Vec3>& points, const PointGraph& graph, const Parts& parts,
                                const GraphOptions& options = {}, Progress& = no_progress());

/// Points that paths should enter from the door's points; from elsewhere at a price.
struct Gate {
  std::vector<std::uint32_t> inside, door;
};

/// Shortest paths from a set of sources over open points. A path's cost favours many short steps (the wood's
/// own surface) over leaps and straight runs over turns; its length is counted beside it.
struct Paths {
  static constexpr std::uint32_t kNone = 0xffffffffU;
  std::vector<std::uint32_t>
      parent;                 ///< previous point on the way to the source; kNone for sources and unreached
  std::vector<float> length;  ///< metres from the source; infinity where unreached
  std::vector<std::uint32_t> order;  ///< reached points, sources first, parents before children
};
Paths shortest_paths(const std::vector<Vec3>& points, const PointGraph& graph,
                     const std::vector<Bridge>& bridges, const std::vector<char>& open,
                     const std::vector<std::uint32_t>& sources, Progress& = no_progress(),
                     const std::vector<Gate>& gates = {});

}  // namespace dendrofit
