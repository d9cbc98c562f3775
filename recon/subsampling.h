// SPDX-License-Identifier: GPL-3.0-or-later
// What a tree's measures would be from other points on the same wood: repeated subsampling.
#pragma once

#include "core/progress.h"
#include "core/types.h"
#include "recon/radii.h"
#include "recon/sights.h"
#include "recon/skeleton.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace dendrofit {

/// Standard errors by subsampling; volumes relative to themselves.
struct SubsampleSpread {
  double dbh_m = 0;
  double height_m = 0;
  double stem_share = 0;
  double branch_share = 0;
};

struct SubsampleOptions {
  std::optional<double> breast_z_m = std::nullopt;  ///< local height of the DBH, where the tree reaches it
  int rounds = 2;
  std::uint64_t seed = 1;
  SightOptions seeing;
  RadiusOptions radii;
};

/// Splits the points of every place in two at random, `rounds` times, and measures each half: sights, radii,
/// volumes along the settled centre lines, the circle at breast height, the highest point. A half's measures
/// have twice the sampling variance of the whole's, and share half of it with them: their mean squared
/// difference from the whole is the whole's own variance (delete-half jackknife, Shao & Wu 1989). Only the
/// limbs that hold nine tenths of the volume are looked at anew; `sights` are the whole's.
SubsampleSpread subsample(const std::vector<Vec3>& points, const std::vector<Limb>& limbs,
                          const Sights& sights, const SubsampleOptions& options, Progress& = no_progress());

}  // namespace dendrofit
