// SPDX-License-Identifier: GPL-3.0-or-later
#include "forward/igm/stand.h"

#include <algorithm>
#include <cmath>

namespace dendrofit::igm {

Vec3 Stand::internode(std::size_t node) const {
  const std::int32_t from = nodes.previous[node];
  if (from >= 0) return nodes.position[node] - nodes.position[static_cast<std::size_t>(from)];
  const auto axis = static_cast<std::size_t>(nodes.axis[node]);
  return nodes.position[node] - plants[static_cast<std::size_t>(axes.plant[axis])].root;
}

double Stand::light(std::size_t node) const {
  return std::clamp(1.0 - to_light(nodes.shade[node] - kFullLight), 0.0, 1.0);
}

std::int32_t Stand::add_axis(std::int32_t base, std::int32_t plant, std::int32_t order) {
  axes.base.push_back(base);
  axes.plant.push_back(plant);
  axes.order.push_back(order);
  axes.tip.push_back(-1);
  axes.sides.push_back(0);
  axes.id.push_back(next_axis_id++);
  if (base >= 0) ++nodes.laterals[static_cast<std::size_t>(base)];
  return static_cast<std::int32_t>(axes.size()) - 1;
}

std::int32_t Stand::add_node(std::int32_t axis, const Vec3& position, int birth, double pipe) {
  const auto a = static_cast<std::size_t>(axis);
  nodes.position.push_back(position);
  nodes.previous.push_back(axes.tip[a] >= 0 ? axes.tip[a] : axes.base[a]);
  nodes.axis.push_back(axis);
  nodes.birth.push_back(birth);
  nodes.id.push_back(next_node_id++);
  nodes.voxel.push_back(frame.at(position));
  nodes.pipe.push_back(pipe);
  nodes.shade.push_back(0);
  nodes.obstacle_shade.push_back(0);
  nodes.laterals.push_back(0);
  axes.tip[a] = static_cast<std::int32_t>(nodes.size()) - 1;
  return axes.tip[a];
}

void Stand::index_axes() {
  axis_first.assign(axes.size() + 1, 0);
  for (const std::int32_t axis : nodes.axis) ++axis_first[static_cast<std::size_t>(axis) + 1];
  for (std::size_t a = 0; a < axes.size(); ++a) axis_first[a + 1] += axis_first[a];
  axis_nodes.resize(nodes.size());
  std::vector<std::int32_t> next(axis_first.begin(), axis_first.end() - 1);
  for (std::size_t i = 0; i < nodes.size(); ++i)
    axis_nodes[static_cast<std::size_t>(next[static_cast<std::size_t>(nodes.axis[i])]++)] =
        static_cast<std::int32_t>(i);
}

void Stand::drop(const std::vector<char>& dropped) {
  std::vector<std::int32_t> new_axis(axes.size(), -1);
  std::size_t axis_count = 0;
  for (std::size_t a = 0; a < axes.size(); ++a)
    if (!dropped[a]) new_axis[a] = static_cast<std::int32_t>(axis_count++);
  std::vector<std::int32_t> new_node(nodes.size(), -1);
  std::size_t node_count = 0;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if (!dropped[static_cast<std::size_t>(nodes.axis[i])])
      new_node[i] = static_cast<std::int32_t>(node_count++);

  const auto squeeze = [](auto& column, const std::vector<std::int32_t>& where, std::size_t count) {
    for (std::size_t i = 0; i < where.size(); ++i)
      if (where[i] >= 0) column[static_cast<std::size_t>(where[i])] = column[i];
    column.resize(count);
  };
  const auto squeeze_nodes = [&](auto&... column) { (squeeze(column, new_node, node_count), ...); };
  const auto squeeze_axes = [&](auto&... column) { (squeeze(column, new_axis, axis_count), ...); };
  squeeze_nodes(nodes.position, nodes.previous, nodes.axis, nodes.birth, nodes.id, nodes.voxel, nodes.pipe,
                nodes.shade, nodes.obstacle_shade, nodes.laterals);
  squeeze_axes(axes.base, axes.plant, axes.order, axes.tip, axes.sides, axes.id);
  const auto renumber = [](std::vector<std::int32_t>& column, const std::vector<std::int32_t>& where) {
    for (std::int32_t& i : column)
      if (i >= 0) i = where[static_cast<std::size_t>(i)];
  };
  renumber(nodes.previous, new_node);
  renumber(nodes.axis, new_axis);
  renumber(axes.base, new_node);
  renumber(axes.tip, new_node);
}

void thicken(Stand& stand) {
  Nodes& nodes = stand.nodes;
  std::vector<double> from_axis(nodes.size(), 0), from_laterals(nodes.size(), 0);
  for (std::size_t i = nodes.size(); i-- > 0;) {
    const auto axis = static_cast<std::size_t>(nodes.axis[i]);
    double carried = from_axis[i];
    if (nodes.laterals[i] > 0)
      carried +=
          from_laterals[i] * (stand.parameters_of_axis(axis).paper ? 0.5 * (nodes.laterals[i] + 1) : 1);
    nodes.pipe[i] = std::max(nodes.pipe[i], carried);  // R^v = sum R_j^v, never less than before
    const std::int32_t from = nodes.previous[i];
    if (from < 0) continue;
    (nodes.axis[static_cast<std::size_t>(from)] == nodes.axis[i]
         ? from_axis
         : from_laterals)[static_cast<std::size_t>(from)] += nodes.pipe[i];
  }
}

Tree to_tree(const Stand& stand, const Vec3& origin_shift, std::vector<std::int32_t>& tree_of_axis) {
  const Nodes& nodes = stand.nodes;
  Tree tree;
  tree.origin_shift = origin_shift;
  tree.reserve(nodes.size());
  tree_of_axis.clear();
  std::vector<std::int32_t> place(nodes.size(), -1);
  for (std::size_t a = 0; a < stand.axes.size(); ++a) {
    const double inverse_v = 1.0 / stand.parameters_of_axis(a).pipe_exponent;
    tree_of_axis.push_back(stand.tree_of_axis(a));
    for (const std::int32_t n : stand.nodes_of(a)) {
      const auto i = static_cast<std::size_t>(n);
      const std::int32_t from = nodes.previous[i];
      TreeNode node;
      node.start = nodes.position[i] - stand.internode(i);
      if (from >= 0) node.start = nodes.position[static_cast<std::size_t>(from)];
      node.end = nodes.position[i];
      node.parent = from >= 0 ? place[static_cast<std::size_t>(from)] : -1;
      node.radius = std::pow(nodes.pipe[i], inverse_v);
      node.axis = static_cast<std::int32_t>(a);
      node.order = stand.axes.order[a] - 1;
      node.birth_cycle = nodes.birth[i];
      place[i] = tree.add(node);
    }
  }
  return tree;
}

}  // namespace dendrofit::igm
