// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/path_evidence.h"

#include <algorithm>
#include <cmath>

namespace dendrofit {
namespace {

/// The path through every point in both directions: its parent, and the child with the longest reach.
struct Ways {
  const Paths& paths;
  const std::vector<std::uint32_t>& onward;

  std::uint32_t back(std::uint32_t i) const { return paths.parent[i]; }
  std::uint32_t ahead(std::uint32_t i) const { return onward[i]; }

  template <class Step>
  std::uint32_t walk(std::uint32_t from, double distance, Step step) const {
    std::uint32_t at = from;
    for (std::uint32_t next = step(at); next != Paths::kNone; next = step(at)) {
      at = next;
      if (std::abs(paths.length[at] - paths.length[from]) >= distance) break;
    }
    return at;
  }
};

}  // namespace

PathEvidence weigh_paths(const std::vector<Vec3>& points, const Paths& paths, double window_m) {
  const std::size_t n = points.size();
  PathEvidence evidence{std::vector<float>(n, 0), std::vector<std::uint32_t>(n, Paths::kNone),
                        std::vector<float>(n, 0), window_m};
  const Ways ways{paths, evidence.onward};
  std::vector<float>& reach = evidence.reach;
  for (std::size_t k = paths.order.size(); k-- > 0;) {
    const std::uint32_t u = paths.order[k], p = paths.parent[u];
    if (p == Paths::kNone) continue;
    const float way = reach[u] + (paths.length[u] - paths.length[p]);
    if (evidence.onward[p] != Paths::kNone && way <= reach[p]) continue;
    reach[p] = way;
    evidence.onward[p] = u;
  }
  const auto bears = [&](std::uint32_t i) { return i != Paths::kNone && reach[i] >= window_m; };
  std::vector<float> own(n, 0);
  for (const std::uint32_t u : paths.order) {
    if (!bears(u)) continue;
    const std::uint32_t a = ways.walk(u, window_m, [&](std::uint32_t i) { return ways.back(i); });
    const std::uint32_t b = ways.walk(u, window_m, [&](std::uint32_t i) { return ways.ahead(i); });
    const float way = paths.length[b] - paths.length[a];
    if (way > 0) own[u] = static_cast<float>((points[b] - points[a]).norm()) / way;
  }
  // One mean over the neighbours along the path, weighted by nothing: a leap at one place is no verdict.
  for (const std::uint32_t u : paths.order) {
    if (!bears(u)) continue;
    double sum = own[u];
    int count = 1;
    const auto gather = [&](auto step) {
      for (std::uint32_t at = step(u); bears(at); at = step(at)) {
        if (std::abs(paths.length[at] - paths.length[u]) > 0.6 * window_m) break;
        sum += own[at];
        ++count;
      }
    };
    gather([&](std::uint32_t i) { return ways.back(i); });
    gather([&](std::uint32_t i) { return ways.ahead(i); });
    evidence.straight[u] = static_cast<float>(sum / count);
  }
  return evidence;
}

}  // namespace dendrofit
