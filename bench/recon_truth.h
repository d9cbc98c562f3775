// SPDX-License-Identifier: GPL-3.0-or-later
// What each point of a virtual scan was reflected by.
#pragma once

#include "core/point_cloud.h"
#include "core/tree.h"
#include "forward/virtual_scan/virtual_scan.h"

#include <cstdint>
#include <vector>

namespace dendrofit::bench {

/// Columns as long as the cloud, but hits as the tree; empty where nothing is known.
struct PointTruth {
  std::vector<char> leaf;           ///< 1: a leaf
  std::vector<float> radius;        ///< of the cylinder hit, 0 where it was not wood
  std::vector<std::uint32_t> hits;  ///< points of every cylinder
};

PointTruth truth_of(const VirtualScan& scan, const Tree& tree);

/// The same from the classes of a scan that dendrofit made (ScanClass); a wood point is on the cylinder whose
/// surface is nearest to it. Empty where the file holds no such classes.
PointTruth truth_from_classes(const PointCloud& cloud, const Tree& tree);

}  // namespace dendrofit::bench
