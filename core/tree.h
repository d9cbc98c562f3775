// SPDX-License-Identifier: GPL-3.0-or-later
// The one tree type: reconstruction and growth models make it; leaves, fit, metrics and files consume it.
#pragma once

#include "core/types.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string_view>
#include <vector>

namespace dendrofit {

/// How a node's radius came about.
enum class RadiusQuality : std::uint8_t {
  measured,      ///< fitted to points around this very piece of wood (or grown by a model)
  interpolated,  ///< between measured radii on the same axis
  allometric,    ///< from the tree's own relation between radius and position
  extrapolated   ///< beyond any evidence; drawn to complete the tree
};

/// "measured", "interpolated", "allometric" or "extrapolated".
std::string_view to_string(RadiusQuality quality);
/// The reverse; throws InputError for any other word.
RadiusQuality radius_quality_from(std::string_view word);

/// Everything known of one node; see Tree.
struct TreeNode {
  Vec3 start = Vec3::Zero();
  Vec3 end = Vec3::Zero();
  std::int32_t parent = -1;
  double radius = 0;
  std::int32_t axis = 0;
  std::int32_t order = 0;
  std::int32_t birth_cycle = -1;
  RadiusQuality quality = RadiusQuality::measured;
  double radius_se = std::numeric_limits<double>::quiet_NaN();
};

/// A tree, several stems or a whole stand, as flat arrays of equal length; copyable, without pointers.
///
/// Node i is the distal end of cylinder i, which runs from start[i] to end[i] with one radius (volume
/// equivalent). Where wood continues, start[i] == end[parent[i]]; a branch starts on its parent's surface,
/// anywhere along it.
///
/// Invariants (validate() checks them): every coordinate finite; parent[i] < i, or -1 for a root; radius[i] >
/// 0; length > 0; axis ids 0..axis_count-1, each an unbranched run of nodes in which a node's parent is the
/// run's previous node; order 0 on axes that hold a root, and greater than the parent's order on every other
/// axis.
struct Tree {
  /// World position = origin_shift + local position; keeps georeferenced coordinates exact (metres).
  Vec3 origin_shift = Vec3::Zero();

  std::vector<Vec3> start;                ///< proximal end of the cylinder, metres, local
  std::vector<Vec3> end;                  ///< distal end: the node, metres, local
  std::vector<std::int32_t> parent;       ///< node index, -1 for a root
  std::vector<double> radius;             ///< metres
  std::vector<std::int32_t> axis;         ///< axis (branch) id, from 0
  std::vector<std::int32_t> order;        ///< 0 stem, 1 branch on the stem, ...
  std::vector<std::int32_t> birth_cycle;  ///< growth cycle the node appeared in, -1 unknown
  std::vector<RadiusQuality> quality;     ///< where the radius comes from
  std::vector<double> radius_se;          ///< standard error of the radius, metres, NaN unknown

  std::size_t size() const { return end.size(); }
  bool empty() const { return end.empty(); }
  std::int32_t axis_count() const;

  void reserve(std::size_t nodes);
  /// Appends a node and returns its index.
  std::int32_t add(const TreeNode& node);
  TreeNode node(std::size_t i) const;

  double length(std::size_t i) const { return (end[i] - start[i]).norm(); }
  /// Unit vector from start to end; +z where the length is zero.
  Vec3 direction(std::size_t i) const;
  double volume(std::size_t i) const;

  /// Throws InputError naming node, field, value and limit at the first broken invariant.
  void validate() const;
};

}  // namespace dendrofit
