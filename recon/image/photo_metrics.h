// SPDX-License-Identifier: GPL-3.0-or-later
// What a photograph can tell of a tree's measures, and how well.
#pragma once

#include "recon/reconstruct_photo.h"

#include <string>
#include <vector>

namespace dendrofit {

struct OutlinePixels {
  Eigen::Vector2d foot = Eigen::Vector2d::Zero();  ///< middle of the lowest row
  Eigen::Vector2d top = Eigen::Vector2d::Zero();   ///< middle of the highest row
  double foot_width = 0;
  double top_spread = 0;       ///< rms distance of the top fifth's pixels from the foot's column
  double left = 0, right = 0;  ///< columns of the outermost pixels, and
  double left_row = 0, right_row = 0;
  double area = 0;  ///< pixels, by cover
};

/// Throws SolverError for an empty silhouette.
OutlinePixels trace_outline(const Silhouette& silhouette);

OutlineMetrics measure_outline(const Silhouette& silhouette, const OutlinePixels& outline,
                               const PlaneSkeleton& skeleton, const PictureFrame& frame);

/// Metrics of the lifted tree: height and crown width as the picture shows them, and 95 % intervals that hold
/// what it leaves open (pixel, scale, the top nearer or farther than the stem, volumes of invented lengths).
/// Without a scale there is no breast height, so no DBH.
TreeMetrics photo_metrics(const Tree& tree, const OutlineMetrics& outline, const PictureFrame& frame,
                          const Silhouette& silhouette, double dbh_height_m, bool metric);

/// Sentences for the user.
void tell_scale(const PictureFrame& frame, const Silhouette& silhouette, const OutlineMetrics& outline,
                std::vector<std::string>& warnings);
void tell_skeleton(const PlaneSkeleton& skeleton, std::vector<std::string>& warnings);

}  // namespace dendrofit
