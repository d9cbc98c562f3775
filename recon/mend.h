// SPDX-License-Identifier: GPL-3.0-or-later
// Branches that occlusion has cut, found by their ends.
#pragma once

#include "core/types.h"
#include "recon/graph.h"
#include "recon/sections.h"

#include <vector>

namespace dendrofit {

/// A thick branch does not end: where one does, and wood of its thickness goes on straight ahead (reached
/// meanwhile by a detour over some twig that touches it), a bridge between the two. Its cost is its mere
/// length.
std::vector<Bridge> mend_cut_branches(const std::vector<Vec3>& points, const std::vector<Section>& sections,
                                      double spacing_m, double max_gap_m);

}  // namespace dendrofit
