// SPDX-License-Identifier: GPL-3.0-or-later
// One photograph in, tree out: the pipeline of a reconstruction from a single view.
#pragma once

#include "core/metrics.h"
#include "core/photograph.h"
#include "core/progress.h"
#include "core/tree.h"
#include "recon/image/frame.h"
#include "recon/image/segmentation.h"
#include "recon/image/skeleton.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace dendrofit {

struct ReconstructPhotoOptions {
  std::optional<double> height_m = std::nullopt;  ///< of the tree
  std::optional<ScaleBar> scale_bar = std::nullopt;
  std::optional<Eigen::Vector2d> root_px = std::nullopt;  ///< a pixel at the stem's foot
  std::optional<Camera> camera = std::nullopt;            ///< of the photograph, z up
  bool metric_camera = false;                             ///< the camera's translation is in metres
  double eye_height_m = 1.6;      ///< of a metric camera over the tree's foot, where that gives the scale
  double opening_angle_deg = 50;  ///< of branches, where the picture shows too few
  double dbh_height_m = 1.3;      ///< above the foot
  std::uint64_t seed = 1;         ///< of the invented depths
  /// Throws InputError naming field, value and limit.
  void validate() const;
};

/// What the outline alone tells; metres, or tree heights where there is no scale.
struct OutlineMetrics {
  double height = 0;    ///< foot to top
  double width = 0;     ///< of the crown, in view
  double area = 0;      ///< of the silhouette
  double lean_deg = 0;  ///< of the stem, across the view: positive to the right
};

struct PhotoReconstruction {
  bool has_tree = false;  ///< false: a leafy crown; only the outline is told
  bool metric = true;     ///< false: every length is in tree heights
  Tree tree;              ///< cylinder i ends at skeleton node i + 1
  TreeMetrics metrics;
  OutlineMetrics outline;
  Silhouette silhouette;
  PlaneSkeleton skeleton;
  PictureFrame frame;
  std::vector<std::string> warnings;
};

/// Silhouette, centre lines, scale, depth (image_*.h). Throws SolverError where no tree is seen, InputError
/// for options that contradict the picture. Same photograph, options: the same bytes.
PhotoReconstruction reconstruct_photo(const Photograph& photo, const ReconstructPhotoOptions& options = {},
                                      Progress& progress = no_progress());

}  // namespace dendrofit
