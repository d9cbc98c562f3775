// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/image/rooting.h"

#include "core/errors.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <tuple>

namespace dendrofit {
namespace {

struct Extent {
  double top = std::numeric_limits<double>::max(), bottom = std::numeric_limits<double>::lowest();
};

/// Rows covered by the connected part of the graph with the most length.
Extent main_part(const PlaneGraph& graph, std::vector<char>& in_main) {
  std::vector<std::int32_t> part(graph.vertex.size(), -1);
  std::vector<double> length;
  for (std::size_t s = 0; s < part.size(); ++s) {
    if (part[s] >= 0) continue;
    const auto id = static_cast<std::int32_t>(length.size());
    length.push_back(0);
    std::vector<std::int32_t> stack = {static_cast<std::int32_t>(s)};
    part[s] = id;
    while (!stack.empty()) {
      const std::int32_t v = stack.back();
      stack.pop_back();
      for (const std::int32_t e : graph.at[static_cast<std::size_t>(v)]) {
        const PlaneGraph::Edge& edge = graph.edges[static_cast<std::size_t>(e)];
        length.back() += 0.5 * edge.length;
        const std::int32_t w = edge.other(v);
        if (part[static_cast<std::size_t>(w)] >= 0) continue;
        part[static_cast<std::size_t>(w)] = id;
        stack.push_back(w);
      }
    }
  }
  const auto best =
      static_cast<std::int32_t>(std::max_element(length.begin(), length.end()) - length.begin());
  Extent extent;
  in_main.assign(part.size(), 0);
  for (const PlaneGraph::Edge& edge : graph.edges) {
    if (!edge.alive || part[static_cast<std::size_t>(edge.a)] != best) continue;
    for (const std::int32_t v : {edge.a, edge.b}) in_main[static_cast<std::size_t>(v)] = 1;
    for (const Eigen::Vector2d& p : edge.path) {
      extent.top = std::min(extent.top, p.y());
      extent.bottom = std::max(extent.bottom, p.y());
    }
  }
  return extent;
}

/// Thinning leads two lines into the corners of a stem that is cut square: both go.
void drop_corners(PlaneGraph& graph, double lowest_row) {
  for (std::size_t v = 0; v < graph.vertex.size(); ++v) {
    const double radius = graph.vertex_radius[v];
    std::vector<std::int32_t> corners;
    for (const std::int32_t e : graph.at[v]) {
      const PlaneGraph::Edge& edge = graph.edges[static_cast<std::size_t>(e)];
      const auto far = static_cast<std::size_t>(edge.other(static_cast<std::int32_t>(v)));
      if (graph.at[far].size() == 1 && edge.length < 2.2 * radius + 2 && graph.vertex[far].y() > lowest_row &&
          graph.vertex[far].y() > graph.vertex[v].y() && graph.vertex_radius[far] < 0.5 * radius + 1)
        corners.push_back(e);
    }
    if (corners.size() < 2) continue;
    for (const std::int32_t e : corners) graph.remove_edge(e);
  }
  for (std::size_t v = 0; v < graph.vertex.size(); ++v) graph.dissolve(static_cast<std::int32_t>(v));
}

/// The end itself, or, where the line turns from the stem's middle into a corner of its cut foot, the point
/// before that: the distance to the outline falls on the way into a corner.
std::int32_t without_corner(PlaneGraph& graph, std::int32_t end) {
  const std::int32_t index = graph.at[static_cast<std::size_t>(end)].front();
  const PlaneGraph::Edge& edge = graph.edges[static_cast<std::size_t>(index)];
  const bool forward = edge.a == end;
  const std::size_t n = edge.path.size();
  const auto at = [&](std::size_t i) { return forward ? i : n - 1 - i; };
  float widest = 0;
  for (std::size_t i = 0; i < n && static_cast<float>(i) < 8 + 3 * widest; ++i)
    widest = std::max(widest, edge.radius[at(i)]);
  std::size_t i = 0;
  while (i + 2 < n && edge.radius[at(i)] < 0.85f * widest) ++i;
  if (i == 0 || at(i) == 0 || at(i) + 1 == n) return end;
  const std::int32_t cut = graph.split(index, at(i));
  for (const std::int32_t e : std::vector<std::int32_t>(graph.at[static_cast<std::size_t>(cut)]))
    if (graph.edges[static_cast<std::size_t>(e)].other(cut) == end) graph.remove_edge(e);
  return cut;
}

/// Goes on from an end in its direction to the outline.
std::int32_t lead_to_outline(PlaneGraph& graph, const LineImage& lines, std::int32_t end) {
  const auto v = static_cast<std::size_t>(end);
  const double radius = std::max(1.0f, graph.vertex_radius[v]);
  const PlaneGraph::Edge& edge = graph.edges[static_cast<std::size_t>(graph.at[v].front())];
  Eigen::Vector2d down = -arm_direction(edge, end, 0, 3 * radius);
  if (down.y() < 0.5) down = Eigen::Vector2d::UnitY();  // a foot points down
  PlaneGraph::Edge more{.a = end};
  more.path.push_back(graph.vertex[v]);
  more.radius.push_back(graph.vertex_radius[v]);
  for (Eigen::Vector2d p = graph.vertex[v] + down;; p += down) {
    const int x = static_cast<int>(std::floor(p.x())), y = static_cast<int>(std::floor(p.y()));
    if (!lines.inside(x, y) || lines.distance[lines.at(x, y)] <= 0) break;
    more.path.push_back(p);
    more.radius.push_back(graph.vertex_radius[v]);
  }
  if (more.path.size() < 2) return end;
  more.bridge.assign(more.path.size(), 0);
  more.b = graph.add_vertex(more.path.back(), graph.vertex_radius[v]);
  const std::int32_t foot = more.b;
  graph.add_edge(std::move(more));
  graph.dissolve(end);
  return foot;
}

std::int32_t nearest_point(PlaneGraph& graph, const Eigen::Vector2d& wanted) {
  double best = std::numeric_limits<double>::max();
  std::int32_t edge = -1;
  std::size_t at = 0;
  for (std::size_t e = 0; e < graph.edges.size(); ++e)
    for (std::size_t i = 0; graph.edges[e].alive && i < graph.edges[e].path.size(); ++i) {
      const double d = (graph.edges[e].path[i] - wanted).squaredNorm();
      if (d < best) std::tie(best, edge, at) = std::tuple(d, static_cast<std::int32_t>(e), i);
    }
  const PlaneGraph::Edge& found = graph.edges[static_cast<std::size_t>(edge)];
  if (at == 0) return found.a;
  if (at + 1 == found.path.size()) return found.b;
  return graph.split(edge, at);
}

}  // namespace

Eigen::Vector2d arm_direction(const PlaneGraph::Edge& edge, std::int32_t from, double near_px, double far_px,
                              double* radius) {
  const bool forward = from == edge.a;
  const std::size_t n = edge.path.size();
  const auto index = [&](std::size_t i) { return forward ? i : n - 1 - i; };
  // A path shorter than the stretch tells by its outer part.
  near_px = std::min(near_px, 0.4 * edge.length);
  double run = 0, sum = 0;
  int count = 0;
  Eigen::Vector2d first = edge.path[index(0)], last = first;
  for (std::size_t i = 1; i < n && run < far_px; ++i) {
    run += (edge.path[index(i)] - edge.path[index(i - 1)]).norm();
    if (run < near_px) first = edge.path[index(i)];
    last = edge.path[index(i)];
    if (run >= near_px && edge.radius[index(i)] > 0) {
      sum += edge.radius[index(i)];
      ++count;
    }
  }
  if (radius) *radius = count > 0 ? sum / count : 0;
  const Eigen::Vector2d d = last - first;
  return d.norm() >= std::min(3.0, 0.5 * (far_px - near_px)) ? Eigen::Vector2d(d.normalized())
                                                             : Eigen::Vector2d(Eigen::Vector2d::Zero());
}

std::int32_t find_root(PlaneGraph& graph, const LineImage& lines,
                       const std::optional<Eigen::Vector2d>& wanted) {
  std::vector<char> in_main;
  Extent extent = main_part(graph, in_main);
  if (!(extent.bottom > extent.top))
    throw SolverError("no tree found: the silhouette holds no line to follow");
  if (wanted) return nearest_point(graph, *wanted);
  const double lowest = extent.bottom - 0.1 * (extent.bottom - extent.top);
  drop_corners(graph, lowest - 0.05 * (extent.bottom - extent.top));
  std::int32_t best = -1;
  double thickest = -1;
  for (std::size_t v = 0; v < graph.vertex.size(); ++v) {
    if (graph.at[v].size() != 1 || v >= in_main.size() || !in_main[v] || graph.vertex[v].y() < lowest)
      continue;
    double radius = 0;
    const double reach = 0.05 * (extent.bottom - extent.top);
    arm_direction(graph.edges[static_cast<std::size_t>(graph.at[v].front())], static_cast<std::int32_t>(v), 0,
                  reach, &radius);
    if (radius > thickest) {
      thickest = radius;
      best = static_cast<std::int32_t>(v);
    }
  }
  if (best < 0) {  // the lowest point is not an end: a loop stands there
    Eigen::Vector2d low(0, -1);
    for (std::size_t v = 0; v < in_main.size(); ++v)
      if (in_main[v] && !graph.at[v].empty() && graph.vertex[v].y() > low.y()) low = graph.vertex[v];
    return nearest_point(graph, low);
  }
  return lead_to_outline(graph, lines, without_corner(graph, best));
}

std::vector<GrownEdge> grow_order(const PlaneGraph& graph, std::int32_t root, const Passes& passes) {
  struct Candidate {
    double cost;
    std::int32_t edge, from, parent;
    bool operator>(const Candidate& o) const {
      return std::tie(cost, edge, from) > std::tie(o.cost, o.edge, o.from);
    }
  };
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> queue;
  std::vector<char> grown(graph.edges.size(), 0);
  std::vector<GrownEdge> order;
  std::vector<double> cost_of;

  const auto step_cost = [&](std::int32_t edge, std::int32_t from, const GrownEdge* before) {
    const PlaneGraph::Edge& e = graph.edges[static_cast<std::size_t>(edge)];
    const double scale = std::max(1.0f, graph.vertex_radius[static_cast<std::size_t>(from)]);
    double own = 0, tip = 0, base = 0;
    const Eigen::Vector2d out = arm_direction(e, from, scale, 8 * scale + 4, &own);
    arm_direction(e, from, 0, 0.5 * e.length, &base);
    arm_direction(e, e.other(from), 0, 0.5 * e.length, &tip);
    double turn = 0, thickening = std::max(0.0, tip / std::max(0.5, base) - 1);
    if (before) {
      const PlaneGraph::Edge& p = graph.edges[static_cast<std::size_t>(before->edge)];
      double bearer = 0;
      const Eigen::Vector2d in = -arm_direction(p, p.other(before->from), scale, 8 * scale + 4, &bearer);
      if (in.norm() > 0 && out.norm() > 0) turn = std::acos(std::clamp(in.dot(out), -1.0, 1.0));
      thickening += std::max(0.0, own / std::max(0.5, bearer) - 1);
    }
    // A bend or a thickening weighs as much on a short piece as on one of some radii.
    return e.length + (turn + thickening) * (e.length + 10 * scale);
  };
  const auto offer = [&](std::int32_t edge, std::int32_t from, std::int32_t parent) {
    if (grown[static_cast<std::size_t>(edge)] || passes.consumed[static_cast<std::size_t>(edge)]) return;
    const GrownEdge* before = parent < 0 ? nullptr : &order[static_cast<std::size_t>(parent)];
    const double start = parent < 0 ? 0 : cost_of[static_cast<std::size_t>(parent)];
    queue.push({start + step_cost(edge, from, before), edge, from, parent});
  };
  for (const std::int32_t e : graph.at[static_cast<std::size_t>(root)]) offer(e, root, -1);
  while (!queue.empty()) {
    const Candidate next = queue.top();
    queue.pop();
    if (grown[static_cast<std::size_t>(next.edge)]) continue;
    grown[static_cast<std::size_t>(next.edge)] = 1;
    order.push_back({next.edge, next.from, next.parent});
    cost_of.push_back(next.cost);
    const auto own = static_cast<std::int32_t>(order.size() - 1);
    const PlaneGraph::Edge& edge = graph.edges[static_cast<std::size_t>(next.edge)];
    const std::int32_t to = edge.other(next.from);
    const std::int32_t end = 2 * next.edge + (to == edge.b ? 1 : 0);
    const std::int32_t partner = passes.partner[static_cast<std::size_t>(end)];
    if (partner >= 0) {
      const PlaneGraph::Edge& beyond = graph.edges[static_cast<std::size_t>(partner / 2)];
      offer(partner / 2, partner % 2 ? beyond.b : beyond.a, own);
      continue;
    }
    for (const std::int32_t e : graph.at[static_cast<std::size_t>(to)]) {
      const PlaneGraph::Edge& other = graph.edges[static_cast<std::size_t>(e)];
      if (passes.partner[static_cast<std::size_t>(2 * e + (to == other.b ? 1 : 0))] < 0) offer(e, to, own);
    }
  }
  return order;
}

}  // namespace dendrofit
