// SPDX-License-Identifier: GPL-3.0-or-later
// Where the stem meets the ground, from the lower ends of the masks.
#pragma once

#include "core/photograph.h"
#include "core/types.h"
#include "recon/image/outline.h"

#include <optional>
#include <vector>

namespace dendrofit {

struct MaskFoot {
  Vec3 position = Vec3::Zero();  ///< on the stem's axis, at the height where its bark meets the ground
  double radius_m = 0;
  double height_spread_m = 0;  ///< of the single views' heights, median off their median
  std::size_t views = 0;
};

/// A camera above the ground sees the stem end at its near side, and the space that all masks allow goes on
/// below the ground between these edges. Each mask's lowest run of pixels gives a line of sight to the near
/// side; the lines' plan gives the axis, and the near side's distance from it the height. None where fewer
/// than three views hold the foot, or where their lines do not meet (the lowest pixels are not a stem's).
std::optional<MaskFoot> foot_of_masks(const std::vector<Camera>& cameras,
                                      const std::vector<Outline>& outlines);

}  // namespace dendrofit
