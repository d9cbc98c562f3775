// SPDX-License-Identifier: GPL-3.0-or-later
#include "recon/image/lines.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace dendrofit {
namespace {

Eigen::Vector2d centre_of(int x, int y) {
  return {x + 0.5, y + 0.5};
}

double length_of(const std::vector<Eigen::Vector2d>& path) {
  double sum = 0;
  for (std::size_t i = 1; i < path.size(); ++i) sum += (path[i] - path[i - 1]).norm();
  return sum;
}

/// Follows lines of degree two from junction to junction.
class Tracer {
 public:
  explicit Tracer(const LineImage& lines) : lines_(lines), owner_(lines.on.size(), kNone) {}

  PlaneGraph run() {
    make_vertices();
    for (int y = 0; y < lines_.height; ++y)
      for (int x = 0; x < lines_.width; ++x)
        if (owner_[lines_.at(x, y)] >= 0) leave(x, y);
    // What is left are closed loops: any pixel of one becomes its vertex.
    for (int y = 0; y < lines_.height; ++y)
      for (int x = 0; x < lines_.width; ++x) {
        const std::size_t p = lines_.at(x, y);
        if (!lines_.on[p] || owner_[p] != kNone) continue;
        owner_[p] = graph_.add_vertex(centre_of(x, y), lines_.distance[p]);
        leave(x, y);
      }
    return std::move(graph_);
  }

 private:
  static constexpr std::int32_t kNone = -1, kUsed = -2;
  using Around = std::array<std::array<int, 2>, 8>;

  /// Ends and lone pixels are vertices, and so is each clump of pixels with three neighbours or more.
  void make_vertices() {
    Around around;
    std::vector<std::array<int, 2>> clump;
    for (int y = 0; y < lines_.height; ++y)
      for (int x = 0; x < lines_.width; ++x) {
        const std::size_t p = lines_.at(x, y);
        if (!lines_.on[p] || owner_[p] != kNone) continue;
        const int n = lines_.neighbours(x, y, around);
        if (n == 2) continue;
        const std::int32_t v = graph_.add_vertex(centre_of(x, y), lines_.distance[p]);
        owner_[p] = v;
        if (n < 2) continue;
        clump.assign(1, {x, y});
        Eigen::Vector2d sum = Eigen::Vector2d::Zero();
        for (std::size_t i = 0; i < clump.size(); ++i) {
          const auto [cx, cy] = clump[i];
          sum += centre_of(cx, cy);
          float& radius = graph_.vertex_radius[static_cast<std::size_t>(v)];
          radius = std::max(radius, lines_.distance[lines_.at(cx, cy)]);
          Around next;
          const int m = lines_.neighbours(cx, cy, next);
          for (int k = 0; k < m; ++k) {
            const auto [nx, ny] = next[static_cast<std::size_t>(k)];
            if (owner_[lines_.at(nx, ny)] != kNone || lines_.neighbours(nx, ny, around) < 3) continue;
            owner_[lines_.at(nx, ny)] = v;
            clump.push_back({nx, ny});
          }
        }
        graph_.vertex[static_cast<std::size_t>(v)] = sum / static_cast<double>(clump.size());
      }
  }

  /// Every path that leaves a vertex' pixel and has not been walked yet.
  void leave(int x, int y) {
    const std::int32_t from = owner_[lines_.at(x, y)];
    Around around;
    const int n = lines_.neighbours(x, y, around);
    for (int k = 0; k < n; ++k) {
      const auto [nx, ny] = around[static_cast<std::size_t>(k)];
      const std::int32_t to = owner_[lines_.at(nx, ny)];
      if (to == kNone) {
        walk(from, nx, ny, x, y);
      } else if (to > from) {
        PlaneGraph::Edge edge{.a = from, .b = to};
        close(edge);
      }
    }
  }

  void walk(std::int32_t from, int x, int y, int px, int py) {
    PlaneGraph::Edge edge{.a = from};
    while (true) {
      const std::size_t p = lines_.at(x, y);
      owner_[p] = kUsed;
      edge.path.push_back(centre_of(x, y));
      edge.radius.push_back(lines_.distance[p]);
      edge.bridge.push_back(lines_.on[p] == 2);
      Around around;
      const int n = lines_.neighbours(x, y, around);
      std::int32_t end = kNone;
      int fx = -1, fy = -1;
      for (int k = 0; k < n; ++k) {
        const auto [nx, ny] = around[static_cast<std::size_t>(k)];
        if (nx == px && ny == py) continue;
        const std::int32_t owner = owner_[lines_.at(nx, ny)];
        if (owner >= 0) end = owner;
        if (owner == kNone) fx = nx, fy = ny;
      }
      if (end < 0 && fx < 0) end = from;  // a loop back to its own vertex
      if (end >= 0) {
        edge.b = end;
        // A short loop beside a junction's clump is an artefact of the grid.
        if (end != from || edge.path.size() > 4) close(edge);
        return;
      }
      px = x, py = y, x = fx, y = fy;
    }
  }

  void close(PlaneGraph::Edge& edge) {
    const auto a = static_cast<std::size_t>(edge.a), b = static_cast<std::size_t>(edge.b);
    edge.path.insert(edge.path.begin(), graph_.vertex[a]);
    edge.path.push_back(graph_.vertex[b]);
    edge.radius.insert(edge.radius.begin(), graph_.vertex_radius[a]);
    edge.radius.push_back(graph_.vertex_radius[b]);
    edge.bridge.insert(edge.bridge.begin(), 0);
    edge.bridge.push_back(0);
    graph_.add_edge(std::move(edge));
  }

