// SPDX-License-Identifier: GPL-3.0-or-later
// From raw sections to limbs: the wood's centre lines, branch by branch.
#pragma once

#include "core/tree.h"
#include "core/types.h"
#include "recon/sections.h"

#include <cstdint>
#include <vector>

namespace dendrofit {

/// One place on a limb's centre line.
struct LimbNode {
  Vec3 centre = Vec3::Zero();
  double along_m = 0;         ///< from the limb's first node
  double rough_radius_m = 0;  ///< of the section
  bool after_gap = false;     ///< nothing was seen between this node and the one before
  std::vector<std::uint32_t> points;
  // Filled by measure_radii():
  double radius_m = 0;
  double seen_radius_m = 0;  ///< before the taper is levelled
  double radius_se_m = 0;
  double coverage = 0;
  bool measured = false;
  RadiusQuality quality = RadiusQuality::extrapolated;
};

/// A run of sections that foresters would call one branch (axis). The first limb of a tree is its stem.
struct Limb {
  std::vector<LimbNode> nodes;    ///< base to tip
  std::int32_t parent = -1;       ///< limb it grows from; parents come before children
  std::int32_t parent_node = -1;  ///< node of the parent next to its base
  double beyond_m = 0;            ///< wood length of the limb and all it bears
};

struct SkeletonOptions {
  double shortest_limb_m = 0.02;  ///< shorter side shoots are noise about their bearer
  void validate() const;
};

/// Prunes spurs, lets at each fork the limb with more wood beyond it go on, and smooths each centre line
/// without shortening it.
std::vector<Limb> make_limbs(const std::vector<Vec3>& points, const std::vector<Section>& sections,
                             double spacing_m, const SkeletonOptions& options = {});

/// Evens every centre line; ends stay where they are, so nothing is shortened.
void smooth_limbs(std::vector<Limb>& limbs);

/// Sets nodes between those of thin wood that lie far apart, so that its line can follow bends as closely as
/// the points' spacing allows; the points go to the nodes next to them.
void divide_long_stretches(const std::vector<Vec3>& points, std::vector<Limb>& limbs, double spacing_m);

/// Recomputes along_m of every node and beyond_m of every limb.
void measure_lengths(std::vector<Limb>& limbs);

/// Where a limb's line passes a point.
struct LimbPlace {
  std::size_t node = 0;       ///< from which the nearest stretch starts
  double along_m = 0;         ///< from the limb's first node
  double distance_m = 1e300;  ///< of the point from the line
  double radius_m = 0;        ///< rough, there
};

/// The place nearest to a point on the stretches that start at the nodes `first` to `last`.
LimbPlace nearest_place(const Limb& limb, const Vec3& point, std::size_t first, std::size_t last);

/// Unit direction of the centre line at a node.
Vec3 direction_at(const Limb& limb, std::size_t node);

}  // namespace dendrofit
