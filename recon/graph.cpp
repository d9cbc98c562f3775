// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/graph.h"

#include "core/errors.h"
#include "core/parallel.h"
#include "recon/cheapest_first.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dendrofit {
namespace {

constexpr float kSparsest = 2.0f;      // in usual spacings
constexpr double kLinkSpacings = 3.0;  // a longer link would leap over a gap: bridge_gaps() judges those

}  // namespace

double step_cost(double length_m, double spacing_m) {
  return length_m * (1 + length_m / std::max(1e-6, spacing_m));
}

void GraphOptions::validate() const {
  require(neighbors >= 4 && neighbors <= 64, "neighbors", neighbors, "must lie between 4 and 64");
  require(std::isfinite(max_gap_m) && max_gap_m >= 0 && max_gap_m <= 20, "max_gap_m", max_gap_m,
          "must lie between 0 and 20 m");
  require(threads >= 0, "threads", threads, "must not be negative");
}

PointGraph neighbor_graph(const std::vector<Vec3>& points, const GraphOptions& options, Progress& progress) {
  options.validate();
  PointGraph graph;
  const std::size_t n = points.size();
  const auto k = static_cast<std::size_t>(options.neighbors);
  graph.spacing.assign(n, 0);
  graph.first.assign(n + 1, 0);
  if (n == 0) return graph;
  progress.begin("neighbours", static_cast<double>(n), "points");
  graph.index = std::make_shared<const Neighbors>(points);
  const Neighbors& index = *graph.index;
  std::vector<std::uint32_t> nearest(n * k, Paths::kNone);
  parallel_blocks(n, 4096, options.threads, [&](std::size_t first, std::size_t last) {
    progress.check();
    std::vector<Neighbor> found;
    for (std::size_t i = first; i < last; ++i) {
      index.nearest(points[i], k + 1, found);
      std::size_t used = 0;
      for (const Neighbor& f : found) {
        if (f.index == i || used == k) continue;
        nearest[i * k + used++] = f.index;
        if (used == 4) graph.spacing[i] = static_cast<float>(std::sqrt(f.distance_squared));
      }
      if (used > 0 && used < 4)
        graph.spacing[i] = static_cast<float>(std::sqrt(found.back().distance_squared));
    }
    progress.advance(static_cast<double>(last - first));
  });
  std::vector<float> sorted = graph.spacing;
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(n / 2), sorted.end());
  graph.typical_spacing_m = sorted[n / 2];
  // The sparser end of a link decides how long it may be, but never less than the scan's usual spacing
  // allows.
  const auto usual = static_cast<float>(graph.typical_spacing_m);
  const auto names = [&](std::size_t who, std::size_t whom) {  // among its nearest
    const std::uint32_t *row = nearest.data() + who * k, sought = static_cast<std::uint32_t>(whom);
    unsigned hits = 0;
    for (std::size_t j = 0; j < k; ++j) hits += row[j] == sought;
    return hits > 0;
  };
  std::vector<std::uint64_t> one_sided(n, 0);  // bit by bit: links that the other end does not name
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i * k; j < (i + 1) * k && nearest[j] != Paths::kNone; ++j) {
      const std::uint32_t v = nearest[j];
      const double limit =
          kLinkSpacings * std::clamp(std::min(graph.spacing[i], graph.spacing[v]), usual, kSparsest * usual);
      if ((points[i] - points[v]).squaredNorm() <= limit * limit) {
        ++graph.first[i + 1];
        if (!names(v, i)) {
          ++graph.first[v + 1];
          one_sided[i] |= std::uint64_t{1} << (j - i * k);
        }
      } else {
        nearest[j] = static_cast<std::uint32_t>(i);
      }
    }
  for (std::size_t i = 0; i < n; ++i) graph.first[i + 1] += graph.first[i];
  graph.to.resize(graph.first[n]);
  std::vector<std::size_t> fill(graph.first.begin(), graph.first.end() - 1);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i * k; j < (i + 1) * k && nearest[j] != Paths::kNone; ++j) {
      if (nearest[j] == i) continue;
      graph.to[fill[i]++] = nearest[j];
      if (one_sided[i] >> (j - i * k) & 1) graph.to[fill[nearest[j]]++] = static_cast<std::uint32_t>(i);
    }
  progress.end();
  return graph;
}

Parts connected_parts(const PointGraph& graph, const std::vector<char>& open) {
  Parts parts;
  const std::size_t n = graph.size();
  parts.part.assign(n, Paths::kNone);
  std::vector<std::uint32_t> stack;
  for (std::size_t i = 0; i < n; ++i) {
    if (parts.part[i] != Paths::kNone || !open[i]) continue;
    const auto id = static_cast<std::uint32_t>(parts.points.size());
    parts.points.push_back(0);
    parts.part[i] = id;
    stack.push_back(static_cast<std::uint32_t>(i));
    while (!stack.empty()) {
      const std::uint32_t u = stack.back();
      stack.pop_back();
      ++parts.points[id];
      for (const std::uint32_t v : graph.of(u)) {
        if (parts.part[v] != Paths::kNone || !open[v]) continue;
        parts.part[v] = id;
        stack.push_back(v);
      }
    }
  }
  return parts;
}

