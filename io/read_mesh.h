// SPDX-License-Identifier: GPL-3.0-or-later
// Triangle meshes from files: obstacles of a site, leaf shapes, other programs' surfaces.
#pragma once

#include "core/mesh.h"

#include <filesystem>

namespace dendrofit {

/// OBJ or PLY, told by the content; polygons are cut into triangle fans. Coordinates as in the file (z up
/// expected). Throws IoError naming file and line or byte: truncated, no faces, an index out of range,
/// numbers that are not finite.
TriangleMesh read_mesh(const std::filesystem::path& path);

}  // namespace dendrofit