  const LineImage& lines_;
  std::vector<std::int32_t> owner_;
  PlaneGraph graph_;
};

}  // namespace

int LineImage::neighbours(int x, int y, std::array<std::array<int, 2>, 8>& out) const {
  static constexpr int dx[] = {0, 1, 1, 1, 0, -1, -1, -1}, dy[] = {-1, -1, 0, 1, 1, 1, 0, -1};
  int n = 0;
  for (int k = 0; k < 8; ++k)
    if (inside(x + dx[k], y + dy[k]) && on[at(x + dx[k], y + dy[k])])
      out[static_cast<std::size_t>(n++)] = {x + dx[k], y + dy[k]};
  return n;
}

std::vector<Eigen::Vector2d> PlaneGraph::Edge::path_from(std::int32_t from) const {
  return from == a ? path : std::vector<Eigen::Vector2d>(path.rbegin(), path.rend());
}

std::int32_t PlaneGraph::add_vertex(const Eigen::Vector2d& px, float radius) {
  vertex.push_back(px);
  vertex_radius.push_back(radius);
  at.emplace_back();
  return static_cast<std::int32_t>(vertex.size() - 1);
}

std::int32_t PlaneGraph::add_edge(Edge edge) {
  const auto index = static_cast<std::int32_t>(edges.size());
  edge.length = length_of(edge.path);
  at[static_cast<std::size_t>(edge.a)].push_back(index);
  at[static_cast<std::size_t>(edge.b)].push_back(index);
  edges.push_back(std::move(edge));
  return index;
}

void PlaneGraph::remove_edge(std::int32_t index) {
  Edge& edge = edges[static_cast<std::size_t>(index)];
  for (const std::int32_t v : {edge.a, edge.b}) {
    auto& list = at[static_cast<std::size_t>(v)];
    list.erase(std::remove(list.begin(), list.end(), index), list.end());
  }
  edge.alive = false;
}

void PlaneGraph::dissolve(std::int32_t v) {
  const auto& list = at[static_cast<std::size_t>(v)];
  if (list.size() != 2 || list[0] == list[1]) return;
  const std::int32_t first = list[0], second = list[1];
  Edge joined = edges[static_cast<std::size_t>(first)];
  Edge tail = edges[static_cast<std::size_t>(second)];
  const auto reverse = [](Edge& e) {
    std::swap(e.a, e.b);
    std::reverse(e.path.begin(), e.path.end());
    std::reverse(e.radius.begin(), e.radius.end());
    std::reverse(e.bridge.begin(), e.bridge.end());
  };
  if (joined.b != v) reverse(joined);
  if (tail.a != v) reverse(tail);
  joined.path.insert(joined.path.end(), tail.path.begin() + 1, tail.path.end());
  joined.radius.insert(joined.radius.end(), tail.radius.begin() + 1, tail.radius.end());
  joined.bridge.insert(joined.bridge.end(), tail.bridge.begin() + 1, tail.bridge.end());
  joined.b = tail.b;
  remove_edge(first);
  remove_edge(second);
  add_edge(std::move(joined));
}

std::int32_t PlaneGraph::split(std::int32_t index, std::size_t i) {
  const Edge whole = edges[static_cast<std::size_t>(index)];
  const std::int32_t v = add_vertex(whole.path[i], whole.radius[i]);
  const auto cut = static_cast<std::ptrdiff_t>(i);
  Edge head{.a = whole.a,
            .b = v,
            .path = {whole.path.begin(), whole.path.begin() + cut + 1},
            .radius = {whole.radius.begin(), whole.radius.begin() + cut + 1},
            .bridge = {whole.bridge.begin(), whole.bridge.begin() + cut + 1}};
  Edge tail{.a = v,
            .b = whole.b,
            .path = {whole.path.begin() + cut, whole.path.end()},
            .radius = {whole.radius.begin() + cut, whole.radius.end()},
            .bridge = {whole.bridge.begin() + cut, whole.bridge.end()}};
  remove_edge(index);
  add_edge(std::move(head));
  add_edge(std::move(tail));
  return v;
}

PlaneGraph trace(const LineImage& lines) {
  return Tracer(lines).run();
}

void drop_spurs(PlaneGraph& graph, double spur_radii) {
  struct Spur {
    double reach;
    std::int32_t edge, bearer;
  };
  for (bool changed = true; changed;) {
    changed = false;
    std::vector<Spur> spurs;
    for (std::size_t e = 0; e < graph.edges.size(); ++e) {
      const PlaneGraph::Edge& edge = graph.edges[e];
      if (!edge.alive || edge.a == edge.b) continue;
      const bool end_a = graph.degree(edge.a) == 1, end_b = graph.degree(edge.b) == 1;
      if (end_a == end_b) continue;
      const std::int32_t bearer = end_a ? edge.b : edge.a;
      const double radius = graph.vertex_radius[static_cast<std::size_t>(bearer)];
      const double reach = edge.length / std::max(1.0, radius);
      if (reach < spur_radii) spurs.push_back({reach, static_cast<std::int32_t>(e), bearer});
    }
    std::stable_sort(spurs.begin(), spurs.end(),
                     [](const Spur& l, const Spur& r) { return l.reach < r.reach; });
    for (const Spur& spur : spurs) {
      if (graph.degree(spur.bearer) < 3) continue;  // the last two arms are one line
      graph.remove_edge(spur.edge);
      changed = true;
    }
    for (std::size_t v = 0; v < graph.vertex.size(); ++v) graph.dissolve(static_cast<std::int32_t>(v));
  }
}

}  // namespace dendrofit
