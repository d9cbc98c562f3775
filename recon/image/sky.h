// SPDX-License-Identifier: GPL-3.0-or-later
// The sky's brightness in a photograph, and what stands before it.
#pragma once

#include "core/photograph.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace dendrofit {

/// Brightness against the sky's, pixel by pixel, where there is sky.
struct SkyRatio {
  int width = 0;
  int height = 0;
  std::vector<float> ratio;       ///< blue over the sky's blue
  std::vector<std::uint8_t> sky;  ///< 1: looks like sky and hangs together with the sky at the top
  std::vector<float> row_light;   ///< luminance of the sky by row; of the nearest row that shows any
  std::vector<int> horizon;       ///< by column: first row below the sky; height where it reaches the bottom
  double horizon_share = 0;       ///< of the columns whose sky ends on the straight horizon
  double median_horizon = 0;      ///< its row in the middle of the picture
  double border_share = 0;        ///< of the picture's border above the horizon that is sky
};

/// Robust quadratic fit of blue from the top downwards, as far as sky goes on, then local medians of the
/// sky's own unevenness. None where the top of the picture is nothing like a smooth bright sky.
std::optional<SkyRatio> find_sky(const Photograph& photo);

/// Row of the horizon in the middle of the picture; none where most columns show none, or it is not in the
/// picture.
std::optional<double> clear_horizon(const SkyRatio& sky);

/// Luminance (Rec. 601) of a pixel.
double luminance(const Photograph& photo, std::size_t pixel);

/// Otsu's (1979) separability, 0 to 1, of the ratios above the horizon.
double separability(const SkyRatio& sky);

}  // namespace dendrofit
