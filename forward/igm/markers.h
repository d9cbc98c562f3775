// SPDX-License-Identifier: GPL-3.0-or-later
// Marker points: the free space that shoots grow into (space colonisation weighted by light; Yi 2018, 4.4,
// Fig. 9).
#pragma once

#include "core/types.h"
#include "forward/environment/light_field.h"
#include "forward/environment/voxels.h"

#include <cstdint>
#include <span>
#include <vector>

namespace dendrofit::igm {

/// The markers of one cycle, in a uniform grid of cells rebuilt each cycle. Shoots take markers away; new
/// nodes shade the markers below them at once, by the same fixed-point weights as the light field.
class MarkerField {
 public:
  /// Sorts `position` (with the shade at each) into cells of `cell_m`.
  MarkerField(const std::vector<Vec3>& position, const std::vector<Fixed>& shade, const VoxelFrame& frame,
              double cell_m);

  /// Takes away the markers within `near_m` of `at`, then sums unit vectors to those within `far_m` (at most
  /// a cell) and the cone of cosine `cone` about the unit vector `heading`, each weighted by its light. False
  /// where nothing pulls: no marker, or none with at least a tenth of full light.
  bool pull(const Vec3& at, const Vec3& heading, double near_m, double far_m, double cone, Vec3& direction);

  /// The shadow of a new node.
  void cast(const Voxel& node, const ShadeProfile& profile);

 private:
  struct Range {
    std::uint32_t first = 0, last = 0;
  };
  int cell_of(double coordinate, double lo, int count) const;

  VoxelFrame frame_;
  double cell_;             // voxels
  Vec3 lo_ = Vec3::Zero();  // voxels
  int nx_ = 0, ny_ = 0, nz_ = 0;
  std::vector<Range> cells_;      // z fastest
  std::vector<float> x_, y_, z_;  // voxels from the frame's origin
  std::vector<std::int32_t> vx_, vy_, vz_;
  std::vector<Fixed> shade_;
};

}  // namespace dendrofit::igm
