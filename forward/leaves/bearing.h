// SPDX-License-Identifier: GPL-3.0-or-later
// The wood that bears leaves, in short pieces, and the share of the leaf area each is to carry.
#pragma once

#include "core/tree.h"
#include "forward/leaves/insert_leaves.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace dendrofit {

/// What a leaf area distribution may depend on; each as a number in [0, 1].
enum class Place : std::uint8_t { height, along_axis, compass, radius, order, tip_distance };
inline constexpr std::size_t kPlaces = 6;
inline constexpr std::array<const char*, kPlaces> kPlaceNames = {"height", "along_axis", "compass",
                                                                 "radius", "order",      "tip_distance"};

/// A stretch of one cylinder, t0..t1 of its length.
struct Piece {
  std::int32_t node = 0;
  double t0 = 0;
  double t1 = 1;
  double length_m = 0;
  std::array<double, kPlaces> place{};  ///< at its middle
  double share = 0;                     ///< of the leaf area; all sum to 1
};

struct BearingWood {
  std::vector<Piece> pieces;            ///< axis by axis, from base to tip
  std::vector<double> cumulative;       ///< shares up to and including each piece
  std::vector<double> axis_tip_m;       ///< of every node: from its end along the axis to the axis' tip
  std::array<double, kPlaces> scale{};  ///< metres, turns or orders that 1 stands for
  double foot_z = 0;
  double length_m = 0;  ///< of wood that bears
  double radius_m = 0;  ///< the thickest that does
  double crown_area_m2 = 0;
  double covered_m2 = 0;   ///< plan area within reach of bearing wood: the crown without its bays
  bool coarse = false;     ///< the model has little wood as thin as a twig
  double unreachable = 0;  ///< largest share that a requested distribution puts where no wood is
  std::vector<std::string> warnings;
};

BearingWood find_bearing_wood(const Tree& tree, const LeafOptions& options);

/// Scales shares until the marginal over `place` in equal bins is `requested`, for every requested place at
/// once (iterative proportional fitting, Deming & Stephan 1940). Returns the largest share found where no
/// wood is.
double fit_shares(std::vector<Piece>& pieces, const LeafProfile& profile);

}  // namespace dendrofit
