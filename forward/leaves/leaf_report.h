// SPDX-License-Identifier: GPL-3.0-or-later
// What was asked of insert_leaves and what came of it.
#pragma once

#include "core/foliage.h"
#include "core/tree.h"
#include "forward/leaves/distribution.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace dendrofit {

/// One property's distribution as requested, among the candidates, and among the leaves that stayed.
struct LeafDistribution {
  std::string name;  ///< "height", "inclination", "length", ...
  std::string unit;
  std::vector<double> edges;      ///< of equal bins
  std::vector<double> requested;  ///< shares a bin
  std::vector<double> candidates;
  std::vector<double> achieved;
  KsResult before;  ///< candidates against requested
  KsResult after;   ///< leaves against requested: the drift
};

/// A height bin's budget.
struct LeafBudgetBin {
  double from_m = 0;  ///< above the foot
  double to_m = 0;
  double requested_m2 = 0;
  double achieved_m2 = 0;
  std::size_t tried = 0;  ///< candidates
  std::size_t placed = 0;
  std::size_t refused_by_wood = 0;  ///< poses
  std::size_t refused_by_leaf = 0;
  std::size_t refused_by_ground = 0;
  std::string reason;  ///< why it falls short; empty where it does not
};

struct LeafVoxel {
  std::array<std::int32_t, 3> index{};  ///< of the lower corner, in voxel edges, local coordinates
  double density_m2_per_m3 = 0;
};

struct LeafReport {
  std::string target;  ///< "area", "count", "lai" or "usual"
  double requested_area_m2 = 0;
  double achieved_area_m2 = 0;
  std::size_t requested_count = 0;
  std::size_t achieved_count = 0;
  double shortfall_m2 = 0;  ///< 0 within one leaf of the target
  std::string shortfall_reason;
  double requested_lai = 0;
  double lai = 0;               ///< achieved, over crown_area_m2
  double crown_area_m2 = 0;     ///< plan hull of the leaves' positions and the bearing wood
  double bearing_length_m = 0;  ///< of wood that bears leaves
  double bearing_radius_m = 0;  ///< the thickest that does
  double added_twigs_m = 0;     ///< of shoots added to a coarse model (Foliage::twigs)
  std::vector<LeafDistribution> distributions;
  std::vector<LeafBudgetBin> bins;
  double profile_step_m = 0.5;
  std::vector<double> leaf_area_density;  ///< m2 per m of height, per step from the foot up
  double voxel_m = 0.5;
  std::vector<LeafVoxel> voxels;  ///< occupied ones
  std::array<double, 10>
      g_function{};         ///< mean projection of unit leaf area towards zenith 0, 10, ... 90 degrees
  double gap_fraction = 1;  ///< of vertical rays through the crown projection
  double clumping = 1;      ///< -ln(gap) / (G(0) * LAI): 1 random, below 1 clumped
  std::size_t candidates = 0;
  std::size_t poses = 0;
  std::size_t leaf_pair_tests = 0;
  std::size_t wood_tests = 0;
  int rounds = 0;
  std::uint64_t seed = 0;
  double clearance_m = 1e-4;
  std::string source;  ///< of the species' numbers
  double seconds = 0;  ///< the only field that differs between equal runs
  std::vector<std::string> warnings;
};

}  // namespace dendrofit
