// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/tree_topology.h"

#include "core/errors.h"

#include <string>

namespace dendrofit {

TreeChildren::TreeChildren(const Tree& tree) : first_(tree.size() + 1, 0) {
  const std::size_t n = tree.size();
  for (std::size_t i = 0; i < n; ++i)
    if (tree.parent[i] >= 0) ++first_[static_cast<std::size_t>(tree.parent[i]) + 1];
  for (std::size_t i = 0; i < n; ++i) first_[i + 1] += first_[i];
  child_.resize(first_[n]);
  std::vector<std::size_t> fill(first_.begin(), first_.end() - 1);
  for (std::size_t i = 0; i < n; ++i)
    if (tree.parent[i] >= 0)
      child_[fill[static_cast<std::size_t>(tree.parent[i])]++] = static_cast<std::int32_t>(i);
}

std::vector<Axis> axes_of(const Tree& tree) {
  std::vector<Axis> axes(static_cast<std::size_t>(tree.axis_count()));
  for (std::size_t i = 0; i < tree.size(); ++i) {
    Axis& axis = axes[static_cast<std::size_t>(tree.axis[i])];
    if (axis.nodes.empty()) {
      axis.parent_node = tree.parent[i];
      axis.parent_axis = tree.parent[i] < 0 ? -1 : tree.axis[static_cast<std::size_t>(tree.parent[i])];
      axis.order = tree.order[i];
    }
    axis.nodes.push_back(static_cast<std::int32_t>(i));
    axis.length += tree.length(i);
  }
  return axes;
}

std::vector<double> length_beyond(const Tree& tree) {
  std::vector<double> beyond(tree.size());
  for (std::size_t i = tree.size(); i-- > 0;) {
    beyond[i] += tree.length(i);
    if (tree.parent[i] >= 0) beyond[static_cast<std::size_t>(tree.parent[i])] += beyond[i];
  }
  return beyond;
}

void assign_axes_by_thickness(Tree& tree) {
  const std::vector<double> beyond = length_beyond(tree);
  std::vector<std::int32_t> heir(tree.size(), -1);
  const auto comes_first = [&](std::size_t a, std::size_t b) {
    if (tree.radius[a] != tree.radius[b]) return tree.radius[a] > tree.radius[b];
    if (beyond[a] != beyond[b]) return beyond[a] > beyond[b];
    return a < b;
  };
  for (std::size_t i = 0; i < tree.size(); ++i) {
    if (tree.parent[i] < 0) continue;
    std::int32_t& best = heir[static_cast<std::size_t>(tree.parent[i])];
    if (best < 0 || comes_first(i, static_cast<std::size_t>(best))) best = static_cast<std::int32_t>(i);
  }
  std::int32_t next_axis = 0;
  for (std::size_t i = 0; i < tree.size(); ++i) {
    const std::int32_t p = tree.parent[i];
    const bool continues = p >= 0 && heir[static_cast<std::size_t>(p)] == static_cast<std::int32_t>(i);
    tree.axis[i] = continues ? tree.axis[static_cast<std::size_t>(p)] : next_axis++;
    tree.order[i] = p < 0 ? 0 : tree.order[static_cast<std::size_t>(p)] + (continues ? 0 : 1);
  }
}

Tree subset(const Tree& tree, const std::vector<char>& keep) {
  if (keep.size() != tree.size()) throw InputError("subset: one flag per node is needed");
  Tree part;
  part.origin_shift = tree.origin_shift;
  std::vector<std::int32_t> new_index(tree.size(), -1);
  std::vector<std::int32_t> new_axis(static_cast<std::size_t>(tree.axis_count()), -1);
  std::int32_t axes = 0;
  for (std::size_t i = 0; i < tree.size(); ++i) {
    if (!keep[i]) continue;
    TreeNode node = tree.node(i);
    if (node.parent >= 0) {
      node.parent = new_index[static_cast<std::size_t>(node.parent)];
      if (node.parent < 0)
        throw InputError("subset: node " + std::to_string(i + 1) + " is kept, its parent is not");
    }
    std::int32_t& axis = new_axis[static_cast<std::size_t>(node.axis)];
    if (axis < 0) axis = axes++;
    node.axis = axis;
    new_index[i] = part.add(node);
  }
  return part;
}

}  // namespace dendrofit
