// SPDX-License-Identifier: GPL-3.0-or-later
// What a binary glTF file holds, for `dendrofit info`.
#pragma once

#include "core/point_cloud.h"
#include "io/file_bytes.h"

#include <cstdint>

namespace dendrofit {

struct GlbInfo {
  std::uint64_t vertices = 0;   ///< stored
  std::uint64_t triangles = 0;  ///< shown: an instanced mesh counts once an instance
  std::uint64_t instances = 0;  ///< of EXT_mesh_gpu_instancing (leaves)
  Bounds bounds;  ///< z up, metres; of meshes that are not instanced, from the accessors' limits
};

/// Reads header and scene, not the geometry; nodes may be translated but not turned (others count, without
/// bounds). Throws IoError for a file that ends early, is no glTF 2.0, or whose parts contradict one another.
GlbInfo read_glb_info(const FileBytes& bytes);

}  // namespace dendrofit
