// SPDX-License-Identifier: GPL-3.0-or-later
// Camera poses made better by the tree itself.
#pragma once

#include "core/photograph.h"
#include "core/tree.h"
#include "recon/image/sightings.h"

#include <vector>

namespace dendrofit {

struct PoseOptions {
  double turn_doubt_deg = 0.3;  ///< standard deviations of the poses told
  double shift_doubt_m = 0.03;
  int threads = 0;
  void validate() const;
};

/// Turns and shifts each camera (six parameters, Ceres, Cauchy loss) so that the tree's axes project on the
/// middles of their stretches of mask. Views with too few sightings stay as they are.
std::vector<Camera> refine_poses(const Tree& tree, const Sightings& sightings,
                                 const std::vector<Camera>& cameras, const PoseOptions& options = {});

/// Median distance, in pixels, of each view's stretches from the projected axes; NaN where it has none.
std::vector<double> median_offsets_px(const Sightings& sightings, std::size_t views);

}  // namespace dendrofit
