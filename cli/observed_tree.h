// SPDX-License-Identifier: GPL-3.0-or-later
// The tree a growth model is fitted to, from whatever shows it: a scan, a photograph, or several.
#pragma once

#include "cli/photo_settings.h"
#include "cli/reconstruct_settings.h"
#include "core/point_cloud.h"

#include <filesystem>
#include <string>
#include <vector>

namespace dendrofit::cli {

struct ObservedTree {
  PointCloud scan;  ///< empty where the tree comes from photographs
  Reconstruction model;
  bool one_view = false;    ///< depth is invented: what only depth would tell must not be compared
  std::string overlay_png;  ///< of a photograph
  std::vector<std::filesystem::path> inputs;

  const std::filesystem::path& file() const { return inputs.front(); }
};

/// Reads what the options name, reconstructs it, writes the reconstruction's files into `folder` and tells
/// the user. Throws SolverError for a photograph of a leafy crown or without a scale: no tree to fit.
ObservedTree observe_tree(Session& session, const std::filesystem::path& input,
                          const ReconstructSettings& scan, const PhotoSettings& photo,
                          const std::filesystem::path& folder, const std::vector<std::string>& mesh_formats);

}  // namespace dendrofit::cli
