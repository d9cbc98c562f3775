// SPDX-License-Identifier: GPL-3.0-or-later
// Boughs below the horizon, where the sky no longer tells them from what is behind.
#pragma once

#include "core/photograph.h"
#include "recon/image/sky.h"

#include <cstdint>
#include <vector>

namespace dendrofit {

/// Adds to `tree` what hangs together with it below the horizon and has the bark's hue
/// rather than that of its surroundings: nearer to the line of colours from black through the median bark
/// than to that through the row's own median beside it (so that shadows and uneven light are no wood), and
/// off the latter by four times its scatter. Says nothing where bark and surroundings are of one hue. Wood
/// much thicker than a stem that bears what crosses the horizon, or a fringe along known wood, is not added.
/// Returns how many pixels were.
std::size_t grow_boughs(const Photograph& photo, const SkyRatio& sky, std::vector<std::uint8_t>& tree);

}  // namespace dendrofit
