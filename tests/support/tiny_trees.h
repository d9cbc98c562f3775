// SPDX-License-Identifier: GPL-3.0-or-later
// Hand-made trees small enough to check by hand.
#pragma once

#include "core/tree.h"

namespace dendrofit::test {

/// A vertical stem of `pieces` cylinders of 1 m, radius `radius` throughout.
inline Tree pole(int pieces, double radius = 0.1) {
  Tree tree;
  for (int i = 0; i < pieces; ++i)
    tree.add({.start = {0, 0, double(i)}, .end = {0, 0, double(i + 1)}, .parent = i - 1, .radius = radius});
  return tree;
}

/// A 4 m stem (radius 0.2, 0.15, 0.1, 0.05 from the ground up) with a 2 m branch (two cylinders, radius 0.04,
/// 0.02) along +x from the surface of the second piece at z = 2, and a 0.5 m twig (radius 0.01) up from that
/// branch's end.
inline Tree small_tree() {
  Tree tree = pole(4);
  const double radii[] = {0.2, 0.15, 0.1, 0.05};
  for (int i = 0; i < 4; ++i) tree.radius[static_cast<std::size_t>(i)] = radii[i];
  tree.add({.start = {0.15, 0, 2}, .end = {1.15, 0, 2}, .parent = 1, .radius = 0.04, .axis = 1, .order = 1});
  tree.add({.start = {1.15, 0, 2}, .end = {2.15, 0, 2}, .parent = 4, .radius = 0.02, .axis = 1, .order = 1});
  tree.add(
      {.start = {1.15, 0, 2.04}, .end = {1.15, 0, 2.54}, .parent = 4, .radius = 0.01, .axis = 2, .order = 2});
  return tree;
}

}  // namespace dendrofit::test
