// SPDX-License-Identifier: GPL-3.0-or-later
// Where branches really begin.
#pragma once

#include "core/types.h"
#include "recon/skeleton.h"

#include <vector>

namespace dendrofit {

/// Sections part only where the points of two branches do, some way above the crotch. Each limb's line is led
/// back from its first clear stretch until it enters its bearer, and takes with it the points that lie on its
/// side of the fork.
void lead_limbs_back(const std::vector<Vec3>& points, std::vector<Limb>& limbs, double spacing_m);

}  // namespace dendrofit
