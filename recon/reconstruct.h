// SPDX-License-Identifier: GPL-3.0-or-later
// Point cloud in, tree out: the pipeline of a reconstruction.
#pragma once

#include "core/metrics.h"
#include "core/point_cloud.h"
#include "core/progress.h"
#include "core/tree.h"
#include "recon/wood_leaf.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace dendrofit {

struct ReconstructOptions {
  double voxel_size_m = 0.004;    ///< points closer together than this are merged
  int neighbors = 10;             ///< links of each point in the neighbour graph
  double max_gap_m = 1.5;         ///< widest gap in the scan that wood is believed to cross
  double shortest_limb_m = 0.02;  ///< shorter side shoots are noise about their bearer
  double dbh_height_m = 1.3;      ///< above the foot
  bool leaves_possible = true;    ///< false: every point is wood, however it lies among the others
  std::optional<double> twig_diameter_m = std::nullopt;  ///< of the species' twig ends, where known
  std::optional<Eigen::Vector2d> tree_at =
      std::nullopt;        ///< world x, y: which tree of several; none: the largest
  int threads = 0;         ///< 0: all cores
  std::uint64_t seed = 1;  ///< of the resampling behind the intervals
  /// Throws InputError naming field, value and limit.
  void validate() const;
};

struct StageTime {
  std::string stage;
  double wall_seconds = 0;
  double cpu_seconds = 0;  ///< of the whole process
};

struct Reconstruction {
  Tree tree;  ///< connected; its origin shift is the cloud's, moved to the scan's corner
  TreeMetrics metrics;
  PointCloud leaf_points;             ///< taken for foliage; empty on a leaf-off scan
  std::vector<std::string> warnings;  ///< what a forester should know about this result
  std::vector<StageTime> stages;

  Vec3 foot = Vec3::Zero();  ///< world position of the first stem's foot
  bool ground_found = false;
  bool leaf_on = false;           ///< the verdict on the scan, see separate_leaves()
  double leafy_share = 0;         ///< what it rests on: share of points in leaf-like places,
  double straight_share = 1;      ///< and share of straight ones among the paths that bear something
  double wood_share = 1;          ///< of the points that belong to the tree
  double noise_m = 0;             ///< spread of points about the wood, one standard deviation
  std::vector<Vec3> scan_shifts;  ///< by which the scans in the file lay off each other, see align_scans()
  double spacing_m = 0;           ///< usual distance of a point's fourth neighbour
  std::size_t raw_points = 0;
  std::size_t clean_points = 0;   ///< after merging near duplicates
  std::size_t ground_points = 0;  ///< ground and low vegetation
  std::size_t wall_points = 0;    ///< of large upright planes, see walls.h
  std::size_t stray_points = 0;   ///< isolated, or beyond every gap that may be bridged
  std::size_t stems = 1;          ///< of the tree, from one stool
  std::vector<Vec3> other_trees;  ///< world positions of trees that stand in the scan too and were left out,
  std::size_t other_points = 0;   ///< with these points
  std::size_t tree_points = 0;    ///< wood and leaves
  std::size_t bridged_gaps = 0;   ///< gaps the skeleton crosses
};

/// Throws InputError for coordinates that are not finite, SolverError (saying why, in the field's words)
/// where the scan holds no stem. The same cloud gives the same result whatever `threads`, and the same tree
/// wherever it stands.
Reconstruction reconstruct(const PointCloud& cloud, const ReconstructOptions& options = {},
                           Progress& progress = no_progress());

}  // namespace dendrofit
