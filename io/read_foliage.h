// SPDX-License-Identifier: GPL-3.0-or-later
// Leaves back from the instances our own .glb holds.
#pragma once

#include "core/foliage.h"

#include <filesystem>

namespace dendrofit {

/// Leaves and petioles of a leaves.glb or scene that write_foliage_glb or write_scene_glb wrote (single
/// precision about the origin shift). What the file does not hold is left at its default: species, bearing
/// cylinder, added shoots. A leaf whose petiole is not in the file sits on the wood. Throws IoError naming
/// file and what is wrong: not a binary glTF, truncated, made by another program without such instances.
Foliage read_foliage_glb(const std::filesystem::path& path);

}  // namespace dendrofit
