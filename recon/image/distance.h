// SPDX-License-Identifier: GPL-3.0-or-later
// Exact Euclidean distances on a pixel grid.
#pragma once

#include <cstdint>
#include <vector>

namespace dendrofit {

/// Distance, in pixels, from each pixel's centre to the nearest centre of a pixel that is not marked; 0 on
/// those (Felzenszwalb & Huttenlocher 2012, through OpenCV). Beyond the picture everything counts as marked;
/// where no pixel is unmarked, distances are as large as the picture.
std::vector<float> distance_inside(const std::vector<std::uint8_t>& marked, int width, int height);

/// The same to the nearest marked pixel: 0 on marked pixels.
std::vector<float> distance_outside(const std::vector<std::uint8_t>& marked, int width, int height);

}  // namespace dendrofit
