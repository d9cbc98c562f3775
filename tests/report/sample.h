// SPDX-License-Identifier: GPL-3.0-or-later
// A small made-up tree with everything a report can show; its texts are chosen to break careless escaping.
#pragma once

#include "cli/report/report.h"

namespace dendrofit::test {

/// Recursive: a stem of `levels` forks, `cycles` birth cycles, on its foot at `foot` (world).
Tree branching_tree(int levels, std::uint64_t seed, const Vec3& foot = Vec3::Zero());

/// Points scattered on a tree's cylinders.
PointCloud scattered_scan(const Tree& tree, std::size_t points);

/// Diamond leaves on the thin wood.
Foliage diamond_leaves(const Tree& tree, std::size_t leaves);

/// Owns what `data` points to.
struct Sample {
  Tree model;
  Tree regrown;
  PointCloud scan;
  Foliage foliage;
  TreeMetrics model_metrics;
  TreeMetrics regrown_metrics;
  ReportData data;
  explicit Sample(std::size_t scan_points = 20'000, std::size_t leaf_count = 1'500);
  Sample(const Sample&) = delete;
};

}  // namespace dendrofit::test
