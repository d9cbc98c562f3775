// SPDX-License-Identifier: GPL-3.0-or-later
// Walls and fences: what is flat and large is no tree.
#pragma once

#include "recon/preprocess.h"

#include <cstddef>

namespace dendrofit {

/// Takes the points of large upright planes out of the scan and returns how many they were. A plane is cells
/// of a quarter of a metre, side by side, in each of which the points lie flat (by their covariance) in one
/// common plane; it counts where it is at least a metre high and wide and mostly filled. No wood is: a
/// trunk's surface leaves its tangent by 4 cm within a width of a metre unless it is six metres thick, and a
/// crown fills its space. Level planes are ground's, see find_ground().
std::size_t remove_walls(CleanScan& scan);

}  // namespace dendrofit
