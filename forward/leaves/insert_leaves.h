// SPDX-License-Identifier: GPL-3.0-or-later
// Leaves on any tree, none of which touches another leaf, the wood or the ground.
//
// The algorithm follows Akerblom et al. 2018 (Interface Focus 8: 20170045): a leaf area budget is spread over
// the cylinders, split into leaves, every leaf gets a petiole and a pose, and a leaf that would intersect
// takes another pose or is left out. What differs: budgets are carried, never dropped; leaves left out are
// made up elsewhere in the same height bin; and the test asks for a clearance, not for the absence of an
// intersection.
//
// What "none" means. Every vertex a writer prints is the double core/foliage.h computes, on whole micrometres
// (Foliage::append_blade, append_petiole). Two leaves are accepted together only if some direction separates
// their triangles by more than `clearance_m` (0.1 mm); leaf and cylinder likewise, the cylinder solid with
// flat ends. A decimal file of a georeferenced tree moves a coordinate by under 1e-9 m, single precision
// about the shift by under 5e-6 m: both far inside the clearance, so what is written intersects nothing
// whatever the format.
#pragma once

#include "core/foliage.h"
#include "core/point_cloud.h"
#include "core/progress.h"
#include "core/tree.h"
#include "forward/leaves/leaf_report.h"
#include "forward/leaves/leaf_traits.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace dendrofit {

/// Requested shares of leaf area (marginals; none: whatever the bearing wood gives). All are met together as
/// far as there is wood to meet them (iterative proportional fitting over 25 bins each).
struct LeafProfile {
  std::optional<UnitDistribution> height;      ///< over the tree's height
  std::optional<UnitDistribution> along_axis;  ///< from an axis' base to its tip
  std::optional<UnitDistribution> compass;  ///< clockwise from north about the bearing wood's mean position
  std::optional<UnitDistribution> radius;   ///< of the wood, over [0, thickest bearing]
  std::optional<UnitDistribution> order;    ///< axis order over [0, highest]
  std::optional<UnitDistribution> tip_distance;  ///< along the axis, over [0, longest]
};

struct LeafOptions {
  /// At most one of the three; none: the species' usual LAI over the plan area that
  /// bearing wood covers, as far as the twigs carry it.
  std::optional<double> area_m2;  ///< one-sided
  std::optional<std::size_t> count;
  std::optional<double> lai;  ///< over the crown projection (plan hull of the bearing wood)

  LeafTraits traits = leaf_traits("broadleaf");
  LeafProfile profile;
  /// Leaf points of a leaf-on scan: the share of every piece of bearing wood follows the points nearest to
  /// it.
  std::optional<PointCloud> measured;
  double measured_reach_m = 0.5;  ///< points further from any bearing wood count for none

  /// Where the model ends coarser than twigs (or was scanned in leaf: `measured`) and cannot carry the
  /// target, shoots are added to its outer wood (Foliage::twigs); false: leaves sit on what wood there is.
  bool complete_twigs = true;
  double clearance_m = 1e-4;         ///< at least 0.1 mm
  bool on_ground = true;             ///< keep above the level of the tree's foot
  std::optional<double> ground_z_m;  ///< that level where it is known, local coordinates
  double season = 1;                 ///< share of the target that is out (0 leaf-off .. 1)
  std::uint64_t seed = 1;
  int threads = 0;
  void validate() const;
};

struct LeafResult {
  Foliage foliage;
  LeafReport report;
};

/// Throws InputError for a tree or options that cannot be right (see Tree::validate, LeafOptions::validate).
/// A target that does not fit is not an error: the report says how much is missing, where and why.
LeafResult insert_leaves(const Tree& tree, const LeafOptions& options = {},
                         Progress& progress = no_progress());

}  // namespace dendrofit
