// SPDX-License-Identifier: GPL-3.0-or-later
// Views of a Tree's structure that its parent column implies: children, axes, and axes laid anew by
// thickness.
#pragma once

#include "core/tree.h"

#include <cstdint>
#include <span>
#include <vector>

namespace dendrofit {

/// Children of every node in one array (compressed rows), in rising node index.
class TreeChildren {
 public:
  explicit TreeChildren(const Tree& tree);
  std::span<const std::int32_t> of(std::size_t node) const {
    return {child_.data() + first_[node], first_[node + 1] - first_[node]};
  }

 private:
  std::vector<std::size_t> first_;
  std::vector<std::int32_t> child_;
};

/// One axis (branch): its nodes from base to tip.
struct Axis {
  std::vector<std::int32_t> nodes;
  std::int32_t parent_axis = -1;  ///< -1 for an axis that starts at a root
  std::int32_t parent_node = -1;  ///< the node it grows from
  std::int32_t order = 0;
  double length = 0;  ///< metres along the axis
};

/// All axes, indexed by axis id.
std::vector<Axis> axes_of(const Tree& tree);

/// Sets `axis` and `order` anew: at each fork the thickest child continues the axis (ties: the child with
/// more wood length beyond it, then the lower index); every other child starts an axis one order higher. This
/// is how foresters count orders, and what makes a scanned and a simulated tree comparable.
void assign_axes_by_thickness(Tree& tree);

/// The part of `tree` on the nodes with keep[i] != 0. A dropped node's children must be dropped too
/// (InputError else).
Tree subset(const Tree& tree, const std::vector<char>& keep);

/// Wood length beyond the base of each node's cylinder, itself included (metres).
std::vector<double> length_beyond(const Tree& tree);

}  // namespace dendrofit