Paths shortest_paths(const std::vector<Vec3>& points, const PointGraph& graph,
                     const std::vector<Bridge>& bridges, const std::vector<char>& open,
                     const std::vector<std::uint32_t>& sources, Progress& progress,
                     const std::vector<Gate>& gates) {
  constexpr double kTurnWeight = 12.0;
  constexpr float kGatePrice = 4;     // as much as about two metres of straight wood
  constexpr double kMemory_m = 0.15;  // the way is judged against about this much of it before
  const std::size_t n = points.size();
  constexpr float kFar = std::numeric_limits<float>::infinity();
  Paths paths;
  paths.parent.assign(n, Paths::kNone);
  paths.length.assign(n, kFar);
  /// What a step to a point needs to know; all else is settled when its turn has come.
  struct Offer {
    float cost = kFar;
    std::uint32_t from = Paths::kNone;
  };
  constexpr float kDone = -kFar;  // nothing is cheaper
  std::vector<Offer> best(n);
  std::vector<Eigen::Vector3f> heading(n, Eigen::Vector3f::Zero());
  for (std::size_t i = 0; i < n; ++i)
    if (!open[i]) best[i].cost = kDone;
  std::vector<std::pair<std::uint32_t, std::pair<std::uint32_t, float>>> crossings;
  crossings.reserve(2 * bridges.size());
  for (const Bridge& b : bridges) {
    crossings.push_back({b.a, {b.b, static_cast<float>(b.cost_m)}});
    crossings.push_back({b.b, {b.a, static_cast<float>(b.cost_m)}});
  }
  std::sort(crossings.begin(), crossings.end());
  const double scale = std::max(1e-6, graph.typical_spacing_m);

  std::vector<std::uint32_t> inside(gates.empty() ? 0 : n, Paths::kNone), door = inside;
  for (std::size_t g = 0; g < gates.size(); ++g) {
    for (const std::uint32_t p : gates[g].inside) inside[p] = static_cast<std::uint32_t>(g);
    for (const std::uint32_t p : gates[g].door) door[p] = static_cast<std::uint32_t>(g);
  }
  const auto is_shut = [&](std::uint32_t u, std::uint32_t v) {
    return !gates.empty() && inside[v] != Paths::kNone && inside[u] != inside[v] && door[u] != inside[v];
  };

  CheapestFirst queue(scale / 16);
  for (const std::uint32_t s : sources) {
    paths.length[s] = 0;
    if (!open[s]) continue;
    best[s].cost = 0;
    queue.push(0, s);
  }
  /// The point whose turn it is.
  struct Here {
    std::uint32_t point;
    float cost, heading_length;
    Eigen::Vector3f heading;
  };
  const auto offer = [&](const Here& u, std::uint32_t v, const Vec3& way, double c) {
    const Eigen::Vector3f step = way.cast<float>();
    const float length = step.norm();
    if (u.heading_length > 0 && length > 0) {
      const float cosine = u.heading.dot(step) / (u.heading_length * length);
      c *= 1 + kTurnWeight * (1 - cosine);
    }
    const float total = u.cost + static_cast<float>(c) + (is_shut(u.point, v) ? kGatePrice : 0.0f);
    if (!(total < best[v].cost)) return;
    best[v] = {total, u.point};
    queue.push(total, v);
  };
  progress.begin("paths", static_cast<double>(n), "points");
  paths.order.reserve(n);
  while (!queue.empty()) {
    const std::uint32_t at = queue.pop();
    if (best[at].cost == kDone) continue;
    if (const std::uint32_t from = best[at].from; from != Paths::kNone) {
      const Eigen::Vector3f step = (points[at] - points[from]).cast<float>();
      const float length = step.norm();
      const float keep = static_cast<float>(std::exp(-length / kMemory_m));
      paths.parent[at] = from;
      paths.length[at] = paths.length[from] + length;
      heading[at] = heading[from] * keep + step;
    }
    const Here u{at, best[at].cost, heading[at].norm(), heading[at]};
    best[at].cost = kDone;
    paths.order.push_back(at);
    if (paths.order.size() % 65536 == 0) {
      progress.check();
      progress.advance(65536);
    }
    for (const std::uint32_t v : graph.of(at)) {
      // Most steps lead nowhere new, straight on though they were.
      constexpr float kLeast = 0.999f;  // of a step's cost, whatever rounding does
      const float spare = best[v].cost - u.cost;
      if (!(spare > 0)) continue;
      const Vec3 way = points[v] - points[at];
      const double length = way.norm();
      if (kLeast * static_cast<float>(length) < spare) offer(u, v, way, step_cost(length, scale));
    }
    auto it = std::lower_bound(crossings.begin(), crossings.end(), at,
                               [](const auto& e, std::uint32_t value) { return e.first < value; });
    for (; it != crossings.end() && it->first == at; ++it)
      if (const std::uint32_t v = it->second.first; best[v].cost != kDone)
        offer(u, v, points[v] - points[at], it->second.second);
  }
  progress.end();
  return paths;
}

}  // namespace dendrofit
