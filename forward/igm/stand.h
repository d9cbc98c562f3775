// SPDX-License-Identifier: GPL-3.0-or-later
// The state of growing trees: flat arrays, nodes in the order of their making, so that a node comes after the
// one it grows from and an axis after the one that bears it. Every pass of the model is then one sweep up or
// down.
#pragma once

#include "core/tree.h"
#include "forward/environment/voxels.h"
#include "forward/igm/parameters.h"

#include <cstdint>
#include <span>
#include <vector>

namespace dendrofit::igm {

/// A stem and all it bears: one pool of resource (a shrub has several).
struct Plant {
  int tree = 0;  ///< the site's tree it belongs to
  Vec3 root = Vec3::Zero();
  std::uint32_t trunk_laterals = 0;  ///< made so far; each turns the next by 135 degrees
};

/// One column an attribute, one entry a node. A node is the distal end of its internode.
struct Nodes {
  std::vector<Vec3> position;
  std::vector<std::int32_t> previous;  ///< node its internode starts at; -1 at a root
  std::vector<std::int32_t> axis;
  std::vector<std::int32_t> birth;  ///< cycle
  std::vector<std::uint32_t> id;    ///< never reused: the key of its random draws
  std::vector<Voxel> voxel;
  std::vector<double> pipe;  ///< radius^v
  std::vector<Fixed> shade;  ///< at its voxel, its own and the obstacles' included
  std::vector<Fixed> obstacle_shade;
  std::vector<std::int32_t> laterals;  ///< living lateral axes it bears

  std::size_t size() const { return position.size(); }
};

/// One entry an axis. The first axis of each plant is its trunk.
struct Axes {
  std::vector<std::int32_t> base;  ///< node it grows from, -1 for a trunk
  std::vector<std::int32_t> plant;
  std::vector<std::int32_t> order;  ///< trunk 1
  std::vector<std::int32_t> tip;    ///< its last node
  std::vector<std::int32_t> sides;  ///< laterals made so far, for alternation
  std::vector<std::uint32_t> id;    ///< never reused

  std::size_t size() const { return base.size(); }
};

struct Stand {
  std::vector<IgmParameters> parameters;  ///< by tree
  std::vector<Plant> plants;
  Nodes nodes;
  Axes axes;
  std::uint32_t next_node_id = 0;
  std::uint32_t next_axis_id = 0;
  VoxelFrame frame;

  // Nodes of each axis from base to tip; valid until nodes are added or dropped.
  std::vector<std::int32_t> axis_first;  ///< axes + 1 entries
  std::vector<std::int32_t> axis_nodes;

  std::span<const std::int32_t> nodes_of(std::size_t axis) const {
    return {axis_nodes.data() + axis_first[axis],
            static_cast<std::size_t>(axis_first[axis + 1] - axis_first[axis])};
  }
  const IgmParameters& parameters_of_axis(std::size_t axis) const {
    return parameters[static_cast<std::size_t>(plants[static_cast<std::size_t>(axes.plant[axis])].tree)];
  }
  int tree_of_axis(std::size_t axis) const { return plants[static_cast<std::size_t>(axes.plant[axis])].tree; }
  bool is_tip(std::size_t node) const {
    return axes.tip[static_cast<std::size_t>(nodes.axis[node])] == static_cast<std::int32_t>(node);
  }
  /// From the node its internode starts at (or the root) to the node, not normalised.
  Vec3 internode(std::size_t node) const;
  /// Mean light of a voxel as its node sees it: its own unit of shade given back (SOTM's C - s + a), 0..1.
  double light(std::size_t node) const;

  std::int32_t add_axis(std::int32_t base, std::int32_t plant, std::int32_t order);
  /// Appends a node to the end of an axis.
  std::int32_t add_node(std::int32_t axis, const Vec3& position, int birth, double pipe);
  void index_axes();
  /// Removes the nodes of dropped axes (flagged by axis) and renumbers the rest.
  void drop(const std::vector<char>& dropped);
};

/// Pipe-model radii from tips to bases (Yi 2018, 4.6); radii never shrink. With `paper`, the base record of
/// each of m siblings carries itself and the siblings before it, as in the authors' program: (m+1)/2 times
/// their sum.
void thicken(Stand& stand);

/// The stand as a core tree: axis after axis, stems first among each plant's. Needs index_axes().
Tree to_tree(const Stand& stand, const Vec3& origin_shift, std::vector<std::int32_t>& tree_of_axis);

}  // namespace dendrofit::igm
