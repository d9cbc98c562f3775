// SPDX-License-Identifier: GPL-3.0-or-later
// What the sections missed: points in the wrong limb's hands, and shoots too short for a section of their
// own.
#pragma once

#include "core/types.h"
#include "recon/graph.h"
#include "recon/skeleton.h"

#include <vector>

namespace dendrofit {

/// Hands points that lie off their limb's surface to the limb next to them on whose surface they lie. Returns
/// which limbs gave or got some.
std::vector<char> hand_over_points(const std::vector<Vec3>& points, const PointGraph& graph,
                                   std::vector<Limb>& limbs, double noise_m);

/// Connected points off their limb's surface that reach farther out than `shortest_limb_m` (beyond what noise
/// and the bearer's roughness explain) become limbs of their own, led along the paths. They take their points
/// with them, so that these widen the bearer no longer.
void grow_side_shoots(const std::vector<Vec3>& points, const PointGraph& graph, const Paths& paths,
                      std::vector<Limb>& limbs, double noise_m, const SkeletonOptions& options = {});

}  // namespace dendrofit
