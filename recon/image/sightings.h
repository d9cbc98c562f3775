// SPDX-License-Identifier: GPL-3.0-or-later
// A tree looked for in the pictures it came from: where each of its cylinders lies in each view's mask, how
// wide it is there, and whether other wood is in the way.
#pragma once

#include "core/photograph.h"
#include "core/progress.h"
#include "core/tree.h"
#include "core/types.h"
#include "recon/image/outline.h"

#include <cstdint>
#include <vector>

namespace dendrofit {

/// The mask's stretch across one cylinder's middle in one view.
struct Sighting {
  std::int32_t view = 0;
  bool alone = false;          ///< no other axis projects within two radii
  double offset_px = 0;        ///< of the stretch's middle from the projected axis, along `across`
  double half_width_px = 0;    ///< of the stretch
  double px_per_m = 0;         ///< along `across`
  Vec3 across = Vec3::Zero();  ///< unit: across cylinder and line of sight
};

using Sightings = std::vector<std::vector<Sighting>>;  // by cylinder; views that see no stretch are left out

/// Cylinders in the frame of the cameras' world. `reach_px`: how far beside the projected axis a stretch may
/// begin.
Sightings sight_cylinders(const Tree& tree, const std::vector<Camera>& cameras,
                          const std::vector<Outline>& outlines, double reach_px, int threads = 0,
                          Progress& progress = no_progress());

/// In how many views a cylinder lies on a ridge of the mask (its middle within 1.5 px + half its radius) of
/// agreeing width (35 %).
int support_of(const std::vector<Sighting>& sightings);

}  // namespace dendrofit
