// SPDX-License-Identifier: GPL-3.0-or-later
// The stem below the horizon, where the sky no longer tells it from what is behind.
#pragma once

#include "core/photograph.h"

#include <cstdint>
#include <vector>

namespace dendrofit {

/// A stem where it crosses the horizon.
struct StemCrossing {
  int first = 0, last = 0;  ///< columns
  int row = 0;              ///< just above the horizon
  double slope = 0;         ///< columns per row, downwards
};

/// Adds to `tree` the stem's pixels below its crossing, found by GrabCut (Rother, Kolmogorov & Blake 2004) at
/// half size in a strip about the stem: wood above the horizon and a corridor down the stem are its seeds.
/// Where the background looks like bark (a treeline) the stem is carried on straight for up to eight widths.
/// Returns the row of its foot (the crossing's row where nothing was found).
int follow_stem_down(const Photograph& photo, const StemCrossing& stem, std::vector<std::uint8_t>& tree);

}  // namespace dendrofit
