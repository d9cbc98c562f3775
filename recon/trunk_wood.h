// SPDX-License-Identifier: GPL-3.0-or-later
// Thick wood known by its round cross-section.
#pragma once

#include "core/types.h"
#include "recon/graph.h"
#include "recon/path_evidence.h"

#include <cstdint>
#include <vector>

namespace dendrofit {

/// Where the points about thick wood's paths lie on a circle across them, all points on that circle are wood,
/// however far from a path: paths keep to one side of a trunk. `wood` are points on paths along wood,
/// `nearest` says which of them (by position in `wood`) is nearest to each reached point. Clears `leaf`
/// there.
void keep_round_wood(const std::vector<Vec3>& points, const Paths& paths, const PathEvidence& evidence,
                     const std::vector<std::uint32_t>& wood, const std::vector<std::uint32_t>& nearest,
                     double spacing_m, std::vector<char>& leaf);

}  // namespace dendrofit
