// SPDX-License-Identifier: GPL-3.0-or-later
// What a reconstruction from several photographs leaves in its folder.
#pragma once

#include "cli/command.h"
#include "recon/reconstruct_views.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace dendrofit::cli {

/// A scan's files (qsm.csv, metrics.json, reconstruction.json, meshes), and views.json, surface.ply (the
/// carved surface) and overlays/NAME.png: the tree drawn over each photograph.
void write_views_reconstruction(const std::filesystem::path& folder, const ViewSet& set,
                                const ViewsReconstruction& result,
                                const std::vector<std::string>& mesh_formats);
std::string views_json(const ViewsReconstruction& result);
void say_views_reconstruction(const Session& session, const ViewsReconstruction& result);

}  // namespace dendrofit::cli
