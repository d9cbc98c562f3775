// SPDX-License-Identifier: GPL-3.0-or-later
// First stage of a reconstruction: a raw scan becomes a clean, thinned one in small local coordinates, and
// the ground under it is found where there is any.
#pragma once

#include "core/point_cloud.h"
#include "core/progress.h"
#include "core/types.h"

#include <cstdint>
#include <vector>

namespace dendrofit {

struct PreprocessOptions {
  double voxel_size_m = 0.004;  ///< points closer together than this are merged
  double ground_cell_m = 0.25;  ///< side of the cells of the ground raster
  void validate() const;
};

/// A scan's points in order of a space-filling curve, so that neighbours in space are neighbours in memory.
struct CleanScan {
  Vec3 origin_shift = Vec3::Zero();   ///< world = origin_shift + local
  std::vector<Vec3> points;           ///< metres, local, near zero
  std::vector<std::uint32_t> source;  ///< one raw point of each merged group
  std::size_t raw_points = 0;
};

/// Merges duplicates and near duplicates. The result depends on the points' positions relative to one another
/// only: a cloud moved by any amount gives the same local coordinates. Throws InputError for a coordinate
/// that is not finite.
CleanScan clean_scan(const PointCloud& cloud, const PreprocessOptions& options = {},
                     Progress& = no_progress());

/// Height of the ground over the plan, and which points belong to it.
struct Ground {
  bool present = false;
  double cell_m = 0.25;
  int columns = 0;
  int rows = 0;
  std::vector<double> height;  ///< metres, local, row by row
  /// Bilinear between cell centres, constant beyond the rim; needs `present`.
  double height_at(double x, double y) const;
};

/// A surface that carries many plan cells, has next to nothing below it and rises less steeply than 45
/// degrees is ground (robust plane, then a raster of local heights about it). A tree cut out of its scene has
/// none.
Ground find_ground(const std::vector<Vec3>& points, const PreprocessOptions& options = {});

/// Takes the points on and below the ground out of the scan (grass is judged with the foot, see foot.h) and
/// returns how many they were.
std::size_t remove_ground(CleanScan& scan, const Ground& ground);

}  // namespace dendrofit
