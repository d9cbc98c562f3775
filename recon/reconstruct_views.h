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
  std::optional<double> pose_error_px =
      std::nullopt;          ///< of the poses told; none: the set's, or found from the masks
  bool refine_poses = true;  ///< where the masks show that the poses are off
  /// Throws InputError naming field, value and limit.
  void validate() const;
};

/// How one view agrees with the tree.
struct ViewQuality {
  std::string name;
  bool used = true;            ///< false: its pose or mask contradicts the others
  double explained_share = 0;  ///< of its mask, by the space all views allow
  double offset_px = 0;  ///< median, of its branches' middles from the tree's axes; NaN: none seen clearly
  double covered_share = 0;  ///< of its mask, by the finished tree
};

struct ViewsReconstruction {
  Reconstruction model;
  PointCloud surface;              ///< of the carved space, above the foot; in the set's frame
  std::vector<ViewQuality> views;  ///< as many as the set's
  std::vector<Camera> cameras;     ///< of the set's views, refined where that made them better
  double tolerance_px = 0;         ///< the masks were carved with
  double cell_m = 0;               ///< of the carving
  bool poses_refined = false;
  std::size_t shadows = 0;  ///< cylinders dropped: too few views show them (silhouettes that meet by chance)
};

/// Carves the space that all masks allow, reconstructs its surface as a scan, drops what too few views
/// support, and settles centre lines and radii on the pictures. Photographs without a mask are segmented.
/// Poses that are slightly off are refined on the tree; a view that contradicts the others is left out and
/// named in the warnings. Throws InputError for fewer than two views, views without a scale, or views from
/// one place (they show no depth); SolverError where masks and poses give no tree. The same views give the
/// same tree whatever `cloud.threads`.
ViewsReconstruction reconstruct_views(const ViewSet& set, const ViewsOptions& options = {},
                                      Progress& progress = no_progress());

}  // namespace dendrofit
