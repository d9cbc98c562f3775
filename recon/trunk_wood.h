// SPDX-License-Identifier: GPL-3.0-or-later
// The bare bole known by its round cross-section.
#pragma once

#include "core/types.h"
#include "recon/graph.h"

#include <vector>

namespace dendrofit {

/// Follows the trunk's circle from the paths' sources upwards, slice by slice, while the points about it lie
/// on it, and clears `leaf` there: paths keep to one side of a trunk, so that in a sparse scan its other
/// sides are far from any. Ends where foliage or a fork hides the circle.
void keep_round_bole(const std::vector<Vec3>& points, const Paths& paths, double spacing_m,
                     std::vector<char>& leaf);

}  // namespace dendrofit
