// SPDX-License-Identifier: GPL-3.0-or-later
// Lines in a picture become a rooted tree: foot, passing branches, and which way every path grows.
#pragma once

#include "recon/image/lines.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace dendrofit {

/// The vertex the tree stands on: `wanted` where given (the nearest point of a line), otherwise the thickest
/// end in the lowest tenth of the lines' height, the two corners of a cut stem dropped and the line led down
/// to the outline.
std::int32_t find_root(PlaneGraph& graph, const LineImage& lines,
                       const std::optional<Eigen::Vector2d>& wanted);

/// At an end of an edge (2 * edge for its vertex a, + 1 for b): the end it goes on to where two branches pass
/// each other; -1 where it does not.
struct Passes {
  std::vector<std::int32_t> partner;
  std::vector<char> consumed;  ///< by edge: the piece that two passing branches share
  std::size_t count = 0;
};

/// Crossings: four arms at a vertex, or at two vertices a short piece apart, whose directions 3 to 8 radii
/// out pair so that both pairs go straight on within `turn_deg` with radii within a factor 0.6; taken only
/// where everything stays connected with the root. Loops that remain are left to grow_order.
Passes find_passes(const PlaneGraph& graph, std::int32_t root, double turn_deg);

/// One edge in the direction the tree grows along it.
struct GrownEdge {
  std::int32_t edge = -1;
  std::int32_t from = -1;    ///< vertex
  std::int32_t parent = -1;  ///< index into the list, before this one; -1 at the root
};

/// Cheapest paths from the root (length, turns and thickening cost), every edge grown once: loops are cut
/// where their last edge ends.
std::vector<GrownEdge> grow_order(const PlaneGraph& graph, std::int32_t root, const Passes& passes);

/// Unit direction of an edge's path away from vertex `from`, between two distances along it (pixels; a
/// short edge from 0.4 of its length on); zero where it is too short to tell. `radius`: mean along that
/// stretch.
Eigen::Vector2d arm_direction(const PlaneGraph::Edge& edge, std::int32_t from, double near_px, double far_px,
                              double* radius = nullptr);

}  // namespace dendrofit
