// SPDX-License-Identifier: GPL-3.0-or-later
// Where leaves are, from the leaf points of a leaf-on scan.
#pragma once

#include "core/point_cloud.h"
#include "core/tree.h"
#include "forward/leaves/distribution.h"

#include <vector>

namespace dendrofit {

/// Centres of the 3 cm voxels that hold a point, about `origin_shift`, in rising order: one vote each, for
/// near the scanner a leaf returns more points, not more leaf.
std::vector<Vec3> leaf_voxel_centres(const PointCloud& leaf_points, const Vec3& origin_shift);

/// Shares of leaf area over relative height (0 the foot of `tree`, 1 its top), as the leaf points of its scan
/// show them: 25 bins, one in twenty leaves spread evenly, so that a gap of the scan empties no height. For
/// another tree than the scanned one, such as the one regrown from it (the scanned tree itself takes
/// LeafOptions::measured). Throws InputError for no point or an empty tree.
UnitDistribution measured_heights(const PointCloud& leaf_points, const Tree& tree);

}  // namespace dendrofit
