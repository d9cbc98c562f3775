// SPDX-License-Identifier: GPL-3.0-or-later
// Where the trees stand: the compact, upright wood at the bottom of a scan.
#pragma once

#include "core/types.h"
#include "recon/graph.h"
#include "recon/preprocess.h"

#include <cstdint>
#include <vector>

namespace dendrofit {

/// One tree's foot. The stem's lowest metres follow position + (z - position.z) * slope.
struct Foot {
  Vec3 position = Vec3::Zero();       ///< on the ground, or the lowest wood where the scan has no ground
  Eigen::Vector2d slope{0, 0};        ///< of the stem's axis there, metres sideways a metre of height
  double diameter_m = 0;              ///< rough
  std::vector<std::uint32_t> points;  ///< the lowest ring: where every path starts
};

/// Height of each point above the ground, or above the lowest point of any connected part worth the name.
std::vector<double> heights_above_foot(const std::vector<Vec3>& points, const Parts& parts,
                                       const Ground& ground);

/// Feet, the best supported first. Throws SolverError, saying what was seen instead, where nothing like a
/// stem reaches the bottom of the scan.
std::vector<Foot> find_feet(const std::vector<Vec3>& points, const PointGraph& graph,
                            const std::vector<double>& height, const Ground& ground);

/// Keeps the points with keep[i] != 0 in the scan, and the feet's points with their new numbers.
void keep_points(CleanScan& scan, const std::vector<char>& keep, std::vector<Foot>& feet);

/// Closes (open[i] = 0) the grass, herbs, shrubs and fences about the stems: in a scan with ground what lies
/// within half a metre of it away from a stem, and parts that end below 1.5 m and touch no stem; in a scan
/// without ground such parts only where they reach down to the foot's level. `parts` are those of the open
/// points; returns those of the ones that are left.
Parts close_low_vegetation(const std::vector<Vec3>& points, const PointGraph& graph, Parts parts,
                           const std::vector<double>& height, const Ground& ground,
                           const std::vector<Foot>& feet, std::vector<char>& open);

}  // namespace dendrofit
