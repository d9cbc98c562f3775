// SPDX-License-Identifier: GPL-3.0-or-later
// Which scan each point of a merged cloud is from, told from the order in which the points are stored.
#pragma once

#include "core/types.h"
#include "recon/skeleton.h"

#include <cstdint>
#include <vector>

namespace dendrofit {

/// An export holds one scan after another, and a scan sees thick wood from one side only: the fewest runs of
/// the file's points each of which does. `stored[i]` is the place of points[i] in the file. All zero where
/// the order tells nothing, or everything was seen from one side.
std::vector<std::uint16_t> scans_by_order(const std::vector<Vec3>& points,
                                          const std::vector<std::uint32_t>& stored,
                                          const std::vector<Limb>& limbs, double noise_m);

}  // namespace dendrofit
