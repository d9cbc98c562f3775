// SPDX-License-Identifier: GPL-3.0-or-later
// Marker points: the free space that shoots grow into (space colonisation weighted by light; Yi 2018, 4.4,
// Fig. 9).
#pragma once

#include "core/types.h"
#include "forward/environment/shadows.h"
#include "forward/environment/voxels.h"

#include <cstdint>
#include <span>
#include <vector>

namespace dendrofit::igm {

/// The markers of one cycle, in a uniform grid of cells rebuilt each cycle. Shoots take markers away; new
/// nodes shade the markers below them at once, by the same fixed-point weights as the light field: a marker's
/// light is at any time exactly that of its voxel.
class MarkerField {
 public:
  MarkerField() = default;
  /// Sorts `position` (with the shade at each) into cells, `cell_m` long in x and z and half that in y.
  MarkerField(const std::vector<Vec3>& position, const std::vector<Fixed>& shade, const VoxelFrame& frame,
              double cell_m);

  /// Takes away the markers within `near_m` of `at`, then sums unit vectors to those within `far_m` and the
  /// cone of cosine `cone` about the unit vector `heading`, each weighted by its light. False where nothing
  /// pulls: no marker, or none with at least a tenth of full light.
  bool pull(const Vec3& at, const Vec3& heading, double near_m, double far_m, double cone, Vec3& direction);

  /// The shadows of new nodes that lie near each other.
  void cast(std::span<const Voxel> nodes, const ShadeProfile& profile);

 private:
  struct Run {
    std::uint32_t first, last;
  };
  int cell_of(double coordinate, int axis) const;
  /// Cells that hold what lies from there on, or up to there, some margin included.
  int cell_before(double coordinate, int axis) const;
  int cell_after(double coordinate, int axis) const;
  /// Markers of the cells (x, y0..y1, z), which are neighbours in memory.
  Run run(int x, int y0, int y1, int z) const;
  void squeeze();
  void resize(std::size_t size);

  VoxelFrame frame_;
  Vec3 cell_ = Vec3::Ones();  // voxels
  Vec3 per_cell_ = Vec3::Ones();
  Vec3 lo_ = Vec3::Zero();  // voxels
  int count_[3] = {0, 0, 0};
  std::vector<std::uint32_t> first_;  // of each cell; z slowest, y fastest
  std::size_t size_ = 0, taken_ = 0;
  // A column an attribute, one entry a marker and some more that inner loops may read.
  std::vector<float> x_, y_, z_;            // voxels from lo_; far away once taken
  std::vector<std::int32_t> vx_, vy_, vz_;  // far away once taken
  std::vector<Fixed> shade_;
  std::vector<std::int32_t> keep_;  // of a run: whether a marker is taken or pulls
};

}  // namespace dendrofit::igm
