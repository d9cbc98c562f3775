// SPDX-License-Identifier: GPL-3.0-or-later
// Scans from several stations are never registered perfectly: each station's points lie some millimetres off
// the others', and every branch looks that much thicker or thinner. The tree itself tells by how much.
#pragma once

#include "core/types.h"
#include "recon/skeleton.h"

#include <cstdint>
#include <vector>

namespace dendrofit {

/// How far each scan lies off their common mean (metres; nothing where all points are of one scan, or where
/// shifts from one half of the places make the other half no rounder: nothing is moved that the wood does not
/// ask for twice). Each scan's arc about thick wood has the wood's curvature and its own middle: least
/// squares over all cylinders' middles and radii, which are the scans' in common, and the scans' shifts;
/// Tukey's weights.
std::vector<Vec3> scan_shifts(const std::vector<Vec3>& points, const std::vector<std::uint16_t>& scan_of,
                              const std::vector<Limb>& limbs, double noise_m);

/// Tells the scans apart (scan_order.h), takes their shifts out of the points and returns the shifts by scan.
std::vector<Vec3> align_scans(std::vector<Vec3>& points, const std::vector<std::uint32_t>& stored,
                              const std::vector<Limb>& limbs, double noise_m);

}  // namespace dendrofit
