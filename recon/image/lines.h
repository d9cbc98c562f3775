// SPDX-License-Identifier: GPL-3.0-or-later
// One-pixel-wide lines in a picture: pieces joined over gaps, and traced to a graph of vertices and paths.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace dendrofit {

/// Lines of a silhouette with the distance to its outline.
struct LineImage {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> on;  ///< 1: on a line; 2: on a line drawn over a gap
  std::vector<float> distance;   ///< to the outline, pixels; 0 outside the silhouette

  bool inside(int x, int y) const { return x >= 0 && y >= 0 && x < width && y < height; }
  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  }
  /// Marked pixels among the eight around (x, y), in a fixed order; their number.
  int neighbours(int x, int y, std::array<std::array<int, 2>, 8>& out) const;
};

/// Draws lines (value 2) from the ends of pieces to other pieces no farther than max(gap_px, gap_radii *
/// radius), where the piece goes on in the same direction within turn_deg (a lone pixel in any); nearest
/// first, until no two pieces can be joined. Returns the number of joins.
std::size_t join_pieces(LineImage& lines, double gap_px, double gap_radii, double turn_deg);

/// Vertices (ends and junctions) and the paths between them.
struct PlaneGraph {
  struct Edge {
    std::int32_t a = -1, b = -1;        ///< vertices
    std::vector<Eigen::Vector2d> path;  ///< pixel centres from a to b, both included
    std::vector<float> radius;          ///< distance to the outline along the path
    std::vector<std::uint8_t> bridge;   ///< 1: over a gap
    bool alive = true;
    double length = 0;

    /// The path from vertex `from` on.
    std::vector<Eigen::Vector2d> path_from(std::int32_t from) const;
    std::int32_t other(std::int32_t vertex) const { return vertex == a ? b : a; }
  };
  std::vector<Eigen::Vector2d> vertex;
  std::vector<float> vertex_radius;
  std::vector<Edge> edges;
  std::vector<std::vector<std::int32_t>> at;  ///< edges at each vertex (a loop stands twice)

  std::int32_t add_vertex(const Eigen::Vector2d& px, float radius);
  std::int32_t add_edge(Edge edge);
  void remove_edge(std::int32_t edge);
  std::size_t degree(std::int32_t v) const { return at[static_cast<std::size_t>(v)].size(); }
  /// Two edges that meet alone at `v` become one.
  void dissolve(std::int32_t v);
  /// Cuts an edge at its path's point `i` (neither first nor last); the new vertex.
  std::int32_t split(std::int32_t edge, std::size_t i);
};

PlaneGraph trace(const LineImage& lines);

/// Drops ends that reach less than `spur_radii` radii of the wood they leave, shortest first.
void drop_spurs(PlaneGraph& graph, double spur_radii);

}  // namespace dendrofit
