// SPDX-License-Identifier: GPL-3.0-or-later
// Binary glTF 2.0.
#pragma once

#include "core/foliage.h"
#include "core/mesh.h"

#include <filesystem>

namespace dendrofit {

/// Writes a scene of wood and leaves, either of which may be absent (nullptr, or without triangles or
/// leaves). glTF has y up: (x, y, z) becomes (x, z, -y). Positions are single precision about a root node
/// whose translation carries the origin shift in double. Leaves are instances (EXT_mesh_gpu_instancing), one
/// mesh a shape.
void write_glb(const std::filesystem::path& path, const TriangleMesh* wood, const Foliage* foliage);

}  // namespace dendrofit
