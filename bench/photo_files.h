// SPDX-License-Identifier: GPL-3.0-or-later
// Photographs of a ring of cameras as files for the command line.
#pragma once

#include "core/photograph.h"

#include <filesystem>

namespace dendrofit::bench {

/// FOLDER/cameras.json with view_NN.png and mask_NN.png (the exact masks), and FOLDER/colmap/, the same
/// cameras as a COLMAP text model: in a unit of 0.27 m, turned and shifted so that it shows neither scale nor
/// up. All views share the first one's camera model.
void write_views(const std::filesystem::path& folder, const ViewSet& set);

}  // namespace dendrofit::bench
