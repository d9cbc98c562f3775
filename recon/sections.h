// SPDX-License-Identifier: GPL-3.0-or-later
// The wood cut into sections from the foot to the tips: the raw skeleton.
#pragma once

#include "core/progress.h"
#include "core/types.h"
#include "recon/foot.h"
#include "recon/graph.h"

#include <cstdint>
#include <vector>

namespace dendrofit {

/// A piece of one branch, across its whole thickness and about as long as its radius.
struct Section {
  Vec3 centre = Vec3::Zero();
  Vec3 direction = Vec3::UnitZ();  ///< towards the tip, unit
  double radius_m = 0;             ///< rough; see cylinder_fit.h for the radii that count
  std::int32_t parent = -1;
  double extent_m = 0;     ///< root mean square distance of its own points from their line
  double coasted_m = 0;    ///< way since the last section whose own points told its place
  bool after_gap = false;  ///< reached across a bridged gap
  std::vector<std::uint32_t> points;
};

/// Follows the paths outwards from the foot. Each section's successors are the connected groups of points
/// that come next along the paths; groups that lie within the section's own prolonged cylinder are one (a
/// stem seen from two sides is still one stem), others are branches. Parents come before children.
std::vector<Section> cut_sections(const std::vector<Vec3>& points, const PointGraph& graph,
                                  const Paths& paths, const std::vector<Foot>& feet,
                                  Progress& = no_progress());

}  // namespace dendrofit
