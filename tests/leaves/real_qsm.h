// SPDX-License-Identifier: GPL-3.0-or-later
// Just enough of a reader for three published cylinder models, so that these tests need no other floor.
#pragma once

#include "core/tree.h"
#include "core/tree_topology.h"

#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace dendrofit::test {

struct QsmColumns {
  char delimiter = ',';
  bool header = true;
  int start = 0;  ///< x; y and z follow
  int end = 3;    ///< x of the end point, or of the unit axis where has_axis
  bool has_axis = false;
  int length = -1;  ///< only with has_axis
  int radius = 9;
  int id = 6;  ///< -1: the row's number, from 1
  int parent = 7;
};

inline Tree read_qsm(const std::filesystem::path& path, const QsmColumns& columns) {
  std::ifstream in(path);
  std::string line;
  if (columns.header) std::getline(in, line);
  Tree tree;
  std::map<int, std::int32_t> node_of;
  int row = 0;
  while (std::getline(in, line)) {
    std::vector<double> v;
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, columns.delimiter);)
      v.push_back(std::atof(cell.c_str()));
    if (v.size() < 10) continue;
    ++row;
    const auto at = [&](int k) { return v[static_cast<std::size_t>(k)]; };
    const auto point = [&](int k) { return Vec3(at(k), at(k + 1), at(k + 2)); };
    TreeNode node;
    node.start = point(columns.start);
    node.end =
        columns.has_axis ? Vec3(node.start + at(columns.length) * point(columns.end)) : point(columns.end);
    node.radius = at(columns.radius);
    const auto parent = node_of.find(static_cast<int>(at(columns.parent)));
    node.parent = parent == node_of.end() ? -1 : parent->second;
    if (!((node.end - node.start).norm() > 0) || !(node.radius > 0)) {
      node_of[columns.id < 0 ? row : static_cast<int>(at(columns.id))] = node.parent;
      continue;
    }
    node_of[columns.id < 0 ? row : static_cast<int>(at(columns.id))] = tree.add(node);
  }
  if (!tree.empty()) {
    tree.origin_shift = tree.start[0].array().round();
    for (std::size_t i = 0; i < tree.size(); ++i) {
      tree.start[i] -= tree.origin_shift;
      tree.end[i] -= tree.origin_shift;
    }
    assign_axes_by_thickness(tree);
  }
  return tree;
}

inline QsmColumns archi_columns() {
  return {};
}
inline QsmColumns simpleforest_columns() {
  return {.start = 2, .end = 5, .radius = 8, .id = 0, .parent = 1};
}
inline QsmColumns treeqsm_columns() {
  return {.delimiter = '\t',
          .header = false,
          .start = 2,
          .end = 5,
          .has_axis = true,
          .length = 1,
          .radius = 0,
          .id = -1,
          .parent = 8};
}

}  // namespace dendrofit::test
