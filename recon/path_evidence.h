// SPDX-License-Identifier: GPL-3.0-or-later
// What the shortest paths from everywhere to the foot tell of the places they pass.
#pragma once

#include "core/types.h"
#include "recon/graph.h"

#include <cstdint>
#include <vector>

namespace dendrofit {

/// Columns as long as the points.
struct PathEvidence {
  /// Longest way, along the paths, from a point to one that lies beyond it: how much hangs on it (metres).
  std::vector<float> reach;
  /// The next point on that way; Paths::kNone at its end.
  std::vector<std::uint32_t> onward;
  /// How straight the longest path through a point runs within `window_m` of it: beeline over way, averaged
  /// along the path, in [0, 1]. 0 where reach is below window_m, and where nothing leads.
  std::vector<float> straight;
  double window_m = 0;
};

/// Paths along wood run straight, and much hangs on them. Paths over leaves end soon, or turn at every leaf.
PathEvidence weigh_paths(const std::vector<Vec3>& points, const Paths& paths, double window_m);

}  // namespace dendrofit
