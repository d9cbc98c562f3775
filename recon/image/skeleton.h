// SPDX-License-Identifier: GPL-3.0-or-later
// A silhouette's centre lines as a rooted tree in the picture's plane.
#pragma once

#include "recon/image/segmentation.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace dendrofit {

struct ImageSkeletonOptions {
  double spur_radii = 1.2;        ///< an end that reaches less than this many radii of its bearer is dropped
  double gap_radii = 3;           ///< pieces are joined over at most this many radii, and
  double gap_px = 4;              ///< over this many pixels in any case
  double gap_turn_deg = 30;       ///< where the line goes on in the same direction within this
  double crossing_turn_deg = 20;  ///< two branches cross where both go straight on within this
  double node_spacing_px = 3;     ///< along the lines; closer where the wood is thin
  std::optional<Eigen::Vector2d> root_px = std::nullopt;  ///< the stem's foot; found where not given
  void validate() const;
};

/// Nodes in the plane, parents before children; node 0 is the root. Positions are pixels from the picture's
/// upper left corner (the first pixel's centre is (0.5, 0.5)).
struct PlaneSkeleton {
  std::vector<Eigen::Vector2d> px;
  std::vector<double> radius_px;
  std::vector<std::int32_t> parent;  ///< -1 for the root
  std::vector<std::uint8_t> bridge;  ///< 1: the line from the parent crosses a gap in the silhouette
  std::vector<std::uint8_t>
      continues;                   ///< 1: goes on along its parent's axis; 0: the root, or begins a branch
  std::size_t joined_pieces = 0;   ///< fragments connected over gaps
  std::size_t dropped_pieces = 0;  ///< fragments no line leads to
  double dropped_share = 0;        ///< of the silhouette's pixels
  std::size_t crossings = 0;       ///< places where two branches pass each other

  std::size_t size() const { return px.size(); }
};

/// Centre lines by thinning (image_thinning.h), radii r = distance to the outline - 0.3 px, from the cover
/// across where the wood is thinner than 3 px; junctions merged, spurs dropped, fragments joined, crossings
/// resolved, remaining loops cut. Throws SolverError where the silhouette holds no line.
PlaneSkeleton skeletonise(const Silhouette& silhouette, const ImageSkeletonOptions& options = {});

/// Half the stem's width at its foot: the largest radius within twice that along the stem from the root.
double foot_radius_px(const PlaneSkeleton& skeleton);

}  // namespace dendrofit
