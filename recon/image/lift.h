// SPDX-License-Identifier: GPL-3.0-or-later
// One view to three dimensions: every node stays on its pixel's ray, its depth is invented.
#pragma once

#include "core/tree.h"
#include "recon/image/frame.h"
#include "recon/image/skeleton.h"

#include <cstdint>

namespace dendrofit {

struct LiftOptions {
  double opening_angle_deg = 50;  ///< of branches, where fewer than eight of their order show one
  double steepest_slope = 2.7;    ///< of a branch into the picture
  std::uint64_t seed = 1;         ///< decides where both sides are equally free
  void validate() const;
};

/// Cylinder i ends at skeleton node i + 1. The stem lies in the frame's plane; where the frame's top
/// lead says that the tree is lower than its top looks, the stem bends to the camera. A branch leaves its
/// bearer at its order's opening angle (the 90th percentile of those seen), to the side where it is farther
/// from the branches already placed, longest first (Okabe, Owada & Igarashi 2005); no branch leaves the plane
/// farther than the silhouette is wide at its height. Radii are the picture's, at their depth. Quality:
/// measured on the stem, extrapolated wherever the depth is invented or a gap is crossed. Throws SolverError
/// when rays do not meet the plane (a camera turned away from the tree).
Tree lift(const PlaneSkeleton& skeleton, const PictureFrame& frame, const LiftOptions& options = {});

}  // namespace dendrofit
