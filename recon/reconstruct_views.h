// SPDX-License-Identifier: GPL-3.0-or-later
// Photographs from around a tree in, tree out.
#pragma once

#include "core/photograph.h"
#include "core/progress.h"
#include "recon/reconstruct.h"

#include <optional>
#include <string>
#include <vector>

namespace dendrofit {

struct ViewsOptions {
  ReconstructOptions cloud{.voxel_size_m = 0.005};  ///< how the carved surface becomes a tree
  std::optional<double> pose_error_px = std::nullopt;  ///< of the poses told; none: found out from the masks
  bool refine_poses = true;  ///< when the masks show that the poses are off
  void validate() const;
};

/// How one view agrees with the tree.
struct ViewQuality {
  std::string name;
  double explained_share = 0;   ///< of its mask, by the hull of the others
  double offset_px = 0;         ///< median distance of its branches' middles from the tree's axes
  bool used = true;
};

struct ViewsReconstruction {
  Reconstruction model;
  std::vector<ViewQuality> views;
  double tolerance_px = 0;      ///< the masks were carved with
  double cell_m = 0;
  bool poses_refined = false;
  std::vector<Camera> cameras;  ///< as used: refined where that made them better
};

/// Throws InputError for views without a scale, fewer than two, or sharing one camera centre; SolverError where
/// masks and poses give no tree. Every view must hold its mask (see segmentation).
ViewsReconstruction reconstruct_views(const ViewSet& set, const ViewsOptions& options = {},
                                      Progress& progress = no_progress());

}  // namespace dendrofit
