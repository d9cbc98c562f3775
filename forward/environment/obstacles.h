// SPDX-License-Identifier: GPL-3.0-or-later
// Solid bodies near a tree: where no wood can be, and the shade they cast on the voxels around them.
//
// Bodies are opaque voxel for voxel: a voxel is solid when a body reaches into it. Every voxel straight below
// a solid one is dark down to the ground. Beside a body lies a penumbra with the shape of a node's own shadow
// (Yi 2018, 4.5: an inverted pyramid of 20 voxels): where the pyramid above a voxel first meets solid at
// height q, the light lost is sum over j >= q of (2j+1) 2^-j = (4q+6) 2^-q, what a wide wall of nodes with b
// = 2 would take. The paper shows results with obstacles and gives no rule; this one is ours.
#pragma once

#include "core/mesh.h"
#include "core/types.h"
#include "forward/environment/voxels.h"

#include <cstdint>
#include <vector>

namespace dendrofit {

/// Solid between two corners (metres, the site's frame).
struct SolidBox {
  Vec3 min = Vec3::Zero();
  Vec3 max = Vec3::Zero();
};

/// Solid behind a plane: where (x - point) . normal < 0. The normal points to the open side.
struct SolidHalfSpace {
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::UnitZ();
};

/// Every solid of a site. A mesh is solid where its triangles pass and, if it is closed, inside.
struct Solids {
  std::vector<SolidBox> boxes;
  std::vector<SolidHalfSpace> half_spaces;
  std::vector<TriangleMesh> meshes;

  bool empty() const { return boxes.empty() && half_spaces.empty() && meshes.empty(); }
  /// Throws InputError naming body, field, value and limit.
  void validate() const;
};

/// The solids as a voxel grid sees them. Boxes and half-spaces are exact predicates; meshes are voxelised.
class Obstacles {
 public:
  Obstacles() = default;
  /// `site_shift` is the frame's origin_shift (meshes carry their own). Throws InputError from validate(), or
  /// for a mesh too large for its voxels.
  Obstacles(const Solids& solids, const VoxelFrame& frame, const Vec3& site_shift);

  bool empty() const { return boxes_.empty() && half_spaces_.empty() && meshes_.empty(); }
  bool solid(const Voxel& voxel) const;
  /// Light lost at a voxel to all bodies, in fixed point; kDark where none is left.
  Fixed shade(const Voxel& voxel) const;
  /// Whether the straight piece from a to b touches a solid voxel.
  bool blocks(const Vec3& a, const Vec3& b) const;

 private:
  struct VoxelBox {
    Voxel lo, hi;  // inclusive
  };
  struct Plane {
    Vec3 normal;      // unit
    double distance;  // of the plane from voxel (0,0,0)'s centre, in voxels
    double reach;     // half a voxel's extent along the normal
  };
  struct VoxelMesh {
    Voxel lo;  // of the padded box
    int nx, ny, nz;
    std::vector<std::uint8_t> height;  // q to the first solid of the pyramid above, 255 none
    std::vector<std::uint8_t> below;   // 1 where solid lies straight above
    std::size_t index(const Voxel& v) const;
    bool holds(const Voxel& v) const;
  };
  static VoxelMesh voxelise(const TriangleMesh& mesh, const VoxelFrame& frame, const Vec3& site_shift);

  VoxelFrame frame_;
  std::vector<VoxelBox> boxes_;
  std::vector<Plane> half_spaces_;
  std::vector<VoxelMesh> meshes_;
};

}  // namespace dendrofit
