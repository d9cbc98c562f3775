// SPDX-License-Identifier: GPL-3.0-or-later
// What the observed tree itself tells of its growth, before any simulation.
#pragma once

#include "core/tree.h"

#include <optional>

namespace dendrofit {

struct DirectEstimates {
  double internode_length_m = 0.1;  ///< rho: a convention (a scan does not show internodes), see scale_for()
  double height_m = 0;
  double size_internodes = 0;  ///< height in internodes: what Xm must at least allow
  std::optional<double> dbh_m;
  double total_volume_m3 = 0;
  double crown_diameter_m = 0;
  double reference_radius_m = 0;           ///< of the stem at a tenth of the height
  double pipe_exponent = 2.6;              ///< v of the pipe model from the tree's own forks
  int forks = 0;                           ///< how many forks told it; fewer than 10: the default stands
  int branches = 0;                        ///< first-order branches long enough to compare
  std::optional<double> branch_angle_deg;  ///< median at which they leave the stem
  std::optional<double> bend_deg;  ///< tropism: elevation of their last half less the first's; below 0 droops
};

/// The largest internode length of the series 1, 0.7, 0.5, 0.3, 0.2, 0.15, 0.1, ... (metres) that gives the
/// tree at least 55 internodes of height: 0.1 m, as in the paper, for trees of 5.5 to 8.2 m.
double scale_for(double height_m);

/// Of the tree with its stem laid along the thickest wood. Throws InputError for an empty tree.
/// `internode_length_m`: taken as given instead of scale_for(height).
DirectEstimates estimate_directly(const Tree& observed, std::optional<double> internode_length_m = {});

}  // namespace dendrofit
