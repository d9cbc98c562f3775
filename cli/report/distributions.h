// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers behind the report's plots: branches' angles and lengths, and where in the height wood and leaves
// are.
#pragma once

#include "core/foliage.h"
#include "core/tree.h"

#include <cstddef>
#include <vector>

namespace dendrofit {

/// One entry a branch (axes of order 1 and higher; axes that start at a root are none).
struct BranchValues {
  std::vector<double>
      angle_deg;  ///< between a branch's first tenth of a metre (or its all) and its parent's direction
  std::vector<double> length_m;  ///< along the branch
};
BranchValues branch_values(const Tree& tree);

/// Share (0..1) of the values in each of `bins` equal bins of [lo, hi]; values outside fall in the outermost
/// bins.
std::vector<double> histogram(const std::vector<double>& values, double lo, double hi, std::size_t bins);

/// Areas a metre of height, above the tree's foot, in steps of `step_m` (the middle of each step in
/// `height_m`).
struct HeightProfile {
  std::vector<double> height_m;
  std::vector<double> area_per_m;  ///< square metres a metre
};
HeightProfile wood_profile(const Tree& tree, double step_m);
/// One-sided leaf area; heights above `tree`'s foot.
HeightProfile leaf_profile(const Foliage& foliage, const Tree& tree, double step_m);

}  // namespace dendrofit
