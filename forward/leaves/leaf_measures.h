// SPDX-License-Identifier: GPL-3.0-or-later
// What foliage looks like to light and to a forester: profile, voxels, projection, gaps.
#pragma once

#include "core/foliage.h"
#include "forward/leaves/leaf_report.h"

#include <array>
#include <vector>

namespace dendrofit {

/// Leaf area (m2) per metre of height, by the blades' middles, in steps from `foot_z` (local) up.
std::vector<double> leaf_area_profile(const Foliage& foliage, double foot_z, double step_m);
/// Leaf area density of the occupied voxels, in rising index.
std::vector<LeafVoxel> leaf_voxels(const Foliage& foliage, double edge_m);
/// Mean projection of unit leaf area towards zenith angles 0, 10, ... 90 degrees, leaf azimuth even (Ross
/// 1981), over the blades' triangles; of at most about 20,000 leaves, evenly taken.
std::array<double, 10> projection_function(const Foliage& foliage);
/// Plan area (m2) the blades cover seen from above, on a raster of `pixel_m`.
double covered_area(const Foliage& foliage, double pixel_m, int threads = 1);

/// Fills leaf_area_density, voxels, g_function, gap_fraction, clumping and lai; needs crown_area_m2.
void measure_foliage(const Foliage& foliage, double foot_z, int threads, LeafReport& report);

}  // namespace dendrofit
