// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench/recon_truth.h"

#include "core/neighbors.h"

#include <cmath>

namespace dendrofit::bench {

PointTruth truth_of(const VirtualScan& scan, const Tree& tree) {
  PointTruth truth{std::vector<char>(scan.cloud.size(), 0), std::vector<float>(scan.cloud.size(), 0),
                   std::vector<std::uint32_t>(tree.size(), 0)};
  for (std::size_t i = 0; i < scan.cloud.size(); ++i) {
    truth.leaf[i] = scan.leaf[i] >= 0;
    if (scan.node[i] < 0) continue;
    const auto node = static_cast<std::size_t>(scan.node[i]);
    truth.radius[i] = static_cast<float>(tree.radius[node]);
    ++truth.hits[node];
  }
  return truth;
}

PointTruth truth_from_classes(const PointCloud& cloud, const Tree& tree) {
  const auto is = [&](std::size_t i, ScanClass what) {
    return cloud.classification[i] == static_cast<std::uint8_t>(what);
  };
  PointTruth truth;
  std::size_t wood = 0;
  for (std::size_t i = 0; i < cloud.classification.size(); ++i) wood += is(i, ScanClass::wood);
  if (wood == 0) return truth;
  truth = {std::vector<char>(cloud.size(), 0), std::vector<float>(cloud.size(), 0),
           std::vector<std::uint32_t>(tree.size(), 0)};
  std::vector<Vec3> places;
  std::vector<std::uint32_t> node;
  for (std::size_t i = 0; i < tree.size(); ++i) {
    const int n = 1 + static_cast<int>(tree.length(i) / 0.02);
    for (int k = 0; k < n; ++k) {
      places.push_back(tree.origin_shift - cloud.origin_shift + tree.start[i] +
                       (k + 0.5) / n * (tree.end[i] - tree.start[i]));
      node.push_back(static_cast<std::uint32_t>(i));
    }
  }
  const Neighbors axes(places);
  std::vector<Neighbor> found;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    truth.leaf[i] = is(i, ScanClass::leaf);
    if (!is(i, ScanClass::wood)) continue;
    axes.nearest(cloud.points[i], 16, found);
    double least = 1e300;
    std::uint32_t on = 0;
    for (const Neighbor& f : found) {
      const double off = std::abs(std::sqrt(f.distance_squared) - tree.radius[node[f.index]]);
      if (off < least) least = off, on = node[f.index];
    }
    truth.radius[i] = static_cast<float>(tree.radius[on]);
    ++truth.hits[on];
  }
  return truth;
}

}  // namespace dendrofit::bench
