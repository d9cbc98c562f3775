// SPDX-License-Identifier: GPL-3.0-or-later
// Scans from several stations are never registered perfectly: each station's points lie some millimetres off
// the others', and every branch looks that much thicker or thinner. The tree itself tells by how much.
#pragma once

#include "core/types.h"
#include "recon/skeleton.h"

#include <cstdint>
#include <vector>

namespace dendrofit {

/// Which scan each point is from, told from the order in which they are stored: an export holds one scan
/// after another, and a scan sees thick wood from one side only. `stored[i]` is the place of points[i] in the
/// file. All zero where the order tells nothing, or everything was seen from one side.
std::vector<std::uint16_t> scans_by_order(const std::vector<Vec3>& points,
                                          const std::vector<std::uint32_t>& stored,
                                          const std::vector<Limb>& limbs, double noise_m);

/// How far each scan lies off their common mean (metres; nothing where all points are of one scan). Each
/// scan's arc about thick wood has the wood's curvature and its own middle: least squares over all cylinders'
/// middles and radii, which are the scans' in common, and the scans' shifts; Tukey's weights.
std::vector<Vec3> scan_shifts(const std::vector<Vec3>& points, const std::vector<std::uint16_t>& scan_of,
                              const std::vector<Limb>& limbs, double noise_m);

/// Both of the above; takes the shifts out of the points and returns them by scan.
std::vector<Vec3> align_scans(std::vector<Vec3>& points, const std::vector<std::uint32_t>& stored,
                              const std::vector<Limb>& limbs, double noise_m);

}  // namespace dendrofit
