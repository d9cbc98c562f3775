// SPDX-License-Identifier: GPL-3.0-or-later
// How near a reconstruction comes to the tree it was made from.
#pragma once

#include "core/point_cloud.h"
#include "core/tree.h"

#include <cstddef>

namespace dendrofit::bench {

/// Axes are compared at samples 1 cm apart on wood of at least 5 mm radius. Loose: within 2 cm plus the true
/// radius. Strict: within 2 cm plus a quarter of it, and within 45 degrees.
struct AxisScore {
  double loose_f = 0;
  double strict_f = 0;
  double strict_f_thick = 0;    ///< wood over 1 cm radius that was hit by 3 points per cylinder and more
  double radius_bias = 0;       ///< median relative error where the axis was found (strictly)
  double parent_agreement = 0;  ///< branches over 5 mm radius that hang on the right branch
  double volume_1cm = 0, true_volume_1cm = 0;  ///< cubic metres, wood over 1 cm radius
};

/// `hits`: points per cylinder of the truth; empty: all wood counts as seen. Both trees in world coordinates
/// through their origin shifts.
AxisScore score_axes(const Tree& model, const Tree& truth, const std::vector<std::uint32_t>& hits);

struct LeafScore {
  double accuracy = 0;
  double wood_recall_1cm = 0;  ///< wood points on cylinders over 1 cm radius that were kept as wood
  double false_leaf = 0;       ///< share of all wood points called leaf
};

/// `is_leaf`, `radius` per point of `cloud` (radius 0: no wood); points with neither are not judged. A point
/// counts as called leaf where a leaf point lies within `merged_m` (near duplicates are merged).
LeafScore score_leaves(const PointCloud& cloud, const std::vector<char>& is_leaf,
                       const std::vector<float>& radius, const PointCloud& called_leaf, double merged_m);

}  // namespace dendrofit::bench
