// SPDX-License-Identifier: GPL-3.0-or-later
// Small trees by hand for the tests of leaves.
#pragma once

#include "core/tree.h"

#include <cmath>

#include <Eigen/Geometry>

namespace dendrofit::test {

/// `count` upright cylinders end to end, from the origin.
inline Tree post(int count, double length_m, double radius_m) {
  Tree tree;
  for (int k = 0; k < count; ++k) {
    TreeNode node;
    node.start = Vec3(0, 0, k * length_m);
    node.end = Vec3(0, 0, (k + 1) * length_m);
    node.parent = k - 1;
    node.radius = radius_m;
    tree.add(node);
  }
  return tree;
}

/// A stem of 2 m with twelve branches of 0.8 m about its upper two thirds, each with six twigs of 0.3 m: 90
/// axes, 39 m of wood, the twigs 2 mm in radius.
inline Tree bush() {
  Tree tree = post(10, 0.2, 0.02);
  std::int32_t axes = 1;
  const auto axis = [&](std::int32_t parent, Vec3 at, const Vec3& along, double length, int count,
                        double radius, std::int32_t order) {
    std::int32_t first = -1;
    for (int k = 0; k < count; ++k) {
      TreeNode node;
      node.start = at;
      node.end = at = at + along * (length / count);
      node.parent = parent;
      node.radius = radius;
      node.axis = axes;
      node.order = order;
      parent = tree.add(node);
      if (first < 0) first = parent;
    }
    ++axes;
    return first;
  };
  for (int b = 0; b < 12; ++b) {
    const auto on = static_cast<std::size_t>(3 + b % 7);
    const double turn = 2.4 * b;
    const Vec3 out(std::cos(turn), std::sin(turn), 0), along = (out + Vec3(0, 0, 0.7)).normalized();
    const std::int32_t first =
        axis(static_cast<std::int32_t>(on), tree.end[on] + 0.02 * out, along, 0.8, 6, 0.006, 1);
    for (int k = 0; k < 6; ++k) {
      const auto node = static_cast<std::size_t>(first + k);
      const Vec3 side = along.cross(Vec3::UnitZ()).normalized() * (k % 2 ? -1.0 : 1.0);
      axis(first + k, tree.end[node], (0.6 * along + side).normalized(), 0.3, 3, 0.002, 2);
    }
  }
  return tree;
}

/// A stem and two branches, none thinner than 3 cm.
inline Tree coarse_fork() {
  Tree tree = post(8, 0.5, 0.1);
  for (const double side : {1.0, -1.0}) {
    std::int32_t parent = 7;
    Vec3 at = tree.end[7];
    const std::int32_t axis = tree.axis_count();
    for (int k = 0; k < 6; ++k) {
      TreeNode node;
      node.start = at;
      node.end = at = at + Vec3(0.3 * side, 0, 0.3);
      node.parent = parent;
      node.radius = 0.06 - 0.005 * k;
      node.axis = axis;
      node.order = 1;
      parent = tree.add(node);
    }
  }
  return tree;
}

}  // namespace dendrofit::test
