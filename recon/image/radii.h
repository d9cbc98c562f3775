// SPDX-License-Identifier: GPL-3.0-or-later
// How thick the wood is about a line in the picture.
#pragma once

#include "recon/image/segmentation.h"

#include <vector>

namespace dendrofit {

/// Distance to where the cover falls to one half, for path_radii.
std::vector<float> solid_distance(const Silhouette& silhouette);

/// Radius in pixels along a path of pixel centres: the solid distance - 0.3 px (the bias of a pixel grid);
/// where that is below 1.5 px, half the cover summed across the path instead. `inside`: distance to the
/// silhouette's outline along the path, 0 over gaps, which take the mean of both sides. Smoothed by a running
/// median over seven points.
std::vector<double> path_radii(const Silhouette& silhouette, const std::vector<float>& solid,
                               const std::vector<Eigen::Vector2d>& path, const std::vector<float>& inside);

}  // namespace dendrofit
